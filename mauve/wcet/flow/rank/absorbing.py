"""Numbers that a loop never gets away from: with one of them it never ends."""

from __future__ import annotations

from mauve.wcet.flow.locations import WORD
from mauve.wcet.flow.rank.paths import State, decide
from mauve.wcet.flow.rank.problem import Problem, pose
from mauve.wcet.flow.rank.terms import Kind, Relation, Term, Var, atom, atoms, number, substitute

MOST_VARIABLES = 6
NUMBERS = (0, WORD - 1)
"""What shifts and products keep as it is."""


def without_absorbing(problem: Problem, exits: list[State]) -> Problem | None:
    """The problem with what holds in executions that return: of a variable that decides in the loop, a number c is
    never its value at the header if with c no way leads out of the loop, and every pass keeps c. None where there is no
    such number. `exits` are the states on all ways out."""
    if not exits:
        return None
    told = {of for state in problem.passes for r in state.known for t in (r.a, r.b) for of in atoms(t)}
    variables = sorted((of for of in told if isinstance(of, Var)), key=str)[:MOST_VARIABLES]
    absorbing = [(v, c) for v in variables for c in NUMBERS if _absorbs(problem, exits, v, c)]
    found = [Relation(Kind.NE, atom(v), number(c)) for v, c in absorbing]
    if not found:
        return None
    passes = [state.copy() for state in problem.passes]
    for state in passes:
        state.known |= frozenset(found)
    entries = [state for state, _ in problem.entries]
    return pose(problem.program, passes, entries, problem.ranges, problem.entry_ranges)


def _absorbs(problem: Problem, exits: list[State], of: Var, number_: int) -> bool:
    if any(not _contradicts(state, of, number_) for state in exits):
        return False
    for index, state in enumerate(problem.passes):
        if not _contradicts(state, of, number_):
            after = problem.after(atom(of), index)
            value = None if after is None else _with(after, of, number_)
            if value is None or not value.is_constant or value.constant != number_:
                return False
    return True


def _contradicts(state: State, of: Var, number_: int) -> bool:
    """Whether a way is not taken where a variable is a number."""
    for relation in state.known:
        a, b = _with(relation.a, of, number_), _with(relation.b, of, number_)
        if a is not None and b is not None and decide(Relation(relation.kind, a, b)) is False:
            return True
    return False


def _with(term: Term, of: Var, number_: int) -> Term | None:
    return substitute(term, lambda inner: number(number_) if inner == of else None)
