"""Newton's method for the root of an integer: the distance from the root halves."""

from __future__ import annotations

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow.rank.merging import value_at
from mauve.wcet.flow.rank.paths import State
from mauve.wcet.flow.rank.problem import Problem, locations
from mauve.wcet.flow.rank.terms import Apply, Kind, Relation, Term, Var, add, atoms, compute, number, variable

BITS = 32


def roots(problem: Problem) -> int | None:
    """How many passes of Newton's method there are, without sign, where all passes are the same shape.

    Let s be the root of N, rounded down, N unchanging, and F(y) = (y + N / y) / 2. Without a carry F(y) >= s, and for
    y > s, as then N / y <= s, F(y) - s <= (y - s) / 2. So of the values y, F(y), F(F(y)), ... at most 32 are greater
    than s before one is not, and only of those is F(y) < y. The sum has a carry for y = 1 and for y = 2**32 - 1 alone,
    and is 0 then: a further value, of which nothing is less. The shapes: a pass goes on where F(y) < y; where y < x,
    with x the value before y (one pass more); or it makes x := (x + y) / 2, y := N / x, and goes on where y < x before
    or after that, which is x > s where y is N / x (it is anything before the first pass; that leaves x < 2**31).
    """
    places = list(locations(problem))
    for place in places:
        y = variable(place)
        for n in _numerators(problem, y):
            after = _next(n, y)
            if after is not None and all(
                value_at(problem.program, state, place) == after and _goes_on(state, after, y)
                for state in problem.passes
            ):
                return BITS + 1
    for first in places:
        for second in places:
            if first != second and all(_is_pair(problem, state, variable(first), variable(second))
                                       for state in problem.passes):  # fmt: skip
                return BITS + 2
    return None


def _numerators(problem: Problem, y: Term) -> list[Term]:
    """What is divided by y in the first pass, as far as it does not change."""
    state = problem.passes[0]
    terms = [*state.registers.values(), *state.cells.values()]
    terms += [term for relation in state.known for term in (relation.a, relation.b)]
    found = {of.args[0]: None for term in terms for of in atoms(term)
             if isinstance(of, Apply) and of.op is Op.UDIV and of.args[1] == y}  # fmt: skip
    return sorted((n for n in found if problem.is_invariant(n)), key=str)


def _next(n: Term, y: Term) -> Term | None:
    quotient = compute(Op.UDIV, n, y)
    return None if quotient is None else compute(Op.LSR, add(y, quotient), number(1))


def _goes_on(state: State, less: Term, than: Term) -> bool:
    return Relation(Kind.ULT, less, than) in state.known


def _is_pair(problem: Problem, state: State, x: Term, y: Term) -> bool:
    """Whether a pass has one of the two shapes with the value x before, or beside, y."""
    (of_x, _), (of_y, _) = *x.parts, *y.parts
    assert isinstance(of_x, Var) and isinstance(of_y, Var)
    new_x, new_y = value_at(problem.program, state, of_x.location), value_at(problem.program, state, of_y.location)
    if new_x == y and _goes_on(state, y, x):
        return any(new_y == _next(n, y) for n in _numerators(problem, y))
    goes_on = _goes_on(state, new_y, new_x) or _goes_on(state, y, x)
    if goes_on and new_x == compute(Op.LSR, add(x, y), number(1)):
        return any(new_y == compute(Op.UDIV, n, new_x) for n in _numerators(problem, new_x))
    return False
