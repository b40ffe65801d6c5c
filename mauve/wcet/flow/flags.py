"""Sets of possible condition flags, as 16-bit masks: bit N*8 + Z*4 + C*2 + V is set when that combination may be."""

from __future__ import annotations

from collections.abc import Callable

from mauve.wcet.binary.microop import Condition
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MASK, SIGN, Range, signed

ANY = 0xFFFF


def _where(test: Callable[[bool, bool, bool, bool], bool]) -> int:
    return sum(1 << i for i in range(16) if test(bool(i & 8), bool(i & 4), bool(i & 2), bool(i & 1)))


HOLDS: tuple[int, ...] = (
    _where(lambda n, z, c, v: z),
    _where(lambda n, z, c, v: not z),
    _where(lambda n, z, c, v: c),
    _where(lambda n, z, c, v: not c),
    _where(lambda n, z, c, v: n),
    _where(lambda n, z, c, v: not n),
    _where(lambda n, z, c, v: v),
    _where(lambda n, z, c, v: not v),
    _where(lambda n, z, c, v: c and not z),
    _where(lambda n, z, c, v: not c or z),
    _where(lambda n, z, c, v: n == v),
    _where(lambda n, z, c, v: n != v),
    _where(lambda n, z, c, v: not z and n == v),
    _where(lambda n, z, c, v: z or n != v),
    ANY,
)
"""The combinations in which a condition holds, by its encoding."""

_N: int = HOLDS[Condition.MI.value]
_Z: int = HOLDS[Condition.EQ.value]
_C: int = HOLDS[Condition.CS.value]
_V: int = HOLDS[Condition.VS.value]
_LT: int = HOLDS[Condition.LT.value]


def may_hold(flags: int, condition: Condition) -> bool:
    """Whether the condition is possible."""
    return bool(flags & HOLDS[condition.value])


def must_hold(flags: int, condition: Condition) -> bool:
    """Whether the condition is certain."""
    return not flags & ~HOLDS[condition.value]


def carry_of(flags: int) -> int | None:
    """The carry flag where it is known."""
    if not flags & _C:
        return 0
    return 1 if not flags & ~_C & ANY else None


def with_carry(flags: int, carry: int | None) -> int:
    """The flags after C became `carry` (None: unknown); the others stay."""
    clear = flags & ~_C & ANY | (flags & _C) >> 2
    if carry == 0:
        return clear
    return clear << 2 if carry == 1 else clear | clear << 2


def _choose(possible_true: bool, possible_false: bool, mask: int) -> int:
    return (mask if possible_true else 0) | (ANY & ~mask if possible_false else 0)


def _result(value: Range) -> int:
    """The combinations that N and Z of a result allow."""
    low, high = value.signed_bounds()
    zero = 0 in value
    return _choose(low < 0, high >= 0, _N) & _choose(zero, not (value.n == 0 and zero), _Z)


def of_subtraction(a: Range, b: Range, difference: Range, ordered: int | None = None) -> int:
    """Flags of a - b; `difference` may know more than a and b alone; `ordered` the sign of a - b where both are
    addresses of one object."""
    low_a, high_a = a.unsigned_bounds()
    low_b, high_b = b.unsigned_bounds()
    zero, equal = 0 in difference, difference.n == 0 and difference.low == 0
    no_borrow, borrow = high_a >= low_b, low_a < high_b
    signed_a, signed_b = a.signed_bounds(), b.signed_bounds()
    less, not_less = signed_a[0] < signed_b[1], signed_a[1] >= signed_b[0]
    if equal:
        no_borrow, borrow, less, not_less = True, False, False, True
    elif ordered is not None:
        no_borrow, borrow = ordered > 0, ordered < 0
    low, high = difference.signed_bounds()
    result = _choose(zero, not equal, _Z) & _choose(no_borrow, borrow, _C) & _choose(less, not_less, _LT)
    result &= _choose(low < 0, high >= 0, _N)
    equal_combination: int = HOLDS[Condition.PL.value] & _C & ANY & ~_V
    return result & (ANY & ~_Z | equal_combination)


def of_addition(a: Range, b: Range, total: Range, carry: Range) -> int:
    """Flags of a + b + carry; `total` is the range of the sum as a word."""
    low = a.unsigned_bounds()[0] + b.unsigned_bounds()[0] + carry.low
    high = a.unsigned_bounds()[1] + b.unsigned_bounds()[1] + carry.low + carry.n
    result = _result(total) & _choose(high > MASK, low <= MASK, _C)
    low = a.signed_bounds()[0] + b.signed_bounds()[0] + carry.low
    high = a.signed_bounds()[1] + b.signed_bounds()[1] + carry.low + carry.n
    return result & _choose(low < -SIGN or high >= SIGN, high >= -SIGN and low < SIGN, _V)


def of_logic(value: Range, before: int) -> int:
    """Flags after N and Z were set from a result, C and V as before."""
    kept = 0
    for combination in range(4):
        column = 0x1111 << combination
        if before & column:
            kept |= column
    return _result(value) & kept


def of_wide(low: Range, high: Range, before: int) -> int:
    """Flags after N and Z were set from the 64-bit result high:low, C and V as before."""
    zero = 0 in low and 0 in high
    certain = low.n == 0 and high.n == 0 and low.low == 0 and high.low == 0
    least, most = high.signed_bounds()
    sign = _choose(least < 0, most >= 0, _N)
    kept = of_logic(domain.TOP, before)
    return kept & sign & _choose(zero, not certain, _Z)


def exact(n: bool, z: bool, c: bool, v: bool) -> int:
    """One combination."""
    return 1 << (n << 3 | z << 2 | c << 1 | v)


def of_sum_of_words(a: int, b: int, carry: int) -> int:
    """Flags of a + b + carry for words (a subtraction a - b is a + ~b + 1)."""
    total = a + b + carry
    word = total & MASK
    number = signed(a) + signed(b) + carry
    return exact(bool(word & SIGN), word == 0, total > MASK, signed(word) != number)
