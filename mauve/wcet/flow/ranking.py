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
from mauve.wcet.clock import Deadline
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
from mauve.wcet.flow.rank.absorbing import without_absorbing
from mauve.wcet.flow.rank.affine import affine
from mauve.wcet.flow.rank.finite import finite
from mauve.wcet.flow.rank.inductive import inductive, inductive_of
from mauve.wcet.flow.rank.iterate import iterate
from mauve.wcet.flow.rank.paths import (
    Program,
    State,
    Summaries,
    entry_states,
    exit_states,
    prepare,
    stores_of,
    summarise_loop,
)
from mauve.wcet.flow.rank.problem import MOST, Problem, pose
from mauve.wcet.flow.rank.roots import roots
from mauve.wcet.flow.rank.shapes import bits_cleared, remainders, wide_shift
from mauve.wcet.flow.rank.terms import Atom, Ranges, Var, meet, static_range
from mauve.wcet.flow.rank.walks import walk
from mauve.wcet.flow.ranked import NEVER_REPEAT, RETURNING

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
    ("Newton's method", roots),
    ("intervals of the passes", iterate),
)


class Ranking:
    """Ranking arguments for the loops of one function; what the loops have in common is found out once.

    `common` gives what the value analysis knows of accesses and constants. `effects` maps the index of an edge with
    callees to what they may change; an edge that is missing follows AAPCS: r0-r3, r12, lr, the flags and all memory
    that is not the caller's frame are lost.
    """

    def __init__(
        self,
        cfg: Cfg,
        nest: LoopNest,
        common: EntryValues | None = None,
        effects: Mapping[int, CallEffects] | None = None,
        deadline: Deadline = None,
    ) -> None:
        self._irreducible = frozenset[int]().union(*nest.irreducible)
        self._in_order = all(block.id == index for index, block in enumerate(cfg.blocks))
        self._program = prepare(cfg, nest, common, effects, inductive)
        self._program.deadline = deadline
        self._entries: dict[int, list[State]] | None = None
        self._summaries: dict[bool, Summaries] = {False: Summaries(), True: Summaries()}

    def bound(self, loop: Loop, values: EntryValues | None = None) -> RankBound | None:
        """The best bound that some argument proves for a loop, or None; `values` are those at its header. Raises
        OutOfTime: nothing may be asked again then."""
        if self._irreducible & loop.blocks or not self._in_order:
            return None
        program = self._program
        if self._entries is None:
            program.summaries = self._summaries[False]
            self._entries = entry_states(program)
        entries = [state.copy() for state in self._entries.get(loop.header, ())]
        best: RankBound | None = None
        for coarse in (False, True):
            program.coarse, program.summaries = coarse, self._summaries[coarse]
            passes = summarise_loop(program, loop)
            found = _best_argument(program, values or NoValues(), passes, entries, loop)
            if found is not None and (best is None or found.bound < best.bound):
                best = found
            if loop.header not in program.summaries.joined:
                break
        return best


def bound_by_ranking(
    cfg: Cfg,
    nest: LoopNest,
    loop: Loop,
    values: EntryValues | None = None,
    effects: Mapping[int, CallEffects] | None = None,
) -> RankBound | None:
    """The best bound that some ranking argument proves for `loop` alone, or None; see `Ranking`."""
    return Ranking(cfg, nest, values, effects).bound(loop, values)


def _remembered(ranges: Ranges) -> Ranges:
    """The same ranges, each found out once."""
    known: dict[Atom, Interval] = {}

    def of_atom(of: Atom) -> Interval:
        found = known.get(of)
        if found is None:
            found = known[of] = ranges(of)
        return found

    return of_atom


def _best_argument(
    program: Program, values: EntryValues, passes: list[State], entries: list[State], loop: Loop
) -> RankBound | None:
    def at_entry(of: Atom) -> Interval:
        return meet(static_range(of), values.on_entry(of.location)) if isinstance(of, Var) else static_range(of)

    def always(of: Atom) -> Interval:
        return meet(static_range(of), values.invariant(of.location)) if isinstance(of, Var) else static_range(of)

    on_entry, invariant = _remembered(at_entry), _remembered(always)
    untouched = [state.copy() for state in passes]
    problem = pose(program, passes, entries, invariant, on_entry)
    if not problem.passes:
        return RankBound(1, "no pass repeats")
    found = inductive_of(problem)

    def refined(of: Atom) -> Interval:
        known = found.get(of.location) if isinstance(of, Var) else None
        return invariant(of) if known is None else meet(invariant(of), known)

    problem = pose(program, problem.passes, entries, _remembered(refined), on_entry)
    stores = stores_of(program, loop)
    along: tuple[str, Callable[[Problem], int | None]] = ("end of a string", lambda p: walk(p, values, stores))
    best = _best(problem, (*_ARGUMENTS, along))
    if best is None and problem.passes:
        exits = exit_states(program, loop)
        if not any(other.parent == loop.id for other in program.nest.loops):
            made = finite(problem, untouched, exits)
            best = None if made is None else RankBound(made + 1, NEVER_REPEAT)
        returning = without_absorbing(problem, exits)
        other = None if returning is None else _best(returning, _ARGUMENTS)
        other = None if other is None else RankBound(other.bound, other.method + RETURNING)
        best = min((found for found in (other, best) if found is not None), key=lambda found: found.bound, default=None)
    return best


def _best(problem: Problem, arguments: tuple[tuple[str, Callable[[Problem], int | None]], ...]) -> RankBound | None:
    """The smallest bound that one of the arguments proves."""
    best: RankBound | None = None
    for method, argument in arguments:
        made = argument(problem) if problem.passes else 0
        if made is not None and made <= MOST and (best is None or made + 1 < best.bound):
            best = RankBound(made + 1, method)
    return best
