"""The values of a run: Python integers for known words, `Stack` for addresses in the stack, `UNKNOWN` for the rest.

Arithmetic is written as on plain integers (and masked to 32 bits by the caller): the classes here say what it means for
the other values. What depends on an unknown is unknown; a condition that does raises `Undecided`. The stack begins at
any multiple of 8 (AAPCS), so the low three bits of an address in it are known, and two of them can be compared.
"""

from __future__ import annotations

MASK, SIGN = 0xFFFF_FFFF, 0x8000_0000


class Undecided(Exception):
    """A condition depends on an unknown value."""


class Unknown:
    """Any word."""

    __slots__ = ()

    def _same(self, _other: object) -> Unknown:
        return self

    def _undecided(self, _other: object) -> bool:
        raise Undecided

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __lshift__ = __rlshift__ = _same
    __rshift__ = __rrshift__ = __or__ = __ror__ = __xor__ = __rxor__ = _same
    __lt__ = __le__ = __gt__ = __ge__ = _undecided
    __hash__ = object.__hash__

    def __and__(self, other: object) -> Unknown | int:
        return 0 if type(other) is int and other == 0 else self

    __rand__ = __and__

    def __eq__(self, other: object) -> bool:
        raise Undecided

    def __ne__(self, other: object) -> bool:
        raise Undecided

    def __bool__(self) -> bool:
        raise Undecided

    def __neg__(self) -> Unknown:
        return self

    def __repr__(self) -> str:
        return "?"


UNKNOWN = Unknown()


class Stack(Unknown):
    """The value of sp at the entry of the program plus `offset`."""

    __slots__ = ("offset",)

    def __init__(self, offset: int) -> None:
        self.offset = offset

    def __add__(self, other: object) -> Unknown:
        return Stack(signed(self.offset + other)) if type(other) is int else UNKNOWN

    __radd__ = __add__  # type: ignore[assignment]

    def __sub__(self, other: object) -> Unknown | int:  # type: ignore[override]
        if type(other) is int:
            return Stack(signed(self.offset - other))
        return self.offset - other.offset if type(other) is Stack else UNKNOWN

    def _lost(self, _other: object) -> Unknown:
        return UNKNOWN

    __rsub__ = __mul__ = __rmul__ = __rlshift__ = __rshift__ = __rrshift__ = _lost


    def __or__(self, other: object) -> Unknown:
        return _low_bits(self, other, lambda a, b: a | b)

    def __xor__(self, other: object) -> Unknown:
        return _low_bits(self, other, lambda a, b: a ^ b)

    __ror__, __rxor__ = __or__, __xor__  # type: ignore[assignment]

    def __lshift__(self, other: object) -> Unknown | int:  # type: ignore[override]
        return (self.offset & 7) << other if type(other) is int and other >= 29 else UNKNOWN

    def __and__(self, other: object) -> Unknown | int:
        if type(other) is not int:
            return UNKNOWN
        if other == MASK:
            return self
        if other <= 7:
            return self.offset & other
        if other | 7 == MASK:
            return Stack(self.offset - (self.offset & ~other & 7))
        return Low(self.offset & other & 7) if other & 7 == 7 else UNKNOWN

    __rand__ = __and__

    def __eq__(self, other: object) -> bool:
        if type(other) is Stack:
            return self.offset == other.offset
        if type(other) is int and other == 0:
            return False
        raise Undecided

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __hash__(self) -> int:
        return hash(self.offset)

    def __lt__(self, other: object) -> bool:
        if type(other) is Stack:
            return self.offset < other.offset
        if type(other) is int and other == 0:
            return False
        raise Undecided

    def __ge__(self, other: object) -> bool:
        return not self < other

    def __gt__(self, other: object) -> bool:
        if type(other) is int and other == 0:
            return True
        if type(other) is Stack:
            return self.offset > other.offset
        raise Undecided

    def __le__(self, other: object) -> bool:
        return not self > other

    def __bool__(self) -> bool:
        return True

    def __repr__(self) -> str:
        return f"sp{self.offset:+d}"


class Low(Unknown):
    """A word of which the low three bits are known."""

    __slots__ = ("bits",)

    def __init__(self, bits: int) -> None:
        self.bits = bits & 7

    def __and__(self, other: object) -> Unknown | int:
        if type(other) is int and other <= 7:
            return self.bits & other
        return self if type(other) is int and other == MASK else UNKNOWN

    __rand__ = __and__

    def __or__(self, other: object) -> Unknown:
        return _low_bits(self, other, lambda a, b: a | b)

    def __xor__(self, other: object) -> Unknown:
        return _low_bits(self, other, lambda a, b: a ^ b)

    __ror__, __rxor__ = __or__, __xor__  # type: ignore[assignment]

    def __lshift__(self, other: object) -> Unknown | int:  # type: ignore[override]
        return self.bits << other if type(other) is int and other >= 29 else UNKNOWN

    def _lost(self, _other: object) -> Unknown:
        return UNKNOWN

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __rlshift__ = _lost
    __rshift__ = __rrshift__ = _lost


Word = int | Unknown


def _bits(value: object) -> int | None:
    if type(value) is int:
        return value & 7
    if type(value) is Stack:
        return value.offset & 7
    return value.bits if type(value) is Low else None


def _low_bits(a: object, b: object, combine) -> Unknown:  # type: ignore[no-untyped-def]
    first, second = _bits(a), _bits(b)
    return UNKNOWN if first is None or second is None else Low(combine(first, second))


def signed(value: int) -> int:
    """A word read as two's complement."""
    return ((value + SIGN) & MASK) - SIGN


def merge(a: Word, b: Word) -> Word:
    """A value that covers both."""
    if a is b or (type(a) is int and type(b) is int and a == b):
        return a
    if type(a) is Stack and type(b) is Stack and a.offset == b.offset:
        return a
    return UNKNOWN
