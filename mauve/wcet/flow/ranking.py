"""Bounds of loops whose data are unknown, proven by ranking arguments over the binary.

The header of a loop is executed once per entry and once more for each pass along a back edge. `bound_by_ranking` proves
that the number of passes is limited, from a symbolic summary of the paths through the body and what is known of the
values when the loop is entered.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import Loop, LoopNest
from mauve.wcet.flow.locations import (
    ANY,
    Base,
    CallEffects,
    Cell,
    EntryValues,
    Helper,
    Interval,
    Location,
    NoValues,
    Region,
)
from mauve.wcet.flow.rank.affine import affine
from mauve.wcet.flow.rank.inductive import inductive, inductive_of
from mauve.wcet.flow.rank.iterate import iterate
from mauve.wcet.flow.rank.paths import Program, State, entry_states, prepare, summarise_loop
from mauve.wcet.flow.rank.problem import MOST, Problem, pose
from mauve.wcet.flow.rank.shapes import bits_cleared, remainders, wide_shift
from mauve.wcet.flow.rank.terms import Atom, Var, meet, static_range

__all__ = [
    "ANY",
    "Base",
    "CallEffects",
    "Cell",
    "EntryValues",
    "Helper",
    "Interval",
    "Location",
    "NoValues",
    "RankBound",
    "Region",
    "bound_by_ranking",
]


@dataclass(frozen=True, slots=True)
class RankBound:
    """At most `bound` executions of the header per entry of the loop; `method` names the argument in a few words."""

    bound: int
    method: str


_ARGUMENTS: tuple[tuple[str, Callable[[Problem], int | None]], ...] = (
    ("counter", affine),
    ("bits cleared", bits_cleared),
    ("Euclid's algorithm", remainders),
    ("64-bit shift", wide_shift),
    ("intervals of the passes", iterate),
)


def bound_by_ranking(
    cfg: Cfg,
    nest: LoopNest,
    loop: Loop,
    values: EntryValues | None = None,
    effects: Mapping[int, CallEffects] | None = None,
) -> RankBound | None:
    """The best bound that some ranking argument proves for `loop`, or None.

    `effects` maps the index of an edge with callees to what they may change; an edge that is missing follows AAPCS:
    r0-r3, r12, lr, the flags and all memory that is not the caller's frame are lost.
    """
    if any(region & loop.blocks for region in nest.irreducible) or any(b.id != i for i, b in enumerate(cfg.blocks)):
        return None
    program = prepare(cfg, nest, values, effects, inductive)
    entries = entry_states(program).get(loop.header, [])
    best: RankBound | None = None
    for coarse in (False, True):
        program.coarse, program.joined = coarse, False
        program.summaries.clear()
        passes = summarise_loop(program, loop)
        found = _best_argument(program, passes, entries)
        if found is not None and (best is None or found.bound < best.bound):
            best = found
        if not program.joined:
            break
    return best


def _best_argument(program: Program, passes: list[State], entries: list[State]) -> RankBound | None:
    values = program.values

    def on_entry(of: Atom) -> Interval:
        return meet(static_range(of), values.on_entry(of.location)) if isinstance(of, Var) else static_range(of)

    def invariant(of: Atom) -> Interval:
        return meet(static_range(of), values.invariant(of.location)) if isinstance(of, Var) else static_range(of)

    problem = pose(program, passes, entries, invariant, on_entry)
    if not problem.passes:
        return RankBound(1, "no pass repeats")
    found = inductive_of(problem)

    def refined(of: Atom) -> Interval:
        known = found.get(of.location) if isinstance(of, Var) else None
        return invariant(of) if known is None else meet(invariant(of), known)

    problem = pose(program, problem.passes, entries, refined, on_entry)
    best: RankBound | None = None
    for method, argument in _ARGUMENTS:
        made = argument(problem) if problem.passes else 0
        if made is not None and made <= MOST and (best is None or made + 1 < best.bound):
            best = RankBound(made + 1, method)
    return best
