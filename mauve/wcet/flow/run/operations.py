"""What compiled blocks call: operations that are more than one expression of Python."""

from __future__ import annotations

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MODULUS
from mauve.wcet.flow.run.words import MASK, SIGN, WILD, Word, made, part_of, range_of


def binary(op: Op, a: Word, b: Word) -> Word:
    """An operation of microop.Op that reads no flags."""
    if type(a) is int and type(b) is int:
        return domain.concrete(op, a, b)
    first, second = range_of(a), range_of(b)
    return WILD if first is None or second is None else made(domain.apply(op, first, second))


def shift_left(a: Word, b: Word) -> Word:
    """SHL by a register."""
    if type(a) is int and type(b) is int:
        amount = b & 0xFF
        return (a << amount) & MASK if amount < 32 else 0
    if type(b) is int:
        amount = b & 0xFF
        return (a << amount) & MASK if amount < 32 else 0
    return binary(Op.SHL, a, b)


def shift_right(a: Word, b: Word) -> Word:
    """LSR by a register."""
    if type(a) is int and type(b) is int:
        return a >> (b & 0xFF)
    return binary(Op.LSR, a, b)


def shift_right_signed(a: Word, b: Word) -> Word:
    """ASR."""
    if type(a) is int and type(b) is int:
        return ((a ^ SIGN) - SIGN >> (b & 0xFF)) & MASK
    return binary(Op.ASR, a, b)


def rotate(a: Word, b: Word) -> Word:
    """ROR."""
    if type(a) is int and type(b) is int:
        amount = b & 31
        return (a >> amount | a << 32 - amount) & MASK
    return binary(Op.ROR, a, b)


def high_unsigned(a: Word, b: Word) -> Word:
    """UMULH."""
    if type(a) is int and type(b) is int:
        return a * b >> 32
    found = binary(Op.UMULH, a, b)
    return (
        part_of(found, a, b, MODULUS) if type(b) is int else part_of(found, b, a, MODULUS) if type(a) is int else found
    )


def high_signed(a: Word, b: Word) -> Word:
    """SMULH."""
    if type(a) is int and type(b) is int:
        return (((a ^ SIGN) - SIGN) * ((b ^ SIGN) - SIGN) >> 32) & MASK
    return binary(Op.SMULH, a, b)


def extend_byte(a: Word) -> Word:
    """SXTB."""
    return ((a & 255 ^ 128) - 128) & MASK if type(a) is int else binary(Op.SXTB, a, 0)


def extend_half(a: Word) -> Word:
    """SXTH."""
    return ((a & 65535 ^ 32768) - 32768) & MASK if type(a) is int else binary(Op.SXTH, a, 0)


def rotate_through_carry(a: Word, carry: Word) -> Word:
    """RRX; `carry` is 0, 1 or unknown."""
    if type(a) is int and type(carry) is int:
        return carry << 31 | a >> 1
    return (a >> 1) + carry_word(carry) * SIGN & MASK


def carry_word(carry: Word) -> Word:
    """C as a number."""
    return carry if type(carry) is int else made(domain.BIT)


def divide(a: Word, b: Word) -> Word:
    """UDIV."""
    if type(a) is int and type(b) is int:
        return a // b if b else 0
    found = binary(Op.UDIV, a, b)
    return part_of(found, a, 1, b) if type(b) is int and b > 1 else found


def leading_zeros(a: Word) -> Word:
    """CLZ."""
    return 32 - a.bit_length() if type(a) is int else binary(Op.CLZ, a, 0)


def overflows(a: Word, b: Word) -> bool:
    """Whether the sum of two words, without signs, is none. Raises Undecided."""
    if type(a) is int and type(b) is int:
        return a + b >= MODULUS
    if type(b) is int:
        return a > MASK - b if b else False
    if type(a) is int:
        return b > MASK - a if a else False
    return b > (MASK - a)


__all__ = [
    "binary",
    "carry_word",
    "divide",
    "extend_byte",
    "extend_half",
    "high_signed",
    "high_unsigned",
    "leading_zeros",
    "overflows",
    "rotate",
    "rotate_through_carry",
    "shift_left",
    "shift_right",
    "shift_right_signed",
]
