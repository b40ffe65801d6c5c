"""The condition flags of a run: a bit that is known, or the operands that they were made of."""

from __future__ import annotations

from enum import Enum

from mauve.wcet.binary.microop import Shift
from mauve.wcet.flow.run.operations import carry_word, overflows
from mauve.wcet.flow.run.words import MASK, SIGN, UNKNOWN, Undecided, Unknown, Word

EQ, CS, MI, VS, HI, GE, GT = range(0, 14, 2)
"""The conditions by their even encodings; the odd ones are their negations."""


class Source(Enum):
    """What the flags tell of."""

    DIFFERENCE = "a - b"
    SUM = "a + b"
    RESULT = "a"


class Flags(Unknown):
    """Flags that are made of `a` and `b`, not all of which are known; `result` is the word that came of it, if that
    was kept. It stands in the place of each of the flags."""

    __slots__ = ("a", "b", "result", "source")

    def __init__(self, source: Source, a: Word, b: Word = 0, result: Word | None = None) -> None:
        self.source, self.a, self.b, self.result = source, a, b, result

    def holds(self, code: int) -> bool:
        """Whether a condition (its even encoding) holds; raises Undecided."""
        a, b = self.a, self.b
        match self.source, code:
            case Source.DIFFERENCE, 0:
                return a == b
            case Source.DIFFERENCE, 2:
                return not a < b
            case Source.DIFFERENCE, 4:
                return bool((a - b) & SIGN)
            case Source.DIFFERENCE, 8:
                return a > b
            case Source.DIFFERENCE, 10:
                return not (a ^ SIGN) < (b ^ SIGN)
            case Source.DIFFERENCE, 12:
                return (a ^ SIGN) > (b ^ SIGN)
            case Source.SUM, 0:
                return (a + b) & MASK == 0
            case Source.SUM, 2:
                return overflows(a, b)
            case Source.SUM, 4:
                return bool((a + b) & SIGN)
            case Source.RESULT, 0:
                return a == 0
            case Source.RESULT, 4:
                return bool(a & SIGN)
        raise Undecided

    def __repr__(self) -> str:
        return f"flags of {self.source.value}"


Four = tuple[Word, Word, Word, Word]
"""N, Z, C and V, each 0, 1 or unknown."""


def of_difference(a: Word, b: Word, result: Word | None = None) -> Four:
    """All four of a - b."""
    if type(a) is int and type(b) is int:
        d = (a - b) & MASK
        return d >> 31, int(d == 0), int(a >= b), ((a ^ b) & (a ^ d)) >> 31
    made = Flags(Source.DIFFERENCE, a, b, result)
    return made, _known(made, 0), _known(made, 2), made


def of_sum(a: Word, b: Word, result: Word | None = None) -> Four:
    """All four of a + b."""
    if type(a) is int and type(b) is int:
        return of_sum_with_carry(a, b, 0)
    made = Flags(Source.SUM, a, b, result)
    return made, made, _known(made, 2), made


def _known(flags: Flags, code: int) -> Word:
    try:
        return int(flags.holds(code))
    except Undecided:
        return flags


def of_sum_with_carry(a: Word, b: Word, carry: Word) -> Four:
    """All four of a + b + C."""
    if type(a) is int and type(b) is int and type(carry) is int:
        total = a + b + carry
        d = total & MASK
        return d >> 31, int(d == 0), int(total > MASK), (~(a ^ b) & (a ^ d) & MASK) >> 31
    made = Flags(Source.RESULT, (a + b + carry_word(carry)) & MASK)
    return made, made, UNKNOWN, UNKNOWN


def of_difference_with_borrow(a: Word, b: Word, carry: Word) -> Four:
    """All four of a - b - (1 - C)."""
    return of_sum_with_carry(a, b ^ MASK, carry)


def of_result(a: Word) -> tuple[Word, Word]:
    """N and Z of a."""
    if type(a) is int:
        return a >> 31, int(a == 0)
    made = Flags(Source.RESULT, a)
    return made, _known(made, 0)


def of_wide(a: Word, b: Word) -> tuple[Word, Word]:
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
        if shift is Shift.LSL:
            return value >> (32 - by) & 1 if by <= 32 else 0
        if shift is Shift.LSR:
            return value >> (by - 1) & 1 if by <= 32 else 0
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
            return bool(z) if type(z) is not Flags else z.holds(0)
        case 2:
            return bool(c) if type(c) is not Flags else c.holds(2)
        case 4:
            return bool(n) if type(n) is not Flags else n.holds(4)
        case 6:
            return bool(v)
        case 8:
            return _higher(c, z, n)
        case 10:
            return _equal(n, v)
        case _:
            if type(z) is int and z:
                return False
            if type(n) is Flags and n is v:
                return n.holds(12)
            return not holds(0, n, z, c, v) and _equal(n, v)


def told_by(code: int, n: Word, z: Word, c: Word, v: Word) -> Flags | None:
    """The flags that a condition asks, where it asks those of one instruction."""
    asked = {0: (z,), 2: (c,), 4: (n,), 8: (n, v), 10: (n, v), 12: (n, v)}.get(code, ())
    found = {id(one): one for one in asked}
    if len(found) == 1:
        (one,) = found.values()
        return one if type(one) is Flags else None
    return None


def _higher(c: Word, z: Word, n: Word) -> bool:
    if (type(c) is int and not c) or (type(z) is int and z):
        return False
    if type(n) is Flags and (c is n or z is n):
        return n.holds(8)
    return holds(2, 0, 0, c, 0) and not holds(0, 0, z, 0, 0)


def _equal(n: Word, v: Word) -> bool:
    if type(n) is Flags and n is v:
        return n.holds(10)
    if isinstance(n, Unknown) or isinstance(v, Unknown):
        raise Undecided
    return n == v


__all__ = [
    "Flags",
    "Source",
    "carry_out",
    "holds",
    "of_difference",
    "of_difference_with_borrow",
    "of_result",
    "of_sum",
    "of_sum_with_carry",
    "of_wide",
    "told_by",
]
