"""Pointers that walk along a string: every pass finds bytes that are not 0, and the string's end is known."""

from __future__ import annotations

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow.locations import ENTRY_SP, EntryValues, Sum
from mauve.wcet.flow.rank.measures import contains
from mauve.wcet.flow.rank.merging import value_at
from mauve.wcet.flow.rank.paths import decide
from mauve.wcet.flow.rank.problem import Problem
from mauve.wcet.flow.rank.terms import (
    ZERO,
    Apply,
    Atom,
    FrameBase,
    Fresh,
    Relation,
    Term,
    Var,
    atom,
    atoms,
    number,
    signed,
    substitute,
    subtract,
)

MOST_STEP = 16
"""Bytes that a pass moves on at most."""


def walk(problem: Problem, values: EntryValues, stores: tuple[tuple[int, int], ...]) -> int | None:
    """How often control passes along a back edge, where a pointer walks to the end of a string.

    Let t + c be an address, t a term at the header. Every pass adds a number d > 0 to t, and goes on only where it has
    read that each of the bytes at t + c ... t + c + d - 1 is not 0. With E the address of a byte that is 0 as long as
    the loop runs, and t + c <= E on entry, E is never among those bytes, so t + c <= E holds at every header, and the
    passes are at most E - (t + c) on entry. A byte may also be looked at in the pass after the one that read it: the
    last pass is then one more. `stores` are the stores of the loop.
    """
    best: int | None = None
    for moving in _addresses(problem):
        steps = [_step(problem, index, moving) for index in range(len(problem.passes))]
        if not all(0 < step <= MOST_STEP for step in steps):
            continue
        seen = [_bytes(problem, index, moving) for index in range(len(problem.passes))]
        for first in sorted(seen[0]):
            windows = [range(first, first + step) for step in steps]
            if not all(offset in found for window, found in zip(windows, seen, strict=True) for offset in window):
                continue
            length = values.string(_parts(moving), first, stores)
            late = any(found[o] for window, found in zip(windows, seen, strict=True) for o in window)
            count = None if length is None else length - 1 + late
            if count is not None and (best is None or count < best):
                best = count
    return best


def _addresses(problem: Problem) -> list[Term]:
    """Terms at the header, without their constants, at which the first pass reads bytes that decide something."""
    state, found = problem.passes[0], dict[Term, None]()
    told = sorted({of for r in state.known for term in (r.a, r.b) for of in atoms(term)}, key=str)
    later = [value_at(problem.program, state, of.location) for of in told if isinstance(of, Var)]
    for of in (*told, *(inner for value in later for inner in atoms(value))):
        read = problem.program.reads.get(of.id) if isinstance(of, Fresh) else None
        if read is None or read[1] != 1:
            continue
        bare = subtract(read[0], number(read[0].constant))
        if bare.parts and all(isinstance(inner, Var | FrameBase) for inner, _ in bare.parts):
            found[bare] = None
    return [term for term in found if not problem.is_invariant(term)]


def _parts(term: Term) -> Sum:
    found = [(of.location if isinstance(of, Var) else ENTRY_SP, signed(n)) for of, n in term.parts
             if isinstance(of, Var | FrameBase)]  # fmt: skip
    return tuple(sorted(found, key=str))


def _step(problem: Problem, index: int, term: Term) -> int:
    """What a pass adds to a term; 0 where that is not always the same."""
    after = problem.after(term, index)
    distance = None if after is None else subtract(after, term)
    return 0 if distance is None or not distance.is_constant else signed(distance.constant)


def _bytes(problem: Problem, index: int, base: Term) -> dict[int, bool]:
    """The distances from an address at which a pass, where another follows, has read a byte that is not 0; with whether
    that is looked at only by the one that follows."""
    found: dict[int, bool] = {}
    state = problem.passes[index]
    told = {of for relation in state.known for term in (relation.a, relation.b) for of in atoms(term)}
    for of in told:
        distance = _distance(problem, atom(of), base)
        if distance is not None and _is_not_zero(problem, index, of):
            found[distance] = False
    for of in told:
        if isinstance(of, Var) and all(_is_not_zero(problem, other, of) for other in range(len(problem.passes))):
            distance = _distance(problem, value_at(problem.program, state, of.location), base)
            if distance is not None:
                found.setdefault(distance, True)
    return found


def _distance(problem: Problem, value: Term, base: Term) -> int | None:
    """How far from an address a value was read as a byte; None where it was not."""
    if value.constant or len(value.parts) != 1:
        return None
    ((of, factor),) = value.parts
    if isinstance(of, Apply) and of.op in (Op.SXTB, Op.UXTB) and factor == 1:
        return _distance(problem, of.args[0], base)
    read = problem.program.reads.get(of.id) if isinstance(of, Fresh) and factor == 1 else None
    if read is None or read[1] != 1:
        return None
    distance = subtract(read[0], base)
    return signed(distance.constant) if distance.is_constant else None


def _is_not_zero(problem: Problem, index: int, of: Atom) -> bool:
    """Whether a pass is made only where an atom is not 0: with 0 in its place some relation of the pass is wrong."""
    if not contains(problem.known[index].of_atom(of), 0):
        return True
    for relation in problem.passes[index].known:
        a, b = (substitute(term, lambda inner: ZERO if inner == of else None) for term in (relation.a, relation.b))
        if a is not None and b is not None and decide(Relation(relation.kind, a, b)) is False:
            return True
    return False
