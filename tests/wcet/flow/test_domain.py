"""The laws of the value domain: every abstract result holds the concrete one."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MASK, Range

EDGES = [0, 1, 2, 3, 7, 8, 31, 32, 255, 256, 0x7FFF, 0x8000, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFF0, 0xFFFFFFFF]
words = st.one_of(st.sampled_from(EDGES), st.integers(0, MASK), st.integers(0, 300))


@st.composite
def ranges_with_members(draw):
    """A range and one of its members."""
    kind = draw(st.integers(0, 3))
    if kind == 0:
        values = draw(st.lists(words, min_size=1, max_size=10))
        return domain.of(values), draw(st.sampled_from(values))
    if kind == 1:
        low, high = draw(words), draw(words)
        span = (high - low) & MASK
        return domain.between(low, high), (low + draw(st.integers(0, span))) & MASK
    step = draw(st.one_of(st.integers(1, 16), st.sampled_from([64, 1000, 4096, 3 << 20])))
    n = draw(st.one_of(st.integers(0, 40), st.integers(0, MASK // step)))
    low = draw(words)
    return domain.progression(low, step, n), (low + step * draw(st.integers(0, n))) & MASK


@st.composite
def pairs(draw):
    return draw(ranges_with_members()), draw(ranges_with_members())


OPERATIONS = [op for op in Op if op not in (Op.ADC, Op.SBC, Op.RRX, Op.UNKNOWN)]


@given(ranges_with_members())
def test_a_built_range_holds_its_members_and_its_bounds_bracket_them(pair):
    x, a = pair
    assert a in x
    low, high = x.unsigned_bounds()
    assert low <= a <= high and low in x and high in x
    low, high = x.signed_bounds()
    assert low <= domain.signed(a) <= high and low & MASK in x and high & MASK in x


@settings(max_examples=600)
@given(st.sampled_from(OPERATIONS), ranges_with_members(), ranges_with_members())
def test_every_operation_holds_the_concrete_result(op, left, right):
    (x, a), (y, b) = left, right
    assert domain.concrete(op, a, b) in domain.apply(op, x, y)


@given(st.sampled_from(OPERATIONS), words, words)
def test_operations_on_constants_are_exact(op, a, b):
    result = domain.apply(op, domain.constant(a), domain.constant(b))
    assert result == domain.constant(domain.concrete(op, a, b))


@given(pairs())
def test_join_holds_both(pair):
    (x, a), (y, b) = pair
    joined = domain.join(x, y)
    assert a in joined and b in joined
    assert domain.includes(joined, x) and domain.includes(joined, y)


@given(ranges_with_members(), ranges_with_members())
def test_inclusion_is_never_claimed_wrongly(left, right):
    (x, _), (y, b) = left, right
    if domain.includes(x, y):
        assert b in x


@settings(max_examples=400)
@given(ranges_with_members(), words, words)
def test_clip_keeps_the_members_inside(pair, low, high):
    x, a = pair
    clipped = domain.clip(x, low, high)
    if (a - low) & MASK <= (high - low) & MASK:
        assert clipped is not None and a in clipped
    if clipped is not None:
        assert clipped.size <= x.size


@given(ranges_with_members(), ranges_with_members())
def test_meet_keeps_common_members(left, right):
    (x, a), (y, b) = left, right
    common = domain.meet(x, y)
    for value in (a, b):
        if value in x and value in y:
            assert common is not None and value in common


@given(ranges_with_members(), words)
def test_without_drops_at_most_the_one_value(pair, value):
    x, a = pair
    rest = domain.without(x, value)
    if a != value:
        assert rest is not None and a in rest


@given(ranges_with_members(), ranges_with_members(), st.lists(words, max_size=6))
def test_widening_holds_both(left, right, extra):
    (x, a), (y, b) = left, right
    thresholds = sorted({0, 0x7FFFFFFF, 0x80000000, MASK, *extra})
    widened = domain.widen(x, y, thresholds)
    assert a in widened and b in widened
    assert domain.includes(widened, x)


@given(st.lists(st.integers(0, 2000), min_size=30, max_size=30))
def test_widening_ends(values):
    thresholds = [0, 100, 1000, 0x7FFFFFFF, 0x80000000, MASK]
    current = domain.constant(values[0])
    changes = 0
    for value in values:
        wider = domain.widen(current, domain.constant(value), thresholds)
        changes += wider != current
        current = wider
    assert changes <= 2 * len(thresholds) + 20


@settings(max_examples=300)
@given(ranges_with_members(), st.integers(-70000, 70000))
def test_scaling_holds_the_products(pair, factor):
    x, a = pair
    assert a * factor & MASK in domain.scale(x, factor)


def test_masks_and_shifts_keep_intervals_and_steps():
    assert repr(domain.bit_and(domain.TOP, domain.constant(15))) == "[0..15]"
    assert repr(domain.bit_and(domain.between(2, 20), domain.constant(254))) == "[2..20 by 2]"
    assert repr(domain.bit_and(domain.between(6, 20), domain.constant(12))) == "[0..12 by 4]"
    assert repr(domain.apply(Op.SHL, Range(0, 1, 15), domain.constant(2))) == "[0..60 by 4]"
    assert repr(domain.apply(Op.LSR, domain.TOP, domain.constant(28))) == "[0..15]"
    assert repr(domain.clip(domain.TOP, 0x80000000, 60)) == "[-2147483648..60]"
