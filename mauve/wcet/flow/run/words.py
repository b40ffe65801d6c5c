"""The values of a run: Python integers for known words; what else is known of a word is an `Unknown` or one of its
subclasses.

Arithmetic is written as on plain integers and masked to 32 bits by the caller: the classes here say what it means for
the other values, modulo 2**32. A condition that an unknown leaves open raises `Undecided`. The stack begins at any
multiple of 8 (AAPCS), so the low three bits of an address in it are known, and two of them can be compared.

An object of class `Some` stands for one and the same word wherever it is found: copies of a value are the same object,
so that what a branch tells of it holds for all of them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import TOP, Range

MASK, SIGN = 0xFFFF_FFFF, 0x8000_0000


class Undecided(Exception):
    """A condition depends on an unknown value."""


class Unknown:
    """Any word that is no address in the stack."""

    __slots__ = ()

    def _lost(self, other: object) -> Unknown:
        return WILD if is_wild(other) else UNKNOWN

    def _undecided(self, _other: object) -> bool:
        raise Undecided

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __lshift__ = __rlshift__ = _lost
    __or__ = __ror__ = __xor__ = __rxor__ = _lost
    __lt__ = __le__ = __gt__ = __ge__ = _undecided
    __hash__ = object.__hash__

    def __and__(self, other: object) -> Word:
        return made(domain.bit_and(TOP, domain.constant(other))) if type(other) is int else self._lost(other)

    __rand__ = __and__

    def __rshift__(self, other: object) -> Word:
        if type(other) is int:
            return made(domain.apply(Op.LSR, TOP, domain.constant(other)))
        return self._lost(other)

    __rrshift__ = _lost

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


class Wild(Unknown):
    """Any word; it may be an address in the stack."""

    __slots__ = ()

    def _lost(self, other: object) -> Unknown:
        return WILD

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __lshift__ = __rlshift__ = _lost
    __rshift__ = __rrshift__ = __or__ = __ror__ = __xor__ = __rxor__ = _lost

    def __and__(self, other: object) -> Word:
        return 0 if type(other) is int and other == 0 else WILD

    __rand__ = __and__

    def __repr__(self) -> str:
        return "??"


UNKNOWN = Unknown()
WILD = Wild()


@dataclass(frozen=True, slots=True)
class Source:
    """Where a word was read: the address, the bytes and what was made of them, and the stores done before."""

    address: Ranged
    size: int
    extension: Op
    stores: int


class Ranged(Unknown):
    """One word out of a `range`.

    `home` is a place in memory (address and size) that it was found in or put to. A word that is the sum of another and
    a number has that other as its `root` and the number as its `offset`; one that is the sum of two words has them as
    its `terms`; one that was read at an address that is not known has a `source`.
    """

    __slots__ = ("home", "offset", "range", "root", "source", "terms")

    def __init__(self, values: Range, root: Ranged | None = None, offset: int = 0) -> None:
        self.range = values
        self.root = root
        self.offset = offset
        self.home: tuple[int, int] | None = None
        self.terms: tuple[Ranged, Ranged] | None = None
        self.source: Source | None = None

    @property
    def base(self) -> Ranged:
        """What all words with a known distance from this one have in common."""
        return self if self.root is None else self.root

    def moved(self, number: int) -> Word:
        """The sum with a number."""
        number &= MASK
        if not number:
            return self
        return type(self)(domain.shift(self.range, number), self.base, (self.offset + number) & MASK)

    __hash__ = object.__hash__


class Some(Ranged):
    """One word out of a range that is no address in the stack. `low` (a word, bits, shift): it is that many low bits of
    the word, shifted to the left. `part` (a word, a, b): it is at most a/b of the word, as numbers without sign. `less`
    (a word, another): it is the first less the second."""

    __slots__ = ("less", "low", "part")

    def __init__(self, values: Range, root: Ranged | None = None, offset: int = 0) -> None:
        super().__init__(values, root, offset)
        self.low: tuple[Some, int, int] | None = None
        self.part: tuple[Some, int, int] | None = None
        self.less: tuple[Ranged, Ranged] | None = None

    def _with(self, op: Op, other: object, *, swapped: bool = False) -> Word:
        values = range_of(other)
        if values is None:
            return WILD
        return made(domain.apply(op, values, self.range) if swapped else domain.apply(op, self.range, values))

    def __add__(self, other: object) -> Word:  # type: ignore[override]
        if type(other) is int:
            return self.moved(other)
        if isinstance(other, Stack | Stacks):
            return other + self
        found = self._with(Op.ADD, other)
        if type(found) is Some and type(other) is Some:
            found.terms = self, other
        return found

    __radd__ = __add__  # type: ignore[assignment]

    def __sub__(self, other: object) -> Word:  # type: ignore[override]
        if type(other) is int:
            return self.moved(-other)
        if type(other) is Some and other.base is self.base:
            return (self.offset - other.offset) & MASK
        return _difference(self._with(Op.SUB, other), self, other)

    def __rsub__(self, other: object) -> Word:  # type: ignore[override]
        return self._with(Op.SUB, other, swapped=True)

    def __mul__(self, other: object) -> Word:  # type: ignore[override]
        return self._with(Op.MUL, other)

    __rmul__ = __mul__  # type: ignore[assignment]

    def __lshift__(self, other: object) -> Word:  # type: ignore[override]
        found = self._with(Op.SHL, other)
        if type(found) is Some and type(other) is int and 0 < other < 32:
            found.low = (self, 32 - other, other)
        return found

    def __rshift__(self, other: object) -> Word:
        found = self._with(Op.LSR, other)
        return part_of(found, self, 1, 1 << other) if type(other) is int and other < 32 else found

    def __or__(self, other: object) -> Word:  # type: ignore[override]
        return self if other is self else self._with(Op.OR, other)

    __ror__ = __or__  # type: ignore[assignment]

    def __xor__(self, other: object) -> Word:  # type: ignore[override]
        if type(other) is int and other == SIGN:
            return self.moved(SIGN)
        return 0 if other is self else self._with(Op.XOR, other)

    __rxor__ = __xor__  # type: ignore[assignment]

    def __and__(self, other: object) -> Word:
        if other is self or (type(other) is int and _keeps(other, self.range)):
            return self
        if type(other) is Some and other.base is self.base and (other.offset - self.offset) & MASK in (1, MASK):
            return _less_a_bit(self if (self.offset - other.offset) & MASK == 1 else other)
        found = self._with(Op.AND, other)
        if type(found) is Some and type(other) is int and other & (other + 1) == 0:
            found.low = (self, other.bit_length(), 0)
        return found

    __rand__ = __and__

    def __eq__(self, other: object) -> bool:
        if other is self:
            return True
        if type(other) is int:
            if other not in self.range:
                return False
        elif type(other) is Some:
            if other.base is self.base:
                return other.offset == self.offset
            if domain.meet(self.range, other.range) is None:
                return False
        raise Undecided

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = object.__hash__

    def _bounds(self, other: object) -> tuple[int, int, int, int]:
        values = range_of(other)
        if values is None:
            raise Undecided
        return *self.range.unsigned_bounds(), *values.unsigned_bounds()

    def __lt__(self, other: object) -> bool:
        low, high, least, most = self._bounds(other)
        if high < least:
            return True
        if low >= most or other is self:
            return False
        raise Undecided

    def __gt__(self, other: object) -> bool:
        low, high, least, most = self._bounds(other)
        if low > most:
            return True
        if high <= least or other is self:
            return False
        raise Undecided

    def __ge__(self, other: object) -> bool:
        return not self < other

    def __le__(self, other: object) -> bool:
        return not self > other

    def __bool__(self) -> bool:
        return self != 0

    def __neg__(self) -> Word:  # type: ignore[override]
        return made(domain.negate(self.range))

    def __repr__(self) -> str:
        return repr(self.range)


def part_of(word: Word, whole: Word, a: int, b: int) -> Word:
    """The same word, which is at most a/b of a whole one."""
    if type(word) is Some and type(whole) is Some and a < b:
        word.part = whole, a, b
        if whole.part is not None:
            more, c, d = whole.part
            word.part = more, a * c, b * d
    return word


def _difference(word: Word, a: Ranged, b: object) -> Word:
    """The same word, which is the difference of two others."""
    if type(word) is Some and isinstance(b, Ranged):
        word.less = a, b
    return word


def _less_a_bit(word: Some) -> Word:
    """x & (x - 1): the lowest one is cleared, so that what is a multiple of 2**t becomes one of 2**(t + 1)."""
    values = domain.apply(Op.AND, word.range, domain.shift(word.range, -1))
    unit = word.range.low | word.range.step
    step = 2 * (unit & -unit) if unit else 2
    if step > SIGN:
        return 0
    return made(domain.meet(values, domain.progression(0, step, MASK // step)) or domain.constant(0))


def _keeps(mask: int, values: Range) -> bool:
    """Whether a conjunction with the mask changes none of the values: ones from the lowest bit up to their greatest."""
    return mask == MASK or (mask & (mask + 1) == 0 and values.unsigned_bounds()[1] <= mask)


class Stack(Unknown):
    """The value of sp at the entry of the program plus `offset`."""

    __slots__ = ("offset",)

    def __init__(self, offset: int) -> None:
        self.offset = offset

    def __add__(self, other: object) -> Word:  # type: ignore[override]
        if type(other) is int:
            return Stack(signed(self.offset + other))
        if type(other) is Some:
            return Stacks(domain.shift(other.range, self.offset), other.base, (other.offset + self.offset) & MASK)
        return WILD

    __radd__ = __add__  # type: ignore[assignment]

    def __sub__(self, other: object) -> Word:  # type: ignore[override]
        if type(other) is int:
            return Stack(signed(self.offset - other))
        if type(other) is Some:
            return Stacks(domain.shift(domain.negate(other.range), self.offset))
        if type(other) is Stacks:
            return made(domain.shift(domain.negate(other.range), self.offset))
        return self.offset - other.offset if type(other) is Stack else WILD

    def _lost(self, other: object) -> Unknown:
        return WILD

    __rsub__ = __mul__ = __rmul__ = __rlshift__ = __rshift__ = __rrshift__ = _lost

    def __or__(self, other: object) -> Unknown:
        if type(other) is int and other <= 7:
            return Stack(self.offset | other)
        return _low_bits(self, other, lambda a, b: a | b)

    def __xor__(self, other: object) -> Unknown:
        if type(other) is int and other <= 7:
            return Stack(self.offset ^ other)
        return _low_bits(self, other, lambda a, b: a ^ b)

    __ror__, __rxor__ = __or__, __xor__  # type: ignore[assignment]

    def __lshift__(self, other: object) -> Word:  # type: ignore[override]
        return (self.offset & 7) << other if type(other) is int and other >= 29 else WILD

    def __and__(self, other: object) -> Word:
        if type(other) is not int:
            return WILD
        if other == MASK:
            return self
        if other <= 7:
            return self.offset & other
        if other | 7 == MASK:
            return Stack(self.offset - (self.offset & ~other & 7))
        return Low(self.offset & other & 7) if other & 7 == 7 else WILD

    __rand__ = __and__

    def __eq__(self, other: object) -> bool:
        if type(other) is Stack:
            return self.offset == other.offset
        if type(other) is Stacks:
            return other == self
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
        if type(other) is Stacks:
            return other > self
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
        if type(other) is Stacks:
            return other < self
        raise Undecided

    def __le__(self, other: object) -> bool:
        return not self > other

    def __bool__(self) -> bool:
        return True

    def __repr__(self) -> str:
        return f"sp{self.offset:+d}"


class Stacks(Ranged):
    """An address in the stack: the value of sp at the entry of the program plus one number out of the range."""

    __slots__ = ()

    def __add__(self, other: object) -> Word:  # type: ignore[override]
        if type(other) is int:
            return self.moved(other)
        if type(other) is not Some:
            return WILD
        found = Stacks(domain.add(self.range, other.range))
        found.terms = self, other
        return found

    __radd__ = __add__  # type: ignore[assignment]

    def __sub__(self, other: object) -> Word:  # type: ignore[override]
        if type(other) is int:
            return self.moved(-other)
        if type(other) is Stacks and other.base is self.base:
            return (self.offset - other.offset) & MASK
        if type(other) is Some:
            return Stacks(domain.sub(self.range, other.range))
        if type(other) is Stack:
            return Some(domain.shift(self.range, -other.offset), self.base, (self.offset - other.offset) & MASK)
        if type(other) is not Stacks:
            return WILD
        return _difference(made(domain.sub(self.range, other.range)), self, other)

    def _lost(self, other: object) -> Unknown:
        return WILD

    __rsub__ = __mul__ = __rmul__ = __lshift__ = __rlshift__ = __rshift__ = __rrshift__ = _lost
    __or__ = __ror__ = __xor__ = __rxor__ = _lost

    def __and__(self, other: object) -> Word:
        return self if type(other) is int and other == MASK else WILD

    __rand__ = __and__

    def _against(self, other: object) -> tuple[int, int, int, int]:
        if type(other) is Stack:
            return *self.range.signed_bounds(), other.offset, other.offset
        if type(other) is Stacks:
            return *self.range.signed_bounds(), *other.range.signed_bounds()
        raise Undecided

    def __eq__(self, other: object) -> bool:
        if type(other) is int and other == 0:
            return False
        if type(other) is Stacks and other.base is self.base:
            return other.offset == self.offset
        low, high, least, most = self._against(other)
        if high < least or low > most or (type(other) is Stack and other.offset & MASK not in self.range):
            return False
        raise Undecided

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = object.__hash__

    def __lt__(self, other: object) -> bool:
        if type(other) is int and other == 0:
            return False
        low, high, least, most = self._against(other)
        if high < least or low >= most:
            return high < least
        raise Undecided

    def __gt__(self, other: object) -> bool:
        if type(other) is int and other == 0:
            return True
        low, high, least, most = self._against(other)
        if low > most or high <= least:
            return low > most
        raise Undecided

    def __ge__(self, other: object) -> bool:
        return not self < other

    def __le__(self, other: object) -> bool:
        return not self > other

    def __bool__(self) -> bool:
        return True

    def __repr__(self) -> str:
        return f"sp+{self.range!r}"


class Low(Unknown):
    """A word of which the low three bits are known; it was made from an address in the stack."""

    __slots__ = ("bits",)

    def __init__(self, bits: int) -> None:
        self.bits = bits & 7

    def __and__(self, other: object) -> Word:
        if type(other) is int and other <= 7:
            return self.bits & other
        return self if type(other) is int and other == MASK else WILD

    __rand__ = __and__

    def __or__(self, other: object) -> Unknown:
        return _low_bits(self, other, lambda a, b: a | b)

    def __xor__(self, other: object) -> Unknown:
        return _low_bits(self, other, lambda a, b: a ^ b)

    __ror__, __rxor__ = __or__, __xor__  # type: ignore[assignment]

    def __lshift__(self, other: object) -> Word:  # type: ignore[override]
        return self.bits << other if type(other) is int and other >= 29 else WILD

    def _lost(self, other: object) -> Unknown:
        return WILD

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __rlshift__ = _lost
    __rshift__ = __rrshift__ = _lost


Word = int | Unknown


def is_wild(value: object) -> bool:
    """Whether a word may be, or be made from, an address in the stack."""
    return isinstance(value, Wild | Stack | Stacks | Low)


def range_of(value: object) -> Range | None:
    """The values of a word; None for one that may be an address in the stack."""
    if type(value) is int:
        return domain.constant(value)
    if type(value) is Some:
        return value.range
    return None if is_wild(value) else TOP


def made(values: Range) -> Word:
    """A word out of a range."""
    return values.low if values.n == 0 and values.values is None else Some(values)


def fresh(values: Range = TOP) -> Some:
    """A word of which nothing else is known."""
    return Some(values)


def _bits(value: object) -> int | None:
    if type(value) is int:
        return value & 7
    if type(value) is Stack:
        return value.offset & 7
    return value.bits if type(value) is Low else None


def _low_bits(a: object, b: object, combine: Callable[[int, int], int]) -> Unknown:
    first, second = _bits(a), _bits(b)
    return WILD if first is None or second is None else Low(combine(first, second))


def signed(value: int) -> int:
    """A word read as two's complement."""
    return ((value + SIGN) & MASK) - SIGN


def offsets_of(value: Word) -> Range | None:
    """The offsets of an address in the stack; None for other words."""
    if type(value) is Stack:
        return domain.constant(value.offset)
    return value.range if type(value) is Stacks else None
