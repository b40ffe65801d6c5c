"""Groups of edges that exclude each other, from what each says of the same values.

Two edges exclude each other in a scope when they allow no common value of something that is fixed throughout it. A
group holds edges of which any two exclude each other, for that reason or because no way through the scope leads from
one to the other; those make the constraint of the group tight.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from mauve.wcet.binary.graph import EXIT
from mauve.wcet.flow.exclusive.facts import Key, Numbers, common, contradicts
from mauve.wcet.flow.exclusive.numbers import ROOT
from mauve.wcet.flow.exclusive.walk import Walk

MOST_EDGES = 96
"""Edges that say something of one value and are compared with each other."""
MOST_GROUPS = 512
"""Groups of one function."""


@dataclass(frozen=True, slots=True)
class Group:
    """Of `edges` at most one is taken in one execution of the function (`loop` is None) or in one iteration of a loop,
    however often it is taken there. `allowed` are the values of `key` that go with each."""

    edges: tuple[int, ...]
    loop: int | None
    key: Key
    allowed: tuple[Numbers, ...]


def groups(walk: Walk) -> tuple[Group, ...]:
    """The groups that exclude each other for another reason than the graph."""
    speaking: dict[Key, list[int]] = {}
    for edge, own in walk.own.items():
        if not contradicts(walk.known[edge]):
            for key in own:
                speaking.setdefault(key, []).append(edge)
    found: list[Group] = []
    order: _Order | None = None
    seen: set[tuple[tuple[int, ...], int]] = set()
    for key, edges in speaking.items():
        if not 2 <= len(edges) <= MOST_EDGES or len({walk.cfg.edges[edge].source for edge in edges}) < 2:
            continue
        allowed = {edge: walk.known[edge][key] for edge in edges if key in walk.known[edge]}
        pairs = _contradicting(allowed)
        if not pairs:
            continue
        order = order or _Order(walk)
        scope = walk.numbering.key_scope(key)
        for group in _cliques(allowed, pairs, order, scope):
            if (group, scope) not in seen:
                seen.add((group, scope))
                kept = tuple(allowed[edge] for edge in group)
                found.append(Group(group, None if scope == ROOT else scope, key, kept))
        if len(found) > MOST_GROUPS:
            break
    return tuple(found[:MOST_GROUPS])


def _contradicting(allowed: Mapping[int, Numbers]) -> list[tuple[int, int]]:
    edges = sorted(allowed)
    return [
        (a, b) for at, a in enumerate(edges) for b in edges[at + 1 :] if not common(allowed[a], allowed[b])
    ]


def _cliques(
    allowed: Mapping[int, Numbers], pairs: list[tuple[int, int]], order: _Order, scope: int
) -> list[tuple[int, ...]]:
    """Groups that cover all pairs which the graph alone does not exclude."""
    contrary = set(pairs)

    def exclude(a: int, b: int) -> bool:
        return (min(a, b), max(a, b)) in contrary or order.apart(a, b, scope)

    found: list[tuple[int, ...]] = []
    covered: set[tuple[int, int]] = set()
    for a, b in pairs:
        if (a, b) in covered or order.apart(a, b, scope):
            continue
        group = [a, b]
        for edge in sorted(allowed):
            if edge not in group and all(exclude(edge, other) for other in group):
                group.append(edge)
        group.sort()
        covered |= {(x, y) for x in group for y in group if x < y}
        found.append(tuple(group))
    return found


class _Order:
    """Which edges can follow which in one execution of a scope, by the graph alone."""

    def __init__(self, walk: Walk) -> None:
        self._walk = walk
        self._back = {edge for loop in walk.nest.loops for edge in loop.back_edges}
        self._reach: dict[int, int] = {}
        for block in reversed(walk.order):
            mine = 1 << block
            for edge in walk.leaving.get(block, ()):
                target = walk.cfg.edges[edge].target
                if edge not in self._back and target != EXIT:
                    mine |= self._reach.get(target, 0)
            self._reach[block] = mine

    def apart(self, a: int, b: int, scope: int) -> bool:
        """Whether no execution of the scope takes both edges."""
        first, second = self._walk.cfg.edges[a], self._walk.cfg.edges[b]
        here, there = self._item(first.source, scope), self._item(second.source, scope)
        if here == there:
            # One block is left once; what goes on inside one inner loop, or out of it, may alternate.
            return first.source == second.source == here and not self._inner(here, scope)
        return not (self._leads(a, there, scope) or self._leads(b, here, scope))

    def _leads(self, edge: int, item: int, scope: int) -> bool:
        """Whether a way inside the scope goes from the end of an edge to an item."""
        target = self._walk.cfg.edges[edge].target
        if target == EXIT:
            return False
        inside = scope == ROOT or target in self._walk.nest.loops[scope].blocks
        if not inside or (scope != ROOT and target == self._walk.nest.loops[scope].header):
            return False
        return bool(self._reach.get(self._item(target, scope), 0) >> item & 1)

    def _inner(self, block: int, scope: int) -> bool:
        return self._walk.innermost[block] != scope

    def _item(self, block: int, scope: int) -> int:
        """The block itself, or the header of the outermost loop inside the scope that holds it."""
        loop = self._walk.innermost[block]
        outer = ROOT
        while loop not in (scope, ROOT):
            outer = loop
            parent = self._walk.nest.loops[loop].parent
            loop = ROOT if parent is None else parent
        return block if outer == ROOT else self._walk.nest.loops[outer].header
