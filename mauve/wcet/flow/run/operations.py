"""What compiled blocks call: operations that are more than one expression of Python, and the condition flags."""

from __future__ import annotations

from mauve.wcet.binary.microop import Op, Shift
from mauve.wcet.flow import domain
from mauve.wcet.flow.run.words import MASK, SIGN, UNKNOWN, Undecided, Unknown, Word

Four = tuple[Word, Word, Word, Word]
"""N, Z, C and V, each 0, 1 or unknown."""

_ANY: Four = (UNKNOWN, UNKNOWN, UNKNOWN, UNKNOWN)


def binary(op: Op, a: Word, b: Word) -> Word:
    """An operation of microop.Op that reads no flags."""
    if type(a) is int and type(b) is int:
        return domain.concrete(op, a, b)
    return UNKNOWN


def shift_left(a: Word, b: Word) -> Word:
    """SHL by a register."""
    if type(b) is not int:
        return UNKNOWN
    amount = b & 0xFF
    return (a << amount) & MASK if amount < 32 else 0


def shift_right(a: Word, b: Word) -> Word:
    """LSR by a register."""
    if type(a) is int and type(b) is int:
        return a >> (b & 0xFF)
    return UNKNOWN


def shift_right_signed(a: Word, b: Word) -> Word:
    """ASR by a register."""
    if type(a) is int and type(b) is int:
        return ((a ^ SIGN) - SIGN >> (b & 0xFF)) & MASK
    return UNKNOWN


def rotate(a: Word, b: Word) -> Word:
    """ROR."""
    if type(a) is int and type(b) is int:
        amount = b & 31
        return (a >> amount | a << 32 - amount) & MASK
    return UNKNOWN


def rotate_through_carry(a: Word, carry: Word) -> Word:
    """RRX."""
    if type(a) is int and type(carry) is int:
        return carry << 31 | a >> 1
    return UNKNOWN


def divide(a: Word, b: Word) -> Word:
    """UDIV."""
    if type(a) is int and type(b) is int:
        return a // b if b else 0
    return UNKNOWN


def leading_zeros(a: Word) -> Word:
    """CLZ."""
    return 32 - a.bit_length() if type(a) is int else UNKNOWN


def flags_of_difference(a: Word, b: Word) -> Four:
    """All four of a - b."""
    if type(a) is int and type(b) is int:
        d = (a - b) & MASK
        return d >> 31, int(d == 0), int(a >= b), ((a ^ b) & (a ^ d)) >> 31
    try:
        zero, carry = int(a == b), int(a >= b)
    except Undecided:
        return _ANY
    return UNKNOWN, zero, carry, UNKNOWN


def flags_of_sum(a: Word, b: Word, carry: Word = 0) -> Four:
    """All four of a + b + C."""
    if type(a) is int and type(b) is int and type(carry) is int:
        total = a + b + carry
        d = total & MASK
        return d >> 31, int(d == 0), int(total > MASK), (~(a ^ b) & (a ^ d) & MASK) >> 31
    return _ANY


def flags_with_borrow(a: Word, b: Word, carry: Word) -> Four:
    """All four of a - b - (1 - C)."""
    return flags_of_sum(a, b ^ MASK, carry) if type(b) is int else _ANY


def sign_and_zero(a: Word) -> tuple[Word, Word]:
    """N and Z of a."""
    if type(a) is int:
        return a >> 31, int(a == 0)
    try:
        return UNKNOWN, int(a == 0)
    except Undecided:
        return UNKNOWN, UNKNOWN


def sign_and_zero_wide(a: Word, b: Word) -> tuple[Word, Word]:
    """N of b and Z of (b:a)."""
    if type(a) is int and type(b) is int:
        return b >> 31, int(a | b == 0)
    return (b >> 31 if type(b) is int else UNKNOWN), UNKNOWN


def carry_out(shift: Shift, value: Word, amount: Word, before: Word) -> Word:
    """C after SetCarry."""
    if shift is Shift.RRX:
        return value & 1
    if type(amount) is not int:
        return UNKNOWN
    by = amount & 0xFF
    if by == 0:
        return before
    if type(value) is not int:
        return UNKNOWN
    match shift:
        case Shift.LSL:
            return value >> (32 - by) & 1 if by <= 32 else 0
        case Shift.LSR:
            return value >> (by - 1) & 1
        case Shift.ASR:
            return ((value ^ SIGN) - SIGN) >> (by - 1) & 1
        case _:
            return value >> (by - 1) % 32 & 1


def holds(code: int, n: Word, z: Word, c: Word, v: Word) -> bool:
    """Whether a condition (its even encoding) holds; raises Undecided."""
    match code:
        case 0:
            return bool(z)
        case 2:
            return bool(c)
        case 4:
            return bool(n)
        case 6:
            return bool(v)
        case 8:
            return _both(c, z)
        case 10:
            return _equal(n, v)
        case _:
            if type(z) is int and z:
                return False
            return not z and _equal(n, v)


def _both(c: Word, z: Word) -> bool:
    if (type(c) is int and not c) or (type(z) is int and z):
        return False
    return bool(c) and not z


def _equal(n: Word, v: Word) -> bool:
    if isinstance(n, Unknown) or isinstance(v, Unknown):
        raise Undecided
    return n == v
