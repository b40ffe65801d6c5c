"""Dominators and the loop nest of a control flow graph."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Loop:
    """A natural loop: the blocks from which a back edge to `header` is reached without passing it.

    `back_edges` and `entry_edges` are indices into `Cfg.edges`; `parent` is the index in `LoopNest.loops` of the loop
    around it; `depth` counts from 1.
    """

    id: int
    header: int
    blocks: frozenset[int]
    back_edges: tuple[int, ...]
    entry_edges: tuple[int, ...]
    parent: int | None
    depth: int


@dataclass(frozen=True, slots=True)
class LoopNest:
    """All loops of a function, outer ones before inner ones. `irreducible` lists the regions entered in more than one place
    (sets of block ids); they are no loops, and a function that still has one has no bound."""

    loops: tuple[Loop, ...]
    irreducible: tuple[frozenset[int], ...] = ()
