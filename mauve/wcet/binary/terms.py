"""Symbolic values along one path of code, for finding the targets of indirect jumps.

A term is a number in a `Terms` table: a constant, the value of a register at the start of the path, an unknown, an
operation on terms, or a load. Equal terms have equal numbers; operands come before what is made of them, so
everything is computed in one pass in order of number, without recursion.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from mauve.wcet.binary.microop import Condition, FlagKind, Op

MASK = 0xFFFFFFFF
Interval = tuple[int, int]
"""Unsigned 32-bit values from the first to the last, both included."""
FULL: tuple[Interval, ...] = ((0, MASK),)
Flags = tuple[FlagKind, int, int]
"""What set the flags: the kind and the terms of its operands."""


def signed(value: int) -> int:
    """The 32-bit value as a two's complement number."""
    return value - (1 << 32) if value >> 31 else value


_BINARY: dict[Op, Callable[[int, int], int]] = {
    Op.ADD: lambda a, b: a + b,
    Op.SUB: lambda a, b: a - b,
    Op.AND: lambda a, b: a & b,
    Op.OR: lambda a, b: a | b,
    Op.XOR: lambda a, b: a ^ b,
    Op.SHL: lambda a, b: a << (b & 255) if b & 255 < 32 else 0,
    Op.LSR: lambda a, b: a >> (b & 255),
    Op.ASR: lambda a, b: signed(a) >> min(b & 255, 31),
    Op.ROR: lambda a, b: a >> (b & 31) | a << (32 - (b & 31)),
    Op.MUL: lambda a, b: a * b,
    Op.UMULH: lambda a, b: a * b >> 32,
    Op.SMULH: lambda a, b: signed(a) * signed(b) >> 32,
    Op.UDIV: lambda a, b: a // b if b else 0,
}
_UNARY: dict[Op, Callable[[int], int]] = {
    Op.NOT: lambda a: ~a,
    Op.CLZ: lambda a: 32 - a.bit_length(),
    Op.SXTB: lambda a: ((a & 0xFF) ^ 0x80) - 0x80,
    Op.SXTH: lambda a: ((a & 0xFFFF) ^ 0x8000) - 0x8000,
    Op.UXTB: lambda a: a & 0xFF,
    Op.UXTH: lambda a: a & 0xFFFF,
}


_WIDTHS = {Op.UXTB: (1, False), Op.UXTH: (2, False), Op.SXTB: (1, True), Op.SXTH: (2, True)}
"""Of operations that extend: bytes, and whether with the sign."""


def concrete(op: Op, a: int, b: int) -> int | None:
    """The value of an operation on constants; None for those that jumps are not made of."""
    if op in _BINARY:
        return _BINARY[op](a, b) & MASK
    if op in _UNARY:
        return _UNARY[op](a) & MASK
    return None


# ---------------------------------------------------------------------------------------------------- intervals
def intersect(first: tuple[Interval, ...], second: tuple[Interval, ...]) -> tuple[Interval, ...]:
    """The values in both."""
    return tuple((max(a, c), min(b, d)) for a, b in first for c, d in second if max(a, c) <= min(b, d))


def shift_by(intervals: tuple[Interval, ...], amount: int) -> tuple[Interval, ...]:
    """All values plus a constant, modulo 2**32."""
    found: list[Interval] = []
    for low, high in intervals:
        low, high = low + amount, high + amount
        base = low >> 32 << 32
        low, high = low - base, high - base
        found += [(low, high)] if high <= MASK else [(low, MASK), (0, high - MASK - 1)]
    return tuple(found)


def negate(intervals: tuple[Interval, ...]) -> tuple[Interval, ...]:
    """All values times -1, modulo 2**32."""
    return shift_by(tuple((MASK - high, MASK - low) for low, high in intervals), 1)


def _signed_interval(low: int, high: int) -> tuple[Interval, ...]:
    if low > high:
        return ()
    if low >= 0 or high < 0:
        return ((low & MASK, high & MASK),)
    return ((0, high), (low & MASK, MASK))


def compared(condition: Condition, k: int) -> tuple[Interval, ...]:
    """The values x for which the condition holds after `cmp x, #k`."""
    s, least, most = signed(k), -(1 << 31), (1 << 31) - 1
    match condition:
        case Condition.EQ:
            return ((k, k),)
        case Condition.NE:
            return tuple(i for i in ((0, k - 1), (k + 1, MASK)) if i[0] <= i[1])
        case Condition.CS:
            return ((k, MASK),)
        case Condition.CC:
            return ((0, k - 1),) if k else ()
        case Condition.HI:
            return ((k + 1, MASK),) if k < MASK else ()
        case Condition.LS:
            return ((0, k),)
        case Condition.GE:
            return _signed_interval(s, most)
        case Condition.LT:
            return _signed_interval(least, s - 1)
        case Condition.GT:
            return _signed_interval(s + 1, most)
        case Condition.LE:
            return _signed_interval(least, s)
        case Condition.MI | Condition.PL if k == 0:
            return ((1 << 31, MASK),) if condition is Condition.MI else ((0, (1 << 31) - 1),)
    return FULL


_SWAPPED = {
    Condition.EQ: Condition.EQ,
    Condition.NE: Condition.NE,
    Condition.CS: Condition.LS,
    Condition.CC: Condition.HI,
    Condition.HI: Condition.CC,
    Condition.LS: Condition.CS,
    Condition.GE: Condition.LE,
    Condition.LT: Condition.GT,
    Condition.GT: Condition.LT,
    Condition.LE: Condition.GE,
}


# ---------------------------------------------------------------------------------------------------- terms
class Terms:
    """The table of terms of one path, and what is known about them: `facts` are conditions that hold on the path."""

    def __init__(self) -> None:
        self.table: list[tuple[Any, ...]] = []
        self.numbers: dict[tuple[Any, ...], int] = {}
        self.facts: list[tuple[Condition, Flags]] = []
        self._bounds: dict[int, Interval] = {}

    def _term(self, *parts: Any) -> int:
        number = self.numbers.get(parts)
        if number is None:
            number = self.numbers[parts] = len(self.table)
            self.table.append(parts)
        return number

    def constant(self, value: int) -> int:
        """The term of a constant."""
        return self._term("constant", value & MASK)

    def initial(self, register: int) -> int:
        """What the register holds where the path starts."""
        return self._term("initial", register)

    def unknown(self) -> int:
        """A fresh value nobody knows."""
        return self._term("unknown", len(self.table))

    def value(self, term: int) -> int | None:
        """The constant that a term is, if it is one."""
        parts = self.table[term]
        return parts[1] if parts[0] == "constant" else None

    def load(self, address: int, size: int, is_signed: bool, version: int, popped: bool) -> int:
        """A value from memory as it was after `version` changes; `popped`: by an instruction that moves sp past it."""
        return self._term("load", address, size, is_signed, version, popped)

    def either(self, guard: tuple[int, Condition], new: int, old: int) -> int:
        """`new` when the condition holds on the flags of that version, else `old`."""
        return new if new == old else self._term("either", new, old, guard)

    def apply(self, op: Op, a: int, b: int) -> int:
        """The result of an operation, folded where constants allow."""
        x, y = self.value(a), self.value(b)
        unary = op in _UNARY
        if op is Op.MOV:
            return a
        if op not in _BINARY and not unary:
            return self.unknown()
        if x is not None and (unary or y is not None):
            result = concrete(op, x, y or 0)
            if result is not None:
                return self.constant(result)
        if op is Op.SUB and y is not None:
            op, b, y = Op.ADD, self.constant(-y), -y & MASK
        if op in (Op.ADD, Op.AND, Op.OR, Op.MUL, Op.XOR) and x is not None:
            a, b, x, y = b, a, y, x
        if op is Op.ADD and y is not None:
            if y == 0:
                return a
            inner = self.table[a]
            if inner[0] is Op.ADD and (z := self.value(inner[2])) is not None:
                return self.apply(Op.ADD, inner[1], self.constant(y + z))
        if (op is Op.SHL and y == 0) or (unary and self._is_as_it_was(op, a)):
            return a
        return self._term(op, a, self.constant(0) if unary else b)

    def _is_as_it_was(self, op: Op, term: int) -> bool:
        """Whether extending a term changes nothing: it was read or extended that way before."""
        parts = self.table[term]
        if op not in _WIDTHS or parts[0] is op:
            return parts[0] is op and op in _WIDTHS
        size, is_signed = _WIDTHS[op]
        return parts[0] == "load" and parts[3] is is_signed and parts[2] <= size

    def operands(self, term: int) -> tuple[int, ...]:
        """The terms that a term is made of."""
        parts = self.table[term]
        if isinstance(parts[0], Op) or parts[0] == "either":
            return (parts[1], parts[2])
        return (parts[1],) if parts[0] == "load" else ()

    def below(self, term: int) -> list[int]:
        """The term and all it is made of, operands first."""
        seen: set[int] = set()
        work = [term]
        while work:
            number = work.pop()
            if number not in seen:
                seen.add(number)
                work += self.operands(number)
        return sorted(seen)

    # ------------------------------------------------------------------------------------------------ ranges
    def ranges(self, term: int) -> tuple[Interval, ...]:
        """The values that the term may have on the path."""
        found: tuple[Interval, ...] = (self.bounds(term),)
        base, sign, offset = self._linear(term)
        for condition, (kind, a, b) in self.facts:
            for side, other, holds in ((a, b, condition), (b, a, _SWAPPED.get(condition))):
                if kind is FlagKind.LOGIC:
                    other, kind_fits = self.constant(0), side == a
                else:
                    kind_fits = kind is FlagKind.SUB
                limit = self.value(other)
                if limit is None or holds is None or not kind_fits:
                    continue
                if kind is FlagKind.LOGIC and holds not in (Condition.EQ, Condition.NE, Condition.MI, Condition.PL):
                    continue
                base_of_side, sign_of_side, offset_of_side = self._linear(side)
                if base_of_side != base:
                    continue
                allowed = shift_by(compared(holds, limit), -offset_of_side)
                allowed = allowed if sign == sign_of_side else negate(allowed)
                found = intersect(found, shift_by(allowed, offset))
        if found == FULL and (extended := self._sign_extended(term)) is not None:
            return extended
        return found

    def _sign_extended(self, term: int) -> tuple[Interval, ...] | None:
        """The values of a signed byte or halfword, of which the path may have compared the unsigned one."""
        parts = self.table[term]
        size = _WIDTHS[parts[0]][0] if parts[0] in (Op.SXTB, Op.SXTH) else parts[2] if parts[0] == "load" else 4
        if size > 2 or (parts[0] == "load" and not parts[3]):
            return None
        half = 1 << 8 * size - 1
        unsigned = self.numbers.get((Op.UXTB if size == 1 else Op.UXTH, term, self.constant(0)))
        ranges = ((0, 2 * half - 1),) if unsigned is None else self.ranges(unsigned)
        low, high = intersect(ranges, ((0, half - 1),)), intersect(ranges, ((half, 2 * half - 1),))
        return (*low, *shift_by(high, -2 * half))

    def _linear(self, term: int) -> tuple[int, int, int]:
        """The term as sign * base + offset."""
        sign, offset = 1, 0
        while True:
            parts = self.table[term]
            if parts[0] is Op.ADD and (k := self.value(parts[2])) is not None:
                term, offset = parts[1], offset + sign * k
            elif parts[0] is Op.SUB and (k := self.value(parts[1])) is not None:
                term, offset, sign = parts[2], offset + sign * k, -sign
            else:
                return term, sign, offset & MASK

    def bounds(self, term: int) -> Interval:
        """An interval around the term that follows from how it is made; asked for when all facts of the path are
        known."""
        known = self._bounds
        if term not in known:
            ready = all(operand in known for operand in self.operands(term))
            for number in (term,) if ready else self.below(term):
                if number not in known:
                    known[number] = self._bound(number, known)
        return known[term]

    def _bound(self, number: int, known: dict[int, Interval]) -> Interval:
        parts = self.table[number]
        match parts[0]:
            case "constant":
                return parts[1], parts[1]
            case "load" if not parts[3] and parts[2] < 4:
                return 0, (1 << 8 * parts[2]) - 1
            case "either":
                (a, b), (c, d) = known[parts[1]], known[parts[2]]
                return min(a, c), max(b, d)
            case Op.CLZ:
                return 0, 32
            case Op.UXTB | Op.UXTH as op:
                low, high = known[parts[1]]
                top = 0xFF if op is Op.UXTB else 0xFFFF
                return (low, high) if high <= top else (0, top)
            case Op.AND:
                return 0, min(known[parts[1]][1], known[parts[2]][1])
            case Op.LSR | Op.UDIV as op if (k := self.value(parts[2])) is not None and (k or op is Op.LSR):
                low, high = known[parts[1]]
                return (low >> (k & 255), high >> (k & 255)) if op is Op.LSR else (low // k, high // k)
            case Op.ADD | Op.SHL | Op.MUL as op:
                (a, b), (c, d) = known[parts[1]], known[parts[2]]
                if op is Op.SHL and d > 31:
                    return 0, MASK
                low, high = (a + c, b + d) if op is Op.ADD else (a << c, b << d) if op is Op.SHL else (a * c, b * d)
                return (low, high) if high <= MASK else (0, MASK)
            case Op.SUB:
                return self._difference(parts[1], parts[2], known)
        return 0, MASK

    def _difference(self, first: int, second: int, known: dict[int, Interval]) -> Interval:
        """a - b; the difference of the leading zeros of two ordered values is not negative (unrolled divisions)."""
        (a, b), (c, d) = known[first], known[second]
        x, y = self.table[first], self.table[second]
        if x[0] is Op.CLZ and y[0] is Op.CLZ and self._at_most(x[1], y[1]):
            zero = any(low == 0 for low, _ in self.ranges(x[1]))
            return 0, 32 if zero else 31
        return (a - d, b - c) if a >= d else (0, MASK)

    def _at_most(self, small: int, large: int) -> bool:
        """Whether small <= large, unsigned, is among the facts."""
        for condition, (kind, a, b) in self.facts:
            if kind is FlagKind.SUB and (
                ((a, b) == (large, small) and condition in (Condition.CS, Condition.HI))
                or ((a, b) == (small, large) and condition in (Condition.CC, Condition.LS))
            ):
                return True
        return False
