"""Micro-operations of the DSP extension: additions of bytes and half-words next to each other, the bits GE that they
leave and `sel` reads, and saturation to a number of bits.

Like those of the FPU (`floats`) they only refine what an instruction's other micro-operations say: the result goes to a
temporary, the register is written as unknown, and `Refine` puts the temporary there. An analysis that does not know
them leaves them out. Source: ARM DDI 0406C, A5.4 and A8 (SADD16 and the like, SEL, SSAT, USAT).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum


class Prefix(Enum):
    """What becomes of a sum that does not fit: the letters before the name of a parallel addition."""

    S = "s"
    """wraps; GE: it is not negative"""
    Q = "q"
    """saturates, signed"""
    SH = "sh"
    """is halved, signed"""
    U = "u"
    """wraps; GE: a carry out of an addition, none out of a subtraction"""
    UQ = "uq"
    """saturates, unsigned"""
    UH = "uh"
    """is halved, unsigned"""

    @property
    def signed(self) -> bool:
        """Whether the parts are two's complement."""
        return self in (Prefix.S, Prefix.Q, Prefix.SH)

    @property
    def compares(self) -> bool:
        """Whether GE is written."""
        return self in (Prefix.S, Prefix.U)


class Shape(Enum):
    """The parts that are added or subtracted: asx subtracts the upper half-word of b from the lower one of a and adds
    the others, sax the other way round."""

    ADD16 = "add16"
    ASX = "asx"
    SAX = "sax"
    SUB16 = "sub16"
    ADD8 = "add8"
    SUB8 = "sub8"


@dataclass(frozen=True, slots=True)
class Parallel:
    """dst := the parts of a and b added as `prefix` and `shape` say; GE where `prefix` compares."""

    dst: int
    prefix: Prefix
    shape: Shape
    a: int
    b: int


@dataclass(frozen=True, slots=True)
class Select:
    """dst := the bytes of a whose bit of GE is set, the other bytes of b."""

    dst: int
    a: int
    b: int


@dataclass(frozen=True, slots=True)
class Saturate:
    """dst := a, a signed number, as near as `bits` bits come to it (with or without sign)."""

    dst: int
    a: int
    bits: int
    signed: bool


@dataclass(frozen=True, slots=True)
class Refine:
    """dst, unknown so far, is what the temporary holds."""

    dst: int
    source: int


MediaMicroOp = Parallel | Select | Saturate | Refine
