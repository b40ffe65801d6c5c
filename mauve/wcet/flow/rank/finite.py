"""Loops that go through few different states: none comes twice, or the loop never ends."""

from __future__ import annotations

from collections.abc import Iterable
from math import prod

from mauve.wcet.flow.rank.merging import value_at
from mauve.wcet.flow.rank.paths import Program, State
from mauve.wcet.flow.rank.problem import Problem
from mauve.wcet.flow.rank.terms import Fresh, Term, Truth, Var, atoms

MOST_STATES, MOST_VARIABLES = 1 << 17, 2


def finite(problem: Problem, passes: list[State], exits: list[State]) -> int | None:
    """How often control passes along a back edge, where every decision in the loop depends on a few variables alone.

    Let S be the variables that the decisions of the loop depend on, in this iteration or (through their new values) in
    a later one. When all these are functions of S and of values that do not change, two iterations that begin with
    equal S go on alike for ever: in an execution that returns, no value of S comes twice at the header. `passes` and
    `exits` are the states at the ends of all ways through the body, with all that decided between them.
    """
    if not exits or any(state.vague for state in (*passes, *exits)):
        return None
    program = problem.program
    changing: dict[Var, None] = {}
    work = [t for state in (*passes, *exits) for relation in state.known for t in (relation.a, relation.b)]
    while work:
        for of in sorted(atoms(work.pop()), key=str):
            if isinstance(of, Fresh | Truth):
                return None
            if not isinstance(of, Var) or of in changing or _stays(program, of, passes):
                continue
            changing[of] = None
            if len(changing) > MOST_VARIABLES:
                return None
            work += [value_at(program, state, of.location) for state in passes]
    ranges = [problem.ranges(of) for of in changing]
    states = prod((known.high - known.low) // known.stride + 1 for known in ranges)
    return states - 1 if states <= MOST_STATES else None


def _stays(program: Program, of: Var, passes: Iterable[State]) -> bool:
    """Whether no pass changes a variable."""
    return all(_is(value_at(program, state, of.location), of) for state in passes)


def _is(term: Term, of: Var) -> bool:
    return not term.constant and term.parts == frozenset({(of, 1)})
