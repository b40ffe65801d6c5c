"""The tree of objectives with a path for each place, and what runs beside what (mission paper, section 5.1)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TypeAlias

from mauve.mission.plan import Abort, Block, Elementary, Mission, Parallel, Recover, Sequence, Step
from mauve.records import record


@record
class Leaf:
    """An elementary objective at one place; `slots` says as which of its simultaneous askers it asks each activity."""

    path: str
    objective: Elementary
    slots: tuple[tuple[str, int], ...]


@record
class Link:
    """A step: its block, what its failure means, and the block that recovers from it."""

    node: Node
    step: Step
    recovery: Series | None = None


@record
class Series:
    """Steps one after the other."""

    path: str
    links: tuple[Link, ...]


@record
class Fork:
    """Children started together, each with whether its success is needed."""

    path: str
    children: tuple[tuple[Link, bool], ...]


Node: TypeAlias = Leaf | Series | Fork


def flatten(mission: Mission) -> Series:
    """The tree of a mission with paths: names joined by dots below the mission, `#2` for the second of one name."""
    node = _node(mission.root, "", {})
    assert isinstance(node, Series)
    return node


def leaves(node: Node) -> Iterator[Leaf]:
    """The elementary objectives of a tree at all their places, in the order written."""
    match node:
        case Leaf():
            yield node
        case Series(_, links):
            for link in links:
                yield from _leaves_of(link)
        case Fork(_, children):
            for link, _ in children:
                yield from _leaves_of(link)


def short_names(paths: tuple[str, ...]) -> dict[str, str]:
    """For each path its shortest ending that no other has: the paper's plain names, where an objective stands once."""
    endings: dict[str, int] = {}
    for path in paths:
        for ending in _endings(path):
            endings[ending] = endings.get(ending, 0) + 1
    return {path: next((one for one in _endings(path) if endings[one] == 1), path) for path in paths}


def askers(node: Node) -> dict[str, int]:
    """How many objectives can ask for each activity at one time."""
    match node:
        case Leaf(_, objective, _):
            return dict.fromkeys(objective.activities, 1)
        case Series(_, links):
            widths: dict[str, int] = {}
            for link in links:
                for name, width in _askers_of(link).items():
                    widths[name] = max(widths.get(name, 0), width)
            return widths
        case Fork(_, children):
            sums: dict[str, int] = {}
            for link, _ in children:
                for name, width in _askers_of(link).items():
                    sums[name] = sums.get(name, 0) + width
            return sums


def _endings(path: str) -> Iterator[str]:
    parts = path.split(".")
    for count in range(1, len(parts) + 1):
        yield ".".join(parts[-count:])


def _leaves_of(link: Link) -> Iterator[Leaf]:
    yield from leaves(link.node)
    if link.recovery is not None:
        yield from leaves(link.recovery)


def _askers_of(link: Link) -> dict[str, int]:
    widths = askers(link.node)
    if link.recovery is not None:
        for name, width in askers(link.recovery).items():
            widths[name] = max(widths.get(name, 0), width)
    return widths


def _node(block: Block, path: str, offsets: Mapping[str, int]) -> Node:
    match block:
        case Elementary():
            names = dict.fromkeys(block.activities)
            return Leaf(path, block, tuple((name, offsets.get(name, 0)) for name in names))
        case Sequence(_, steps):
            return Series(path, tuple(_links(steps, path, offsets, beside=False)))
        case Parallel(_, children):
            links = _links(tuple(child.step for child in children), path, offsets, beside=True)
            pairs = zip(links, children, strict=True)
            return Fork(path, tuple((link, child.mandatory) for link, child in pairs))


def _links(steps: tuple[Step, ...], path: str, offsets: Mapping[str, int], beside: bool) -> Iterator[Link]:
    """The steps of one block with their paths; of children side by side each has asker slots of its own."""
    used: dict[str, int] = {}
    here = dict(offsets)
    for step in steps:
        link = _link(step, path, here, used)
        if beside:
            for name, width in _askers_of(link).items():
                here[name] = here.get(name, 0) + width
        yield link


def _link(step: Step, path: str, offsets: Mapping[str, int], used: dict[str, int]) -> Link:
    node = _node(step.block, _below(path, step.block.name, used), offsets)
    match step.on_failure:
        case Recover(block, _):
            recovery = _node(block, _below(path, block.name, used), offsets)
            assert isinstance(recovery, Series)
            return Link(node, step, recovery)
        case _:
            return Link(node, step)


def _below(path: str, name: str, used: dict[str, int]) -> str:
    """The path of a block inside another."""
    name = name or "block"
    used[name] = used.get(name, 0) + 1
    own = name if used[name] == 1 else f"{name}#{used[name]}"
    return f"{path}.{own}" if path else own


def aborts(link: Link) -> bool:
    """Whether the failure of a step is simply that of the block around it."""
    return isinstance(link.step.on_failure, Abort)
