"""Intervals that hold at a loop's header in every iteration, by abstract execution of its passes with widening."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mauve.wcet.binary.loops import Loop
from mauve.wcet.clock import check
from mauve.wcet.flow.locations import ANY, HALF, WORD, Interval, Location
from mauve.wcet.flow.rank.iterate import MOST_MEASURES, Engine
from mauve.wcet.flow.rank.measures import contains, hull
from mauve.wcet.flow.rank.paths import Program, State, summarise_loop
from mauve.wcet.flow.rank.problem import Problem, pose
from mauve.wcet.flow.rank.terms import Var, meet, signed

_EXACT_ROUNDS = 4
MOST_PASSES = 6
DEEPEST = 6
"""Loops inside each other whose intervals are sought: each level multiplies the search of those inside."""


def inductive(program: Program, loop: Loop, entries: list[State]) -> Mapping[Location, Interval]:
    """Intervals of variables at the header of `loop`, entered in `entries`; none in the deepest nests. Uses no value
    analysis but this."""
    if _deepest(program, loop) > DEEPEST:
        return {}
    check(program.deadline, program.cfg.blocks[loop.header].address, program.cfg.name)
    passes = summarise_loop(program, loop)
    problem = pose(program, passes, [state.copy() for state in entries])
    if not problem.passes or not problem.entries:
        return {}
    return inductive_of(problem)


def _deepest(program: Program, loop: Loop) -> int:
    """How many loops lie inside each other in the nest of a loop, as far as they hold it or lie in it."""
    return max(other.depth for other in program.nest.loops if other.header in loop.blocks)


def inductive_of(problem: Problem) -> Mapping[Location, Interval]:
    """The least interval invariant that widening and two rounds of narrowing find.

    With E the intervals at entry and F what a pass makes of intervals, the result X satisfies E <= X and F(X) <= X when
    the widening has become stable; E join F(X) of such an X is again one, so narrowing keeps that.
    """
    engine = Engine(problem)
    if not 0 < len(engine.measures) <= MOST_MEASURES or len(problem.passes) > MOST_PASSES:
        return {}
    entry = engine.start()
    current = entry
    marks = _marks(problem)
    for round_number in range(_EXACT_ROUNDS + 4 * len(entry) + len(marks)):
        grown = _round(engine, entry, current)
        if all(_inside(g, c) for g, c in zip(grown, current, strict=True)):
            break
        if round_number >= _EXACT_ROUNDS:
            grown = [_widen(c, g, marks) for c, g in zip(current, grown, strict=True)]
        current = grown
    else:
        return {}
    for _ in range(2):
        current = [meet(c, g) for c, g in zip(current, _round(engine, entry, current), strict=True)]
    found: dict[Location, Interval] = {}
    for measure, values in zip(engine.measures, current, strict=True):
        if len(measure.parts) == 1 and values.high - values.low < WORD - 1:
            ((of, factor),) = measure.parts
            if isinstance(of, Var) and factor == 1:
                found[of.location] = values
    return found


def _round(engine: Engine, entry: list[Interval], current: list[Interval]) -> list[Interval]:
    """E join current join F(current), or E join F(current) when that is inside already."""
    following = engine.step(current)
    if following is None:
        return entry
    return [hull([e, f]) for e, f in zip(entry, following, strict=True)]


def _inside(inner: Interval, outer: Interval) -> bool:
    return (
        contains(outer, inner.low) and (inner.low - outer.low) % WORD + inner.high - inner.low <= outer.high - outer.low
    )


def _marks(problem: Problem) -> list[int]:
    """The numbers that the passes compare with, and their neighbours: where intervals stop growing first."""
    found: set[int] = set()
    for state in problem.passes:
        for relation in state.known:
            limit = signed(relation.b.constant - relation.a.constant)
            found.update(sign * limit + offset for sign in (1, -1) for offset in (-1, 0, 1))
    return sorted(found)[:_MOST_MARKS]


_MOST_MARKS = 24


def _widen(old: Interval, new: Interval, marks: Sequence[int]) -> Interval:
    """An interval around both, with its moving end at the next mark or at the end of a reading."""
    both = hull([old, new])
    if both.low == old.low and both.high == old.high:
        return old
    low, high = both.low, both.high
    if low == old.low and high < WORD:
        mark = next((mark for mark in marks if mark >= high), None)
        if mark is not None and high < HALF:
            return Interval(low, mark)
        return Interval(low, HALF - 1 if high < HALF else WORD - 1)
    if high == old.high and high < HALF:
        mark = next((mark for mark in reversed(marks) if mark <= low), None)
        if mark is not None:
            return Interval(mark, high)
    if high == old.high and low >= 0 and high < WORD:
        return Interval(0, high)
    if high == old.high and high < HALF:
        return Interval(-HALF, high)
    return ANY
