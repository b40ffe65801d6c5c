"""Cuts of blocks from those of their objectives: for missions whose whole graph is out of reach.

A block fails for want of hardware exactly where its steps do, for each objective starts with everything at rest, and
what never recovers is as much out of service at the second try as at the first:

    one after the other   a cut of any step
    side by side          a cut of any mandatory child
    continue              a step that goes on after its failure has no cut
    retry, abort          the cuts of what is tried
    recover .. continue   a cut of the block together with one of what recovers it
    recover .. abort      the cuts of the block, which fails although something else is done first

The tests compare the result for the whole mission with what its graph says (`mission_cuts`).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TypeAlias

from mauve.mission.cuts import ObjectiveCuts, Sets
from mauve.mission.flatten import Fork, Leaf, Link, Node, Series, flatten
from mauve.mission.plan import Continue, Mission, Recover

__all__ = ["block_cuts"]

Cuts: TypeAlias = frozenset[frozenset[str]]


def block_cuts(mission: Mission, objectives: Iterable[ObjectiveCuts]) -> tuple[ObjectiveCuts, ...]:
    """The minimal cuts of each block of the mission at its path, those of its objectives given; "" is the mission.

    Blocks are in the order written, each before what it consists of. KeyError where an objective is missing.
    """
    known = {one.path: frozenset(map(frozenset, one.cuts)) for one in objectives}
    order = {one.name: at for at, one in enumerate(mission.hardware)}

    def in_order(cuts: Cuts) -> Sets:
        listed = [tuple(sorted(cut, key=order.__getitem__)) for cut in cuts]
        return tuple(sorted(listed, key=lambda cut: (len(cut), [order[name] for name in cut])))

    return tuple(ObjectiveCuts(node.path, in_order(_node(node, known))) for node in _nodes(flatten(mission)))


def _nodes(node: Node) -> Iterator[Node]:
    yield node
    match node:
        case Series(_, links):
            inner = list(links)
        case Fork(_, children):
            inner = [link for link, _ in children]
        case _:
            inner = []
    for link in inner:
        yield from _nodes(link.node)
        if link.recovery is not None:
            yield from _nodes(link.recovery)


def _node(node: Node, known: Mapping[str, Cuts]) -> Cuts:
    match node:
        case Leaf(path):
            return known[path]
        case Series(_, links):
            return _least(cut for link in links for cut in _link(link, known))
        case Fork(_, children):
            return _least(cut for link, mandatory in children if mandatory for cut in _link(link, known))


def _link(link: Link, known: Mapping[str, Cuts]) -> Cuts:
    """The cuts that make a step fail the block around it."""
    own = _node(link.node, known)
    match link.step.on_failure:
        case Continue():
            return frozenset()
        case Recover(_, True) if link.recovery is not None:
            return _least(one | other for one in own for other in _node(link.recovery, known))
        case _:
            return own


def _least(cuts: Iterable[frozenset[str]]) -> Cuts:
    found = set(cuts)
    return frozenset(one for one in found if not any(other < one for other in found))
