"""Where a variable lives (register or memory cell), what is known of its value, and what a call may change.

These are the words in which the value analysis and the ranking arguments talk to each other.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Protocol

WORD = 1 << 32
HALF = 1 << 31


class Base(Enum):
    """What the offset of a memory cell is relative to."""

    SP = "sp"
    """the value of sp when the function was entered"""
    ABSOLUTE = "absolute"
    """zero: the offset is an address"""


@dataclass(frozen=True, slots=True)
class Cell:
    """`size` bytes (1, 2 or 4) of memory at `base + offset`, read as an unsigned little-endian number."""

    base: Base
    offset: int
    size: int = 4

    def __str__(self) -> str:
        return f"[{'sp' if self.base is Base.SP else ''}{self.offset:+#x}:{self.size}]"


Location = int | Cell
"""A register number (0..14) or a memory cell."""


Sum = tuple[tuple[Location, int], ...]
"""Locations with the factors of their values."""

ENTRY_SP = -1
"""Stands in a sum for the value of sp when the function was entered."""


@dataclass(frozen=True, slots=True)
class Interval:
    """The 32-bit values {v mod 2**32 : low <= v <= high, v = low + n * stride}.

    Invariants: -2**31 <= low <= high, high - low < 2**32, stride >= 1. So [-5, 10] is the set that is an interval when
    read as signed, [0, 2**32-1] is no knowledge at all, and an interval may wrap around in either reading.
    """

    low: int
    high: int
    stride: int = 1

    @property
    def unsigned(self) -> tuple[int, int]:
        """The least and greatest value, read as unsigned."""
        low, high = self.low % WORD, self.high % WORD
        return (low, high) if low <= high and self.high - self.low < WORD else (0, WORD - 1)

    @property
    def signed(self) -> tuple[int, int]:
        """The least and greatest value, read as two's complement."""
        low, high = (self.low + HALF) % WORD - HALF, (self.high + HALF) % WORD - HALF
        return (low, high) if low <= high and self.high - self.low < WORD else (-HALF, HALF - 1)

    def __str__(self) -> str:
        return f"[{self.low}, {self.high}]" + (f" step {self.stride}" if self.stride > 1 else "")


ANY = Interval(0, WORD - 1)


@dataclass(frozen=True, slots=True)
class Region:
    """The bytes that an access may touch: offsets `low` to `high` inclusive from `base`."""

    base: Base
    low: int
    high: int


class EntryValues(Protocol):
    """What a value analysis knows about one loop of one function in one context. Every answer may be ANY or None."""

    def on_entry(self, location: Location) -> Interval:
        """The value of `location` when control comes to the header from outside the loop."""

    def invariant(self, location: Location) -> Interval:
        """The value of `location` at the start of the header, in any iteration."""

    def sp_offset(self, block: int) -> int | None:
        """sp at the start of `block` minus sp at the function's entry."""

    def access(self, address: int, index: int) -> Region | None:
        """The bytes touched by micro-operation `index` of the instruction at `address`."""

    def constant(self, cell: Cell) -> int | None:
        """The number in an absolute cell of memory that is never written: literal pools and constant tables."""

    def tracked(self, cell: Cell) -> bool:
        """Whether a load from this absolute cell gives what this program last stored there: memory that no device, no
        interrupt and no other task writes while the function runs."""


    def string(self, parts: Sum, offset: int, stores: tuple[tuple[int, int], ...]) -> int | None:
        """How many bytes there are at most from `offset` + the sum of `parts` on entry to one that is 0 as long as the
        loop runs, that one included. `stores` are those of the loop, as address and index of the micro-operation."""


@dataclass(frozen=True, slots=True)
class NoValues:
    """The EntryValues of somebody who knows nothing."""

    def on_entry(self, location: Location) -> Interval:
        """Anything."""
        return whole(location)

    def invariant(self, location: Location) -> Interval:
        """Anything."""
        return whole(location)

    def sp_offset(self, block: int) -> int | None:
        """Unknown."""
        return None

    def access(self, address: int, index: int) -> Region | None:
        """Unknown."""
        return None

    def constant(self, cell: Cell) -> int | None:
        """Unknown."""
        return None

    def tracked(self, cell: Cell) -> bool:
        """Absolute memory is not trusted."""
        return False

    def string(self, parts: Sum, offset: int, stores: tuple[tuple[int, int], ...]) -> int | None:
        """Unknown."""
        return None


def whole(location: Location) -> Interval:
    """All values that fit into the location."""
    return Interval(0, (1 << 8 * location.size) - 1) if isinstance(location, Cell) else ANY


CALL_CLOBBERED = frozenset({0, 1, 2, 3, 12, 14})
"""The core registers that a callee need not preserve (AAPCS 6.1.1), and lr."""


class Helper(Enum):
    """What a callee computes from r0 and r1, for the run-time helpers that stand for a division.

    A division by zero gives anything.
    """

    UDIV = "udiv"
    """r0 := r0 / r1"""
    UMOD = "umod"
    """r0 := r0 mod r1"""
    UDIVMOD = "udivmod"
    """r0 := r0 / r1, r1 := r0 mod r1"""
    SDIV = "sdiv"
    """the same with sign, rounded towards 0"""
    SMOD = "smod"
    SDIVMOD = "sdivmod"

    @property
    def is_signed(self) -> bool:
        """Whether the numbers have signs."""
        return self in (Helper.SDIV, Helper.SMOD, Helper.SDIVMOD)

    @property
    def quotient(self) -> int | None:
        """The register of the quotient."""
        return None if self in (Helper.UMOD, Helper.SMOD) else 0

    @property
    def remainder(self) -> int | None:
        """The register of the remainder."""
        return 1 if self in (Helper.UDIVMOD, Helper.SDIVMOD) else 0 if self in (Helper.UMOD, Helper.SMOD) else None


@dataclass(frozen=True, slots=True)
class CallEffects:
    """What a call may change: core registers, memory outside the caller's frame, the caller's frame.

    Flags are always lost. Frames of callees lie below sp and are of no interest to the caller. `frame` None: it is
    lost when the function lets the address of a part of it out of its hands.
    """

    registers: frozenset[int] = CALL_CLOBBERED
    memory: bool = True
    frame: bool | None = None
    helper: Helper | None = None


AAPCS = CallEffects()
