"""Sets of 32-bit values: circular arithmetic progressions, and explicit sets where they are small.

A `Range` stands for {low + k * step mod 2**32 : 0 <= k <= n} with n * step < 2**32; `values` lists its members where
they are few and no progression. Being circular, one range holds signed and unsigned intervals alike: everything at
most 60 as a signed number is low = 2**31, n = 2**31 + 60. Every operation returns a superset of the exact result
(wrap-around included).
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise
from math import gcd

from mauve.wcet.binary.microop import Op

MODULUS = 1 << 32
MASK = MODULUS - 1
SIGN = 1 << 31
SMALL = 16
"""Explicit sets hold at most this many members."""
FAR = 1 << 16
"""Two members that lie as far apart are no steps of one walk."""


def signed(value: int) -> int:
    """The two's complement reading of a 32-bit word."""
    return value - MODULUS if value & SIGN else value


class Range:
    """A non-empty set of words; build it with `constant`, `progression`, `between` or `of`."""

    __slots__ = ("low", "n", "step", "values")

    def __init__(self, low: int, step: int, n: int, values: tuple[int, ...] | None = None) -> None:
        self.low = low
        self.step = step
        self.n = n
        self.values = values

    def __eq__(self, other: object) -> bool:
        return (
            isinstance(other, Range)
            and self.low == other.low
            and self.n == other.n
            and self.step == other.step
            and self.values == other.values
        )

    def __hash__(self) -> int:
        return hash((self.low, self.step, self.n, self.values))

    def __repr__(self) -> str:
        if self.values is not None:
            return "{" + ", ".join(map(hex, self.values)) + "}"
        if self.n == 0:
            return hex(self.low)
        if self.n == MASK:
            return "any"
        return f"[{signed(self.low)}..{signed(self.high)}" + (f" by {self.step}]" if self.step != 1 else "]")

    @property
    def span(self) -> int:
        """The distance from the first member to the last, along the circle."""
        return self.n * self.step

    @property
    def high(self) -> int:
        """The last member along the circle, as a word."""
        return (self.low + self.n * self.step) & MASK

    @property
    def size(self) -> int:
        """The number of members."""
        return len(self.values) if self.values is not None else self.n + 1

    @property
    def is_top(self) -> bool:
        """Whether every word is a member."""
        return self.n == MASK

    def members(self) -> Iterator[int]:
        """All members, each once."""
        if self.values is not None:
            return iter(self.values)
        low, step = self.low, self.step
        return ((low + k * step) & MASK for k in range(self.n + 1))

    def __contains__(self, value: int) -> bool:
        if self.values is not None:
            return value in self.values
        distance = (value - self.low) & MASK
        if self.n == 0:
            return distance == 0
        return distance <= self.span and distance % self.step == 0

    def unsigned_bounds(self) -> tuple[int, int]:
        """Least and greatest member as unsigned numbers (exact up to the step where the circle is cut)."""
        end = self.low + self.n * self.step
        if end < MODULUS:
            return self.low, end
        if self.values is not None:
            return min(self.values), max(self.values)
        step = self.step
        return (self.low - MODULUS) % step, self.low + (MASK - self.low) // step * step

    def signed_bounds(self) -> tuple[int, int]:
        """Least and greatest member as signed numbers."""
        low = signed(self.low)
        end = low + self.n * self.step
        if end < SIGN:
            return low, end
        if self.values is not None:
            numbers = [signed(value) for value in self.values]
            return min(numbers), max(numbers)
        step = self.step
        return -SIGN + (low - SIGN) % step, low + (SIGN - 1 - low) // step * step


def constant(value: int) -> Range:
    """The set of one word."""
    return Range(value & MASK, 0, 0)


def progression(low: int, step: int, n: int) -> Range:
    """{low + k * step : 0 <= k <= n}; where that laps the circle, the congruence modulo the step's power of two
    remains."""
    if n == 0 or step == 0:
        return Range(low & MASK, 0, 0)
    if n * step >= MODULUS:
        step &= -step
        if step >= MODULUS:
            return Range(low & MASK, 0, 0)
        return Range(low % step, step, MODULUS // step - 1)
    if n * step + step >= MODULUS and step & (step - 1) == 0 and n * step + step == MODULUS:
        return Range(low % step, step, n)
    return Range(low & MASK, step, n)


def between(low: int, high: int) -> Range:
    """The words met on the way from `low` up to `high` around the circle."""
    return progression(low, 1, (high - low) & MASK)


TOP = Range(0, 1, MASK)
BIT = Range(0, 1, 1)
BYTE = Range(0, 1, 0xFF)
HALF = Range(0, 1, 0xFFFF)
SIGNED_BYTE = between(-128, 127)
SIGNED_HALF = between(-32768, 32767)


def of(values: Iterable[int]) -> Range:
    """The smallest range found that holds all of `values` (at least one)."""
    members = sorted({value & MASK for value in values})
    if len(members) == 1:
        return Range(members[0], 0, 0)
    gaps = [(members[0] - members[-1]) & MASK, *(b - a for a, b in pairwise(members))]
    start = max(range(len(gaps)), key=gaps.__getitem__)
    low = members[start]
    offsets = [(value - low) & MASK for value in members]
    step = gcd(*offsets)
    n = max(offsets) // step
    if n + 1 != len(members) and len(members) <= SMALL:
        return Range(low, step, n, tuple(members))
    return progression(low, step, n)


def join(x: Range, y: Range) -> Range:
    """A range that holds both."""
    if x is y or x == y:
        return x
    if x.n == MASK or y.n == MASK:
        return TOP
    if (x.n < SMALL or x.values is not None) and (y.n < SMALL or y.values is not None):
        union = {*x.members(), *y.members()}
        if len(union) <= SMALL:
            return of(union)
    ahead = (y.low - x.low) & MASK
    first = max(x.span, ahead + y.span)
    behind = (x.low - y.low) & MASK
    second = max(y.span, behind + x.span)
    if first <= second:
        step = gcd(x.step, y.step, ahead)
        return progression(x.low, step, first // step) if step else x
    step = gcd(x.step, y.step, behind)
    return progression(y.low, step, second // step) if step else x


def includes(x: Range, y: Range) -> bool:
    """Whether every member of y is one of x."""
    if x.is_top:
        return True
    if x.values is not None or y.values is not None or y.n == 0:
        if y.size > 4 * SMALL:
            return False
        return all(value in x for value in y.members())
    if x.n == 0:
        return False
    ahead = (y.low - x.low) & MASK
    # One that goes all around the circle and meets itself has no end.
    closed = x.span + x.step == MODULUS
    return ahead % x.step == 0 and y.step % x.step == 0 and (closed or ahead + y.span <= x.span)


def clip(x: Range, low: int, high: int) -> Range | None:
    """The members of x met on the way from `low` up to `high` around the circle, or None when there is none."""
    length = (high - low) & MASK
    if x.values is not None:
        kept = [value for value in x.values if (value - low) & MASK <= length]
        return of(kept) if kept else None
    if x.n == 0:
        return x if (x.low - low) & MASK <= length else None
    step, span = x.step, x.span
    start = (low - x.low) & MASK
    parts: list[tuple[int, int]] = []
    if start <= span:
        first, last = -(-start // step) * step, min(start + length, span) // step * step
        if first <= last:
            parts.append((first, last))
    if start + length >= MODULUS:
        last = min(start + length - MODULUS, span) // step * step
        parts.append((0, last))
    if not parts:
        return None
    if len(parts) == 1 or parts[0][0] <= parts[1][1]:
        first, last = min(p[0] for p in parts), max(p[1] for p in parts)
        return progression(x.low + first, step, (last - first) // step)
    (first, _), (_, last) = parts
    around = last + MODULUS - first
    step = gcd(step, MODULUS)
    if around < span and around // step <= x.n:
        return progression(x.low + first, step, around // step)
    return x


def without(x: Range, value: int) -> Range | None:
    """x less one member, where a range can say so; None when nothing remains."""
    if value not in x:
        return x
    if x.n == 0:
        return None
    if x.size <= SMALL:
        return of(member for member in x.members() if member != value)
    if x.is_top:
        return progression(value + 1, 1, MASK - 1)
    if value == x.low:
        return progression(x.low + x.step, x.step, x.n - 1)
    if value == x.high:
        return progression(x.low, x.step, x.n - 1)
    return x


def meet(x: Range, y: Range) -> Range | None:
    """A superset of the common members, at most as large as the smaller of the two; None when there is none."""
    if y.is_top or x is y:
        return x
    if x.is_top:
        return y
    if x.size > y.size:
        x, y = y, x
    if x.size <= SMALL:
        kept = [value for value in x.members() if value in y]
        return of(kept) if kept else None
    return clip(x, y.low, y.high)


def widen(old: Range, new: Range, thresholds: Sequence[int]) -> Range:
    """A superset of both that grows in few steps: explicit sets as they are, else a side that moves goes on to the next
    of `thresholds` (sorted words), not beyond."""
    joined = join(old, new)
    if joined == old or includes(old, joined):
        return old
    if joined.is_top:
        return TOP
    if joined.values is not None or (joined.n == 1 and joined.step >= FAR):
        # Pointers, zero among them: a set of few only grows so often.
        return joined
    step = joined.step or 1
    if not thresholds:
        return progression(joined.low, step, MODULUS // step)
    low, high = joined.low, joined.high
    if low != old.low:
        low = thresholds[bisect_right(thresholds, low) - 1]
    if high != old.high:
        high = thresholds[bisect_left(thresholds, high) % len(thresholds)]
    below = ((joined.low - low) & MASK) // step
    above = ((high - joined.high) & MASK) // step
    n = joined.span // step + below + above
    if n * step >= MODULUS:
        return progression(joined.low, step, n)
    return progression(joined.low - below * step, step, n)


# ------------------------------------------------------------------------------------------------------- arithmetic
def add(x: Range, y: Range) -> Range:
    """All sums."""
    if x.size * y.size <= 4 * SMALL and (x.values is not None or y.values is not None):
        return of(a + b for a in x.members() for b in y.members())
    step = gcd(x.step, y.step)
    if step == 0:
        return constant(x.low + y.low)
    return progression(x.low + y.low, step, (x.span + y.span) // step)


def shift(x: Range, number: int) -> Range:
    """All sums with one number."""
    if x.n == MASK:
        return x
    if x.values is not None:
        return of(value + number for value in x.values)
    return progression(x.low + number, x.step, x.n)


def scale(x: Range, factor: int) -> Range:
    """All multiples by one integer (negative ones allowed)."""
    if factor == 1:
        return x
    if x.n == 0 or factor == 0:
        return constant(x.low * factor)
    if x.values is not None:
        return of(a * factor for a in x.values)
    if factor > 0:
        return progression(x.low * factor, x.step * factor, x.n)
    return progression((x.low + x.span) * factor, -x.step * factor, x.n)


def negate(x: Range) -> Range:
    """All negations."""
    return scale(x, -1)


def sub(x: Range, y: Range) -> Range:
    """All differences."""
    return add(x, scale(y, -1))


def _known_bits(x: Range) -> tuple[int, int]:
    """(bits that are the same in all members, their values)."""
    low, high = x.unsigned_bounds()
    differing = (low ^ high).bit_length()
    known = MASK >> differing << differing
    known = known | (x.step & -x.step) - 1 if x.n else MASK
    return known, low & known | x.low & ((x.step & -x.step) - 1 if x.n else MASK)


def _from_bits(known: int, value: int) -> Range:
    unknown = MASK & ~known
    if not unknown:
        return constant(value)
    step = unknown & -unknown
    low, high = value & known, value & known | unknown
    return progression(low, step, (high - low) // step)


def bit_and(x: Range, y: Range) -> Range:
    """All conjunctions."""
    if x.n == 0:
        x, y = y, x
    low, high = x.unsigned_bounds()
    if y.n == 0:
        mask = y.low
        if mask & (mask + 1) == 0 and low & ~mask == high & ~mask and x.low <= x.low + x.span < MODULUS:
            return progression(x.low & mask, x.step, x.n)
    known_x, value_x = _known_bits(x)
    known_y, value_y = _known_bits(y)
    zeros = known_x & ~value_x | known_y & ~value_y
    ones = known_x & value_x & known_y & value_y
    result = _from_bits(zeros & MASK | ones, ones)
    least, most = 0, min(high, y.unsigned_bounds()[1])
    if y.n == 0 and clears_low_bits(high, y.low):
        least, most = low & y.low, high & y.low
    clipped = clip(result, least, most)
    return clipped if clipped is not None else result


def clears_low_bits(high: int, mask: int) -> bool:
    """Whether a mask clears some of the lowest bits of numbers up to `high`, and no others: then x & mask grows with
    x."""
    cleared = (1 << high.bit_length()) - 1 & ~mask
    return cleared & (cleared + 1) == 0


def bit_or(x: Range, y: Range) -> Range:
    """All disjunctions."""
    known_x, value_x = _known_bits(x)
    known_y, value_y = _known_bits(y)
    ones = known_x & value_x | known_y & value_y
    zeros = known_x & ~value_x & known_y & ~value_y
    result = _from_bits(zeros & MASK | ones, ones)
    clipped = clip(result, max(x.unsigned_bounds()[0], y.unsigned_bounds()[0]), MASK)
    return clipped if clipped is not None else result


def bit_xor(x: Range, y: Range) -> Range:
    """All exclusive disjunctions."""
    if y.n == 0 and y.low == MASK:
        return sub(constant(MASK), x)
    known_x, value_x = _known_bits(x)
    known_y, value_y = _known_bits(y)
    known = known_x & known_y
    return _from_bits(known, (value_x ^ value_y) & known)


def _shift_left(x: Range, amount: int) -> Range:
    return constant(0) if amount >= 32 else scale(x, 1 << amount)


def _shift_right(x: Range, amount: int) -> Range:
    if amount >= 32:
        return constant(0)
    low, high = x.unsigned_bounds()
    unit = 1 << amount
    if x.n and x.step % unit == 0 and x.low + x.span < MODULUS:
        return progression(low >> amount, x.step >> amount, x.n)
    return between(low >> amount, high >> amount)


def _shift_arithmetic(x: Range, amount: int) -> Range:
    amount = min(amount, 31)
    low, high = x.signed_bounds()
    if x.n and x.step % (1 << amount) == 0 and signed(x.low) + x.span < SIGN:
        return progression(low >> amount, x.step >> amount, x.n)
    return between(low >> amount, high >> amount)


def _rotate(x: Range, amount: int) -> Range:
    amount %= 32
    if amount == 0:
        return x
    known, value = _known_bits(x)
    return _from_bits(_rotate_word(known, amount), _rotate_word(value, amount))


def _by_amount(shift: Callable[[Range, int], Range], x: Range, amount: Range) -> Range:
    """A shift by an unknown amount: its low byte counts."""
    amount = bit_and(amount, constant(0xFF))
    low, high = amount.unsigned_bounds()
    if shift is _rotate:
        return TOP if amount.n else shift(x, low)
    result = shift(x, low)
    if high - low > 64:
        low, high = max(low, 0), min(high, 33)
    for count in range(low + 1, min(high, 33) + 1):
        if result.is_top:
            break
        result = join(result, shift(x, count))
    return result


def multiply(x: Range, y: Range) -> Range:
    """All products, modulo 2**32."""
    if y.n == 0:
        x, y = y, x
    if x.n == 0:
        return scale(y, signed(x.low))
    low_x, high_x = x.signed_bounds()
    low_y, high_y = y.signed_bounds()
    corners = [a * b for a in (low_x, high_x) for b in (low_y, high_y)]
    if max(corners) - min(corners) < MODULUS:
        return between(min(corners), max(corners))
    low_x, high_x = x.unsigned_bounds()
    low_y, high_y = y.unsigned_bounds()
    if high_x * high_y - low_x * low_y < MODULUS:
        return between(low_x * low_y, high_x * high_y)
    return TOP


def _high_unsigned(x: Range, y: Range) -> Range:
    (low_x, high_x), (low_y, high_y) = x.unsigned_bounds(), y.unsigned_bounds()
    return between(low_x * low_y >> 32, high_x * high_y >> 32)


def _high_signed(x: Range, y: Range) -> Range:
    corners = [a * b >> 32 for a in x.signed_bounds() for b in y.signed_bounds()]
    return between(min(corners), max(corners))


def _divide_unsigned(x: Range, y: Range) -> Range:
    (low_x, high_x), (low_y, high_y) = x.unsigned_bounds(), y.unsigned_bounds()
    if high_y == 0:
        return constant(0)
    result = between(low_x // high_y, high_x // max(low_y, 1))
    return join(result, constant(0)) if low_y == 0 else result


def _truncated(a: int, b: int) -> int:
    quotient = abs(a) // abs(b)
    return quotient if (a < 0) == (b < 0) else -quotient


def _divide_signed(x: Range, y: Range) -> Range:
    low_x, high_x = x.signed_bounds()
    low_y, high_y = y.signed_bounds()
    divisors = {d for d in (low_y, high_y, -1, 1) if low_y <= d <= high_y and d != 0}
    if not divisors:
        return constant(0)
    corners = [_truncated(a, d) for a in (low_x, high_x) for d in divisors]
    if low_x <= 0 <= high_x or low_y <= 0 <= high_y:
        corners.append(0)
    if max(corners) >= SIGN:
        return TOP
    return between(min(corners), max(corners))


def _leading_zeros(x: Range, _: Range) -> Range:
    low, high = x.unsigned_bounds()
    return between(32 - high.bit_length(), 32 - low.bit_length())


def _sign_extend(x: Range, bits: int) -> Range:
    half = 1 << (bits - 1)
    low, high = x.signed_bounds()
    if -half <= low and high < half:
        return x
    word = bit_and(x, constant(2 * half - 1))
    low, high = word.unsigned_bounds()
    if high < half:
        return word
    if low >= half:
        return add(word, constant(-2 * half))
    return between(-half, half - 1)


_RANGES: dict[Op, Callable[[Range, Range], Range]] = {
    Op.MOV: lambda x, y: x,
    Op.NOT: lambda x, y: sub(constant(MASK), x),
    Op.ADD: add,
    Op.SUB: sub,
    Op.AND: bit_and,
    Op.OR: bit_or,
    Op.XOR: bit_xor,
    Op.SHL: lambda x, y: _by_amount(_shift_left, x, y),
    Op.LSR: lambda x, y: _by_amount(_shift_right, x, y),
    Op.ASR: lambda x, y: _by_amount(_shift_arithmetic, x, y),
    Op.ROR: lambda x, y: _by_amount(_rotate, x, y),
    Op.MUL: multiply,
    Op.UMULH: _high_unsigned,
    Op.SMULH: _high_signed,
    Op.UDIV: _divide_unsigned,
    Op.SDIV: _divide_signed,
    Op.CLZ: _leading_zeros,
    Op.SXTB: lambda x, y: _sign_extend(x, 8),
    Op.SXTH: lambda x, y: _sign_extend(x, 16),
    Op.UXTB: lambda x, y: bit_and(x, constant(0xFF)),
    Op.UXTH: lambda x, y: bit_and(x, constant(0xFFFF)),
    Op.REVSH: lambda x, y: SIGNED_HALF,
}

_UNARY = frozenset(
    {Op.MOV, Op.NOT, Op.CLZ, Op.RBIT, Op.REV, Op.REV16, Op.REVSH, Op.SXTB, Op.SXTH, Op.UXTB, Op.UXTH}
)


def apply(op: Op, x: Range, y: Range) -> Range:
    """All results of a micro-operation that reads no flag (ADC, SBC, RRX and UNKNOWN are the caller's)."""
    if op in _UNARY:
        y = Range(0, 0, 0)
    if x.n == 0 and y.n == 0:
        return constant(_CONCRETE[op](x.low, y.low))
    if x.size * y.size <= SMALL:
        return of(concrete(op, a, b) for a in x.members() for b in y.members())
    function = _RANGES.get(op)
    return function(x, y) if function is not None else TOP


def _rotate_word(a: int, b: int) -> int:
    b = (b & 0xFF) % 32
    return (a >> b | a << (32 - b)) & MASK


def _swap_bytes(a: int) -> int:
    return int.from_bytes(a.to_bytes(4, "little"), "big")


def _extend(a: int, bits: int) -> int:
    a &= (1 << bits) - 1
    return (a - (1 << bits)) & MASK if a >> (bits - 1) else a


_CONCRETE: dict[Op, Callable[[int, int], int]] = {
    Op.MOV: lambda a, b: a,
    Op.NOT: lambda a, b: a ^ MASK,
    Op.ADD: lambda a, b: (a + b) & MASK,
    Op.SUB: lambda a, b: (a - b) & MASK,
    Op.AND: lambda a, b: a & b,
    Op.OR: lambda a, b: a | b,
    Op.XOR: lambda a, b: a ^ b,
    Op.SHL: lambda a, b: a << (b & 0xFF) & MASK,
    Op.LSR: lambda a, b: a >> (b & 0xFF),
    Op.ASR: lambda a, b: (signed(a) >> (b & 0xFF)) & MASK,
    Op.ROR: _rotate_word,
    Op.MUL: lambda a, b: a * b & MASK,
    Op.UMULH: lambda a, b: a * b >> 32,
    Op.SMULH: lambda a, b: (signed(a) * signed(b) >> 32) & MASK,
    Op.UDIV: lambda a, b: a // b if b else 0,
    Op.SDIV: lambda a, b: _truncated(signed(a), signed(b)) & MASK if b else 0,
    Op.CLZ: lambda a, b: 32 - a.bit_length(),
    Op.RBIT: lambda a, b: int(f"{a:032b}"[::-1], 2),
    Op.REV: lambda a, b: _swap_bytes(a),
    Op.REV16: lambda a, b: (a & 0x00FF00FF) << 8 | (a & 0xFF00FF00) >> 8,
    Op.REVSH: lambda a, b: _extend((a & 0xFF) << 8 | a >> 8 & 0xFF, 16),
    Op.SXTB: lambda a, b: _extend(a, 8),
    Op.SXTH: lambda a, b: _extend(a, 16),
    Op.UXTB: lambda a, b: a & 0xFF,
    Op.UXTH: lambda a, b: a & 0xFFFF,
}


def concrete(op: Op, a: int, b: int) -> int:
    """The result of a micro-operation that reads no flag on two words."""
    return _CONCRETE[op](a, b)
