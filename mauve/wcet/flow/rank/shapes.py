"""Arguments that know a shape: bits cleared one by one, Euclid's algorithm, shifts of 64-bit pairs."""

from __future__ import annotations

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow.locations import HALF, Location
from mauve.wcet.flow.rank.measures import contains
from mauve.wcet.flow.rank.merging import value_at
from mauve.wcet.flow.rank.paths import State
from mauve.wcet.flow.rank.problem import Problem, locations
from mauve.wcet.flow.rank.terms import (
    ZERO,
    Kind,
    Relation,
    Term,
    Truth,
    Var,
    add,
    atoms,
    compute,
    number,
    subtract,
    variable,
)


def bits_cleared(problem: Problem) -> int | None:
    """Every pass clears the lowest set bit of x (x & (x - 1), x - (x & -x), x ^ (x & -x)) and only runs with x != 0.

    The number of bits set in x falls by one with each pass and is at most the number of bits that x can have at entry.
    If what is known is that x != 0 after the clearing, the last bit is never cleared by a pass: one pass less.
    """
    best: int | None = None
    for location in locations(problem):
        x = variable(location)
        before = after = True
        for index, state in enumerate(problem.passes):
            new = value_at(problem.program, state, location)
            if not _clears_lowest(x, new):
                break
            knowledge = problem.known[index]
            before &= not contains(knowledge.of_term(x), 0) or _differs_from_zero(state, x)
            after &= not contains(knowledge.of_term(new), 0) or any(_differs_from_zero(state, t) for t in _cleared(x))
        else:
            width = problem.on_entry(x).unsigned[1].bit_length()
            if after:
                best = _least(best, max(width - 1, 0))
            elif before:
                best = _least(best, width)
    return best


def _differs_from_zero(state: State, term: Term) -> bool:
    return any(r in state.known for r in (Relation(Kind.NE, term, ZERO), Relation(Kind.NE, ZERO, term)))


def _clears_lowest(x: Term, new: Term) -> bool:
    return new in _cleared(x)


def _cleared(x: Term) -> list[Term]:
    """x without its lowest set bit, in all the ways to write that."""
    minus = subtract(ZERO, x)
    less = subtract(x, number(1))
    lowest = [compute(Op.AND, x, minus), compute(Op.AND, minus, x)]
    forms = [compute(Op.AND, x, less), compute(Op.AND, less, x)]
    for bit in lowest:
        if bit is None:
            continue
        forms += [subtract(x, bit), compute(Op.XOR, x, bit), compute(Op.XOR, bit, x)]
        inverted = subtract(number(-1), bit)
        forms += [compute(Op.AND, x, inverted), compute(Op.AND, inverted, x)]
    return [form for form in forms if form is not None]


def remainders(problem: Problem) -> int | None:
    """Euclid's algorithm: every pass does (a, b) := (b, a mod b) with b != 0 before, or after. With sign, the remainder
    has that of a, and the magnitudes are those of the algorithm without signs.

    Lame: n divisions of a > b need a >= F(n+2), so n is at most the greatest with F(n+2) <= the greatest entry value; a
    first pass with a < b only exchanges them, one more. When b != 0 is known after the pass only, the last division,
    whose remainder is 0, is no pass.
    """
    best: int | None = None
    places = list(locations(problem))
    for b in places:
        into = atoms(value_at(problem.program, problem.passes[0], b))
        for a in sorted({of.location for of in into if isinstance(of, Var) and of.location != b}, key=str):
            for division in (Op.UDIV, Op.SDIV):
                count = _divisions(problem, division, a, b)
                best = best if count is None else _least(best, count)
    return best


def _divisions(problem: Problem, division: Op, a: Location, b: Location) -> int | None:
    """How many passes (a, b) := (b, a mod b) there are, where all are such."""
    before = after = True
    for state in problem.passes:
        new_a, new_b = value_at(problem.program, state, a), value_at(problem.program, state, b)
        if new_a != variable(b) or not _is_remainder(division, new_b, variable(a), variable(b)):
            return None
        before &= _differs_from_zero(state, variable(b))
        after &= _differs_from_zero(state, new_b)
    if not before and not after:
        return None
    entered = [problem.on_entry(variable(place)) for place in (a, b)]
    greatest = max(max(map(abs, of.signed)) if division is Op.SDIV else of.unsigned[1] for of in entered)
    return _lame(greatest) + (0 if after else 1)


def _is_remainder(division: Op, term: Term, a: Term, b: Term) -> bool:
    quotient = compute(division, a, b)
    if quotient is None:
        return False
    products = [compute(Op.MUL, quotient, b), compute(Op.MUL, b, quotient)]
    rests = [subtract(a, product) for product in products if product is not None]
    if division is Op.SDIV:
        return term in rests
    # A remainder cut to fewer bits is no greater, and the argument needs no more.
    return term in [*rests, *(compute(op, rest, ZERO) for rest in rests for op in (Op.UXTH, Op.UXTB))]


def _lame(greatest: int) -> int:
    """The greatest n with F(n + 2) <= greatest, where F(1) = F(2) = 1."""
    n, low, high = 0, 1, 2
    while high <= greatest:
        n, low, high = n + 1, high, low + high
    return n


def _least(a: int | None, b: int) -> int:
    return b if a is None else min(a, b)


# ------------------------------------------------------------------------------------------------- 64-bit shifts
def wide_shift(problem: Problem) -> int | None:
    """Every pass shifts the pair (high:low) right by k >= 1 bits, with the pair != 0 before or after it.

    After ceil(64 / k) passes the pair is zero. The shapes: high := high >> k and low := low >> k | high << (32 - k),
    the or also as an addition or (k = 1) through the carry.
    """
    best: int | None = None
    places = list(locations(problem))
    for low in places:
        for high in places:
            counts = [_wide_pass(problem, state, low, high) for state in problem.passes] if low != high else [None]
            if all(count is not None for count in counts):
                best = _least(best, max(count for count in counts if count is not None))
    return best


def _wide_pass(problem: Problem, state: State, low: Location, high: Location) -> int | None:
    lo, hi = variable(low), variable(high)
    new_lo, new_hi = value_at(problem.program, state, low), value_at(problem.program, state, high)
    for k in range(1, 32):
        if new_hi != compute(Op.LSR, hi, number(k)):
            continue
        right, left = compute(Op.LSR, lo, number(k)), compute(Op.SHL, hi, number(32 - k))
        if right is None or left is None:
            return None
        shapes = [compute(Op.OR, right, left), compute(Op.OR, left, right), add(right, left)]
        if new_lo not in shapes and not (k == 1 and _through_carry(new_lo, right, hi)):
            return None
        width = 32 + problem.on_entry(hi).unsigned[1].bit_length()
        passes = -(-width // k)
        both = (compute(Op.OR, lo, hi), compute(Op.OR, hi, lo))
        if any(t is not None and _differs_from_zero(state, t) for t in both):
            return passes
        both = (compute(Op.OR, new_lo, new_hi), compute(Op.OR, new_hi, new_lo))
        if any(t is not None and _differs_from_zero(state, t) for t in both):
            return max(passes - 1, 0)
    return None


def _through_carry(new: Term, right: Term, hi: Term) -> bool:
    """Whether `new` is right + 2**31 * (bit 0 of hi)."""
    rest = subtract(new, right)
    if rest.constant or len(rest.parts) != 1:
        return False
    ((of, factor),) = rest.parts
    bit = compute(Op.AND, hi, number(1))
    return factor == HALF and bit is not None and of == Truth(Relation(Kind.NE, bit, ZERO))
