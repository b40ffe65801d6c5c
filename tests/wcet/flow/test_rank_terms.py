"""Terms mean what they did: rewritten divisions and extensions, narrowed multiples, on numbers."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow.locations import WORD, Interval
from mauve.wcet.flow.rank.measures import Knowledge, contains
from mauve.wcet.flow.rank.terms import (
    ZERO,
    Apply,
    Atom,
    Term,
    Var,
    add,
    apply_bounds,
    atom,
    bounds,
    compute,
    fold,
    interval,
    number,
    scale,
    signed,
    simplify,
    static_range,
    subtract,
    variable,
)

words = st.integers(0, WORD - 1) | st.sampled_from([0, 1, 9, 10, 0x7FFF_FFFF, 0x8000_0000, WORD - 1])
X = variable(3)


def value(term: Term, x: int) -> int:
    """The term where r3 holds x."""
    return (term.constant + sum(c * _of(part, x) for part, c in term.parts)) % WORD


def _of(part: Atom, x: int) -> int:
    if isinstance(part, Var):
        return x
    assert isinstance(part, Apply)
    arguments = [value(arg, x) for arg in part.args]
    found = fold(part.op, arguments[0], arguments[1] if len(arguments) > 1 else 0)
    assert found is not None
    return found


@settings(max_examples=300, deadline=None)
@given(words, st.integers(3, 5000), st.integers(1, 12))
def test_a_product_and_a_shift_are_a_division_only_where_they_divide(x: int, divisor: int, shift: int) -> None:
    factor = -(-(1 << 32 + shift) // divisor)
    if factor >= WORD:
        return
    high = compute(Op.UMULH, X, number(factor))
    assert high is not None
    quotient = compute(Op.LSR, high, number(shift))
    assert quotient is not None and value(quotient, x) == (factor * x >> 32) >> shift
    if any(isinstance(part, Apply) and part.op is Op.UDIV for part, _ in quotient.parts):
        assert value(quotient, x) == x // divisor
        rest = subtract(X, scale(quotient, divisor))
        assert Knowledge(static_range).of_term(rest).high <= divisor - 1


@settings(max_examples=300, deadline=None)
@given(words, st.integers(3, 5000), st.integers(0, 10))
def test_a_signed_product_is_a_division_only_where_it_divides(x: int, divisor: int, shift: int) -> None:
    factor = (1 << 32 + shift) // divisor + 1
    if factor >= WORD // 2:
        return
    high = compute(Op.SMULH, X, number(factor))
    assert high is not None
    shifted, sign = compute(Op.ASR, high, number(shift)), compute(Op.ASR, X, number(31))
    assert shifted is not None and sign is not None
    quotient = subtract(shifted, sign)
    expected = ((factor * signed(x) >> 32) >> shift) + (signed(x) < 0)
    assert value(quotient, x) == expected % WORD
    assert contains(bounds(quotient), value(quotient, x))


@given(words, st.sampled_from([Op.LSR, Op.ASR]), st.sampled_from([16, 24]), words)
def test_shifts_there_and_back_are_extensions(x: int, op: Op, amount: int, offset: int) -> None:
    there = scale(add(X, number(offset)), 1 << amount)
    back = compute(op, there, number(amount))
    assert back is not None
    assert value(back, x) == fold(op, ((x + offset) << amount) % WORD, amount)
    half = compute(Op.ASR, add(X, atom(Apply(Op.LSR, (X, number(31))))), number(1))
    assert half is not None and signed(value(half, x)) == int(signed(x) / 2)


EXTENSIONS = st.sampled_from([Op.UXTB, Op.SXTB, Op.UXTH, Op.SXTH])


@settings(max_examples=300, deadline=None)
@given(st.integers(-140, 270), st.integers(0, 40), st.integers(0, 40), EXTENSIONS, EXTENSIONS, st.integers(-20, 20))
def test_a_simpler_term_has_the_same_values_in_the_ranges(
    low: int, below: int, above: int, outer: Op, inner: Op, more: int
) -> None:
    """Extensions of sums of extensions, and arithmetic shifts, where x and x extended lie in known ranges."""
    x = low + below
    extended = compute(outer, X, ZERO)
    assert extended is not None
    near = signed(value(extended, x % WORD))
    known = Knowledge(static_range)
    known.narrow(X, interval(low, x + above))
    known.narrow(extended, interval(near - below, near + above))
    added = compute(inner, X, ZERO)
    assert added is not None
    for term in (
        compute(outer, add(added, number(more)), ZERO),
        compute(outer, add(X, number(more)), ZERO),
        compute(Op.ASR, add(X, number(more)), number(1)),
    ):
        assert term is not None
        assert value(simplify(term, known.of_atom), x % WORD) == value(term, x % WORD)


def test_an_extended_counter_moves_by_what_is_added() -> None:
    """A counter that a loop keeps in eight bits without sign, and compares with sign."""
    counter = compute(Op.SXTB, X, ZERO)
    after = compute(Op.SXTB, compute(Op.UXTB, add(X, number(8)), ZERO) or ZERO, ZERO)
    assert counter is not None and after is not None
    known = Knowledge(static_range)
    assert subtract(simplify(after, known.of_atom), counter) != number(8)
    known.narrow(counter, interval(-128, 119))
    assert subtract(simplify(after, known.of_atom), counter) == number(8)


@given(st.integers(0, 60), st.integers(1, 12), st.integers(0, 80), st.integers(0, 80))
def test_what_a_multiple_says_of_its_number(x: int, factor: int, low: int, more: int) -> None:
    if not low <= factor * x <= low + more:
        return
    up, down = Interval(low, low + more), Interval(-low - more, -low)
    for term, inside in ((scale(X, factor), up), (scale(X, -factor), down)):
        knowledge = Knowledge(lambda _: Interval(0, 60))
        knowledge.narrow(term, inside)
        assert contains(knowledge.of_term(X), x)
        assert knowledge.of_term(X).high * factor <= low + more
    assert ZERO.is_constant


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 5000), st.integers(0, 5000), st.integers(0, 5000), words | st.integers(0, 8191))
def test_a_conjunction_is_between_its_bounds(low: int, within: int, more: int, mask: int) -> None:
    found = apply_bounds(Op.AND, Interval(low, low + within + more), Interval(mask, mask))
    assert contains(found, (low + within) & mask)
