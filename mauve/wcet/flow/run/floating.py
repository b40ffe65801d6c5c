"""Single precision arithmetic on the words of a run, as an FPU does it with FPSCR at its reset value.

Rounding is to the nearest (ties to even), subnormal numbers count. What depends on an unknown word is unknown. A result
that is not a number is an operand that is none, or the default one (ARM DDI 0406C A2.7, FPProcessNaNs). A sum, product,
quotient or root of two binary32 numbers is computed in binary64 and rounded once more: with 53 >= 2 * 24 + 2 bits that
gives the same as rounding once (Figueroa, "When is double rounding innocuous?", SIGNUM Newsletter 30(3), 1995).
Subnormal results keep this: sums and products are exact in binary64 then, and a quotient that is no midpoint of
binary32 numbers differs from one by more than binary64 rounds off.
"""

from __future__ import annotations

from math import isfinite, ldexp, sqrt
from struct import Struct

from mauve.wcet.flow.run.words import MASK, UNKNOWN, Word

INFINITY, MINUS, NONE, QUIET = 0x7F80_0000, 0x8000_0000, 0x7FC0_0000, 0x0040_0000
_SINGLE, _WORD = Struct("<f"), Struct("<I")
_pack, _unpack, _bits, _of_bits = _SINGLE.pack, _SINGLE.unpack, _WORD.unpack, _WORD.pack

Four = tuple[Word, Word, Word, Word]


def _value(word: int) -> float:
    return _unpack(_of_bits(word))[0]  # type: ignore[no-any-return]


def _word(value: float) -> int:
    """A number rounded to binary32."""
    try:
        return _bits(_pack(value))[0]  # type: ignore[no-any-return]
    except OverflowError:
        return INFINITY if value > 0 else INFINITY | MINUS


def _none(*operands: int) -> int:
    """What a result is that is not a number: the first operand that signals, made quiet, or else the first that is not
    a number, or else the default."""
    found = [operand for operand in operands if operand & ~MINUS > INFINITY]
    return next((operand | QUIET for operand in found if not operand & QUIET), found[0] if found else NONE)


# ------------------------------------------------------------------------------------------------ operations
def float_add(a: Word, b: Word) -> Word:
    """a + b."""
    if type(a) is not int or type(b) is not int:
        return UNKNOWN
    value = _value(a) + _value(b)
    return _word(value) if value == value else _none(a, b)


def float_sub(a: Word, b: Word) -> Word:
    """a - b."""
    if type(a) is not int or type(b) is not int:
        return UNKNOWN
    value = _value(a) - _value(b)
    return _word(value) if value == value else _none(a, b)


def float_mul(a: Word, b: Word) -> Word:
    """a * b."""
    if type(a) is not int or type(b) is not int:
        return UNKNOWN
    value = _value(a) * _value(b)
    return _word(value) if value == value else _none(a, b)


def float_div(a: Word, b: Word) -> Word:
    """a / b."""
    if type(a) is not int or type(b) is not int:
        return UNKNOWN
    dividend, divisor = _value(a), _value(b)
    if not divisor:
        return INFINITY | (a ^ b) & MINUS if dividend and dividend == dividend else _none(a)
    value = dividend / divisor
    return _word(value) if value == value else _none(a, b)


def float_sqrt(a: Word) -> Word:
    """The square root."""
    if type(a) is not int:
        return UNKNOWN
    value = _value(a)
    return _word(sqrt(value)) if value >= 0 else _none(a)


def float_fma(a: Word, b: Word, c: Word) -> Word:
    """a * b + c, rounded once."""
    if type(a) is not int or type(b) is not int or type(c) is not int:
        return UNKNOWN
    x, y, z = _value(a), _value(b), _value(c)
    product = x * y  # exact in binary64
    if not isfinite(product) or not isfinite(z) or product == 0.0 or z == 0.0:
        total = product + z
        if total == total:
            return _word(total)
        return NONE if product != product and x == x and y == y and c & QUIET else _none(c, a, b)
    (above, below), (other_above, other_below) = product.as_integer_ratio(), z.as_integer_ratio()
    return _quotient(above * other_below + other_above * below, below * other_below)


def _quotient(above: int, below: int) -> int:
    """above / below, rounded once; `below` is a power of two. An exact 0 is +0."""
    size, exponent = abs(above), 1 - below.bit_length()
    shift = max(size.bit_length() - 24, -149 - exponent)  # what does not fit 24 bits, or lies below the least number
    if shift > 0:
        low, half = size & (1 << shift) - 1, 1 << shift - 1
        size >>= shift
        size += low > half or (low == half and size & 1)
        exponent += shift
    value = ldexp(size, exponent)
    return _word(-value if above < 0 else value)


def float_neg(a: Word) -> Word:
    """-a, of any bits."""
    return a ^ MINUS if type(a) is int else UNKNOWN


def float_abs(a: Word) -> Word:
    """|a|, of any bits."""
    return a & ~MINUS if type(a) is int else UNKNOWN


# ------------------------------------------------------------------------------------------------ conversions
def float_from_integer(a: Word, signed: bool, size: int, fraction: int) -> Word:
    """The low `size` bits of a as an integer, divided by 2**fraction."""
    if type(a) is not int:
        return UNKNOWN
    value = a & (1 << size) - 1
    if signed and value >> size - 1:
        value -= 1 << size
    return _word(ldexp(value, -fraction))


def float_to_integer(a: Word, signed: bool, size: int, fraction: int, rounds: bool) -> Word:
    """a * 2**fraction as an integer of `size` bits, extended to a word; saturated, and 0 for what is no number."""
    if type(a) is not int:
        return UNKNOWN
    value = _value(a)
    low, high = (-(1 << size - 1), (1 << size - 1) - 1) if signed else (0, (1 << size) - 1)
    if value != value:
        return 0
    if not isfinite(value):
        return (high if value > 0 else low) & MASK
    scaled = ldexp(value, fraction)
    return min(max(round(scaled) if rounds else int(scaled), low), high) & MASK


# ------------------------------------------------------------------------------------------------ FPSCR
def float_compare(a: Word, b: Word) -> Four:
    """N, Z, C and V of comparing two numbers."""
    if type(a) is not int or type(b) is not int:
        return UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN
    x, y = _value(a), _value(b)
    if x == y:
        return 0, 1, 1, 0
    if x < y:
        return 1, 0, 0, 0
    return (0, 0, 1, 0) if x > y else (0, 0, 1, 1)


def float_mode(fpscr: Word) -> Word:
    """0 where FPSCR asks for the arithmetic of this module: rounding to nearest, subnormal numbers, no default
    for what is not a number, no vectors (the form of half precision does not matter)."""
    return 0 if type(fpscr) is int and fpscr & 0x03F7_0000 == 0 else UNKNOWN


def float_flags(fpscr: Word) -> Four:
    """N, Z, C and V in a word for FPSCR."""
    if type(fpscr) is not int:
        return UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN
    return fpscr >> 31 & 1, fpscr >> 30 & 1, fpscr >> 29 & 1, fpscr >> 28 & 1
