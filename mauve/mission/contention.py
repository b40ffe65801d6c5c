"""Exclusive resources that two activities can want at the same time: the outcome then depends on who comes first."""

from __future__ import annotations

from collections.abc import Iterator

from mauve.mission.cones import Wiring
from mauve.mission.flatten import Fork, Leaf, Link, Node, Series, flatten, leaves
from mauve.mission.plan import Mission
from mauve.records import record


@record
class Contention:
    """Two chains that end at one exclusive resource: objective, activity, resource, its producer, ..., the resource."""

    resource: str
    first: tuple[str, ...]
    second: tuple[str, ...]


def contentions(mission: Mission) -> tuple[Contention, ...]:
    """For each exclusive resource that two activities can want at one time, the shortest chains to it.

    Two activities can run at one time where one objective needs both, directly or through producers, or where two
    objectives side by side do. That each is really selected then is not considered: this list is an upper bound.
    """
    wiring = Wiring(mission)
    shared = {one.name for one in mission.software if one.shared}
    found: dict[str, Contention] = {}
    for first, second in _together(flatten(mission)):
        chains = _chains(wiring, first)
        others = chains if first is second else _chains(wiring, second)
        for resource, users in chains.items():
            if resource in shared or resource in found:
                continue
            for activity, chain in users.items():
                rival = next((one for name, one in others.get(resource, {}).items() if name != activity), None)
                if rival is not None:
                    found[resource] = Contention(resource, chain, rival)
                    break
    return tuple(found.values())


def _together(node: Node) -> Iterator[tuple[Leaf, Leaf]]:
    """Pairs of elementary objectives that can be pursued at one time, each with itself."""
    match node:
        case Leaf():
            yield node, node
        case Series(_, links):
            for link in links:
                yield from _within(link)
        case Fork(_, children):
            for link, _ in children:
                yield from _within(link)
            sets = [list(_under(link)) for link, _ in children]
            for number, one in enumerate(sets):
                for other in sets[number + 1 :]:
                    yield from ((first, second) for first in one for second in other)


def _within(link: Link) -> Iterator[tuple[Leaf, Leaf]]:
    yield from _together(link.node)
    if link.recovery is not None:
        yield from _together(link.recovery)


def _under(link: Link) -> Iterator[Leaf]:
    yield from leaves(link.node)
    if link.recovery is not None:
        yield from leaves(link.recovery)


def _chains(wiring: Wiring, leaf: Leaf) -> dict[str, dict[str, tuple[str, ...]]]:
    """For each resource that an objective can need, each activity that takes it, with the shortest chain to it."""
    found: dict[str, dict[str, tuple[str, ...]]] = {}
    queue: list[tuple[str, tuple[str, ...]]] = [
        (name, (leaf.path, name)) for name in leaf.objective.activities if name in wiring.activities
    ]
    seen = {name for name, _ in queue}
    for name, chain in queue:
        for resource in wiring.activities[name].consumes:
            found.setdefault(resource, {}).setdefault(name, (*chain, resource))
            producer = wiring.producers.get(resource)
            if producer is not None and producer not in seen:
                seen.add(producer)
                queue.append((producer, (*chain, resource, producer)))
    return found
