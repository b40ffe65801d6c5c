"""Micro-operations on the FPU's registers: single precision, as on cores with VFPv2 to FPv4-SP.

They only add to what an instruction's other micro-operations say: a core register that takes a word from the FPU is
written as unknown first and refined by `FromFloat` after that, and the flags by `FloatFlags`. So an analysis that knows
nothing of FPU registers leaves these out and stays sound. Registers of the FPU are numbered apart from the core's: s0
to s31 are 0 to 31, 32 and 33 are temporaries inside one instruction; d0 is s0 (its low word) and s1. Every register
holds a 32-bit word. Sources: ARM DDI 0406C chapters A2.7, A7 and A8.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

FLOATS = 32
"""Registers of the FPU."""
F0, F1 = 32, 33
"""Temporaries."""


class FloatOp(Enum):
    """Operations on words that hold binary32 numbers; rounding as FPSCR says, each operation rounds once."""

    MOV = "mov"
    NEG = "neg"
    """the sign bit flipped"""
    ABS = "abs"
    """the sign bit cleared"""
    ADD = "add"
    SUB = "sub"
    MUL = "mul"
    DIV = "div"
    SQRT = "sqrt"
    FMA = "fma"
    """a * b + c, rounded once"""
    UNKNOWN = "unknown"
    """any word"""


@dataclass(frozen=True, slots=True)
class FloatCompute:
    """FPU register dst := op(a, b, c)."""

    op: FloatOp
    dst: int
    a: int = 0
    b: int = 0
    c: int = 0


@dataclass(frozen=True, slots=True)
class FloatConstant:
    """FPU register dst := a word."""

    dst: int
    word: int


@dataclass(frozen=True, slots=True)
class ToFloat:
    """FPU register dst := a core register or temporary."""

    dst: int
    source: int


@dataclass(frozen=True, slots=True)
class FromFloat:
    """Core register or temporary dst := an FPU register."""

    dst: int
    source: int


@dataclass(frozen=True, slots=True)
class FromInteger:
    """dst := the low `size` bits of a (16 or 32), as an integer with or without sign, over 2**fraction."""

    dst: int
    a: int
    signed: bool
    size: int = 32
    fraction: int = 0


@dataclass(frozen=True, slots=True)
class ToInteger:
    """dst := a * 2**fraction as an integer of `size` bits (extended to 32), saturated; 0 for a NaN. Rounded toward
    zero, or (`rounds`) as FPSCR says."""

    dst: int
    a: int
    signed: bool
    size: int = 32
    fraction: int = 0
    rounds: bool = False


@dataclass(frozen=True, slots=True)
class FloatCompare:
    """The flags N, Z, C and V of FPSCR := those of comparing a with b (None: with 0)."""

    a: int
    b: int | None


@dataclass(frozen=True, slots=True)
class FloatFlags:
    """N, Z, C and V of the core := those of FPSCR."""


@dataclass(frozen=True, slots=True)
class FloatMode:
    """FPSCR := a core register; None: it may be anything afterwards."""

    source: int | None


FloatMicroOp = (
    FloatCompute | FloatConstant | ToFloat | FromFloat | FromInteger | ToInteger | FloatCompare | FloatFlags | FloatMode
)
