"""Counters: terms that move in one direction by bounded steps until a comparison ends the loop."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from mauve.wcet.flow.locations import WORD, Interval
from mauve.wcet.flow.rank.measures import Contradiction, arc, contains, hull, mirrored_arc, shift
from mauve.wcet.flow.rank.problem import Problem, is_header_term
from mauve.wcet.flow.rank.terms import (
    ZERO,
    Kind,
    Ranges,
    Term,
    add,
    meet,
    number,
    simplify,
    static_range,
    subtract,
)


@dataclass(frozen=True, slots=True)
class _Guard:
    """A relation of one pass as a condition on a moving term: term + offset lies in `within`, or is not `apart`."""

    within: Interval | None
    apart: Term | None
    offset: int


def affine(problem: Problem) -> int | None:
    """A term t moves in one direction by steps between d_min and d_max, and every pass confines t to an arc of values.

    Let [L, H] be the arc that contains t at the start of every pass (the hull of those of the passes, from comparisons
    with terms that do not change, whose values are those at entry). Count positions from L in the direction of travel:
    a pass starts at a position p in [0, H - L] and ends at p + d with d_min <= d <= d_max. When H - L + d_max < 2**32
    the sum does not wrap into the arc again, so once outside, no further pass starts. From the least position p0 at
    entry there are at most (H - L - p0) / d_min + 1 passes. Down counts the same with the arc mirrored. For an exit
    `t == limit` see `_distance_count`.
    """
    best: int | None = None
    for term in _moving_terms(problem):
        count = _affine_count(problem, term)
        if count is not None and (best is None or count < best):
            best = count
    return best


MOST_SUMMED = 6
"""Terms of which sums are tried: with two counters of which each pass moves one, their sum moves in every pass."""


def _moving_terms(problem: Problem) -> Iterator[Term]:
    """Candidates for the moving term, without constants: the sides of the first pass's relations, their difference,
    and the sums and differences of two such of all passes."""
    seen: dict[Term, None] = {}
    for index, state in enumerate(problem.passes):
        for relation in sorted(state.known, key=str):
            for side in (relation.a, relation.b, subtract(relation.a, relation.b)):
                bare = Term(0, side.parts, side.size)
                if side.parts and bare not in seen and is_header_term(bare) and not problem.is_invariant(bare):
                    seen[bare] = None
                    if index == 0:
                        yield bare
    if not 1 < len(problem.passes) <= MOST_SUMMED:
        return
    terms = sorted(seen, key=lambda term: (term.size, str(term)))[:MOST_SUMMED]
    for position, first in enumerate(terms):
        for second in terms[:position]:
            for both in (add(first, second), subtract(first, second)):
                if both.parts and both not in seen:
                    seen[both] = None
                    yield both


def _guards(problem: Problem, index: int, term: Term) -> Iterator[_Guard]:
    for relation in sorted(problem.passes[index].known, key=str):
        for side, other, mirrored in ((relation.a, relation.b, False), (relation.b, relation.a, True)):
            if side.parts != term.parts:
                continue
            offset = side.constant
            if relation.kind is Kind.NE:
                if problem.is_invariant(other):
                    yield _Guard(None, other, offset)
                continue
            limit = problem.known[index].of_term(other)
            if problem.is_invariant(other):
                limit = meet(limit, problem.on_entry(other))
            try:
                allowed = mirrored_arc(relation.kind, limit) if mirrored else arc(relation.kind, limit)
            except Contradiction:
                continue
            yield _Guard(allowed, None, offset)
            if relation.kind in (Kind.ULT, Kind.SLT) and problem.is_invariant(other):
                yield _Guard(None, other, offset)
        difference = subtract(relation.a, relation.b)
        if difference.parts == term.parts and relation.b.parts:
            if relation.kind is Kind.NE:
                yield _Guard(None, ZERO, difference.constant)
            else:
                yield _Guard(problem.known[index].of_term(difference), None, difference.constant)
                if relation.kind in (Kind.ULT, Kind.SLT):
                    yield _Guard(None, ZERO, difference.constant)


def _affine_count(problem: Problem, term: Term) -> int | None:
    steps: list[tuple[int, int]] = []
    for index, knowledge in enumerate(problem.known):
        after = problem.after(term, index)
        if after is None:
            return None
        step = knowledge.of_term(subtract(simplify(after, knowledge.of_atom), term)).signed
        steps.append(step)
    down = all(high < 0 for _, high in steps)
    if not down and not all(low > 0 for low, _ in steps):
        return None
    if down:
        steps = [(-high, -low) for low, high in steps]
    least, most = min(low for low, _ in steps), max(high for _, high in steps)
    guards = [list(_guards(problem, index, term)) for index in range(len(problem.passes))]
    counts = [_arc_count(problem, term, guards, least, most, down)]
    if least == most:
        counts.append(_distance_count(problem, term, guards, least, down))
    found = [count for count in counts if count is not None]
    return min(found) if found else None


def _arc_count(
    problem: Problem, term: Term, guards: list[list[_Guard]], least: int, most: int, down: bool
) -> int | None:
    arcs: list[Interval] = []
    for index, of_pass in enumerate(guards):
        allowed = problem.known[index].of_term(term)
        for guard in of_pass:
            if guard.within is not None:
                allowed = meet(allowed, shift(guard.within, -guard.offset))
        arcs.append(allowed)
    around = hull(arcs)
    length = around.high - around.low
    if length + most >= WORD:
        return None
    entry = problem.on_entry(term)
    if down:
        position = 0 if contains(entry, around.high) else (around.high - entry.high) % WORD
    else:
        position = 0 if contains(entry, around.low) else (entry.low - around.low) % WORD
    if position > length:
        return 0
    return (length - position) // least + 1


def _distance_count(problem: Problem, term: Term, guards: list[list[_Guard]], step: int, down: bool) -> int | None:
    """Every pass needs t + c != b with b unchanging, and moves t by `step` towards b.

    Let D, 0 <= D < 2**32, be the distance from t + c to b at entry in the direction of travel. After k passes it is
    D - k * step modulo 2**32. If `step` divides D, it is zero first at k = D / step: no further pass starts.
    """
    best: int | None = None
    for guard in guards[0]:
        if guard.apart is None or not all(guard in of_pass for of_pass in guards):
            continue
        there = add(term, number(guard.offset))
        distance = subtract(there, guard.apart) if down else subtract(guard.apart, there)
        values = problem.on_entry(distance)
        if not _divides(problem, step, distance, values):
            continue
        count = values.unsigned[1] // step
        if best is None or count < best:
            best = count
    return best


def _divides(problem: Problem, step: int, term: Term, values: Interval) -> bool:
    """Whether every entry value of the term, read as unsigned, is a multiple of `step`."""
    if step == 1:
        return True
    if values.low == values.high:
        return values.low % WORD % step == 0
    if step & (step - 1):
        return False
    if _is_multiple(term, step, problem.entry_ranges):
        return True
    there = [problem.within(state, term) for state, _ in problem.entries]
    return bool(there) and all(t is not None and _is_multiple(t, step, static_range) for t in there)


def _is_multiple(term: Term, step: int, ranges: Ranges) -> bool:
    total = term.constant
    for of, coefficient in term.parts:
        known = ranges(of)
        spread = 0 if known.low == known.high else known.stride
        if coefficient * spread % step:
            return False
        total += coefficient * known.low
    return total % step == 0
