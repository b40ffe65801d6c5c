"""The FPU's data processing and register moves as micro-operations.

Only single precision has values: double precision (which the cores of this tool leave to software), half precision and
whatever else the encodings hold make their results unknown. Source: ARM DDI 0406C, tables A7-16 and A7-17, and A8.
"""

from __future__ import annotations

from mauve.wcet.binary.floats import (
    F0,
    F1,
    FLOATS,
    FloatCompare,
    FloatCompute,
    FloatConstant,
    FloatMicroOp,
    FloatMode,
    FloatOp,
    FromFloat,
    FromInteger,
    ToFloat,
    ToInteger,
)

FPSCR = 1
"""The number of FPSCR among the registers of vmrs and vmsr."""


def single(word: int, field: int, bit: int) -> int:
    """The number of an s register: four bits at `field` and the lowest at `bit`."""
    return (word >> field & 15) << 1 | word >> bit & 1


def halves(word: int, field: int, bit: int) -> tuple[int, ...]:
    """The s registers that make up a d register: four bits at `field` and the highest at `bit`; none above d15."""
    number = word >> field & 15 | (word >> bit & 1) << 4
    return (2 * number, 2 * number + 1) if 2 * number < FLOATS else ()


def unknown(*numbers: int) -> tuple[FloatMicroOp, ...]:
    """FPU registers that may hold any word."""
    return tuple(FloatCompute(FloatOp.UNKNOWN, number) for number in dict.fromkeys(numbers))


# ---------------------------------------------------------------------------------------------------- moves
def from_core(word: int, rt: int) -> tuple[FloatMicroOp, ...]:
    """mcr to the FPU: vmov to an s register or to half a d register, vmsr; a scalar that is smaller, or copied to a
    whole register, leaves the register unknown."""
    opcode, double = word >> 21 & 7, word >> 8 & 1
    if not double:
        if opcode == 0:
            return (ToFloat(single(word, 16, 7), rt),)
        return (FloatMode(rt if opcode == 7 and word >> 16 & 15 == FPSCR else None),)
    pair = halves(word, 16, 7)
    if opcode & 6 == 0 and word >> 5 & 3 == 0:
        return (ToFloat(pair[opcode & 1], rt),) if pair else ()
    wide = halves(word & ~(1 << 16), 16, 7)  # vdup may write two d registers
    return unknown(*wide, *(number + 2 for number in wide))


def to_core(word: int, rt: int) -> tuple[FloatMicroOp, ...]:
    """mrc from the FPU: vmov of an s register or of half a d register. Nothing is known of the rest (fpscr)."""
    opcode, double = word >> 21 & 7, word >> 8 & 1
    if not double:
        return (FromFloat(rt, single(word, 16, 7)),) if opcode == 0 else ()
    pair = halves(word, 16, 7)
    return (FromFloat(rt, pair[opcode & 1]),) if pair and opcode & 6 == 0 and word >> 5 & 3 == 0 else ()


def pair_of(word: int) -> tuple[int, ...]:
    """The two s registers of a 64-bit transfer; none above s31."""
    if word >> 8 & 1:
        return halves(word, 0, 5)
    number = single(word, 0, 5)
    return (number, number + 1) if number + 1 < FLOATS else ()


# ---------------------------------------------------------------------------------------------------- arithmetic
def data_processing(word: int) -> tuple[FloatMicroOp, ...]:
    """cdp of the FPU."""
    d = single(word, 12, 22)
    if word >> 8 & 1:
        return _double(word, d)
    n, m, second = single(word, 16, 7), single(word, 0, 5), word >> 6 & 1
    match word >> 20 & 0b1011:
        case 0b0000:
            product = _product(n, m, bool(second))
            return (*product, FloatCompute(FloatOp.ADD, d, d, F0))
        case 0b0001:
            product = _product(n, m, bool(second))
            return (*product, FloatCompute(FloatOp.NEG, F1, d), FloatCompute(FloatOp.ADD, d, F1, F0))
        case 0b0010 if second:
            return (*_product(n, m, True), FloatCompute(FloatOp.MOV, d, F0))
        case 0b0010:
            return (FloatCompute(FloatOp.MUL, d, n, m),)
        case 0b0011:
            return (FloatCompute(FloatOp.SUB if second else FloatOp.ADD, d, n, m),)
        case 0b1000 if not second:
            return (FloatCompute(FloatOp.DIV, d, n, m),)
        case 0b1001:
            return (FloatCompute(FloatOp.NEG, F1, d), *_fused(d, n, m, F1, bool(second)))
        case 0b1010:
            return _fused(d, n, m, d, bool(second))
        case 0b1011:
            return _other(word, d, m)
    return unknown(d)


def _product(n: int, m: int, negated: bool) -> tuple[FloatMicroOp, ...]:
    """F0 := n * m, or -(n * m)."""
    product = FloatCompute(FloatOp.MUL, F0, n, m)
    return (product, FloatCompute(FloatOp.NEG, F0, F0)) if negated else (product,)


def _fused(d: int, n: int, m: int, addend: int, negated: bool) -> tuple[FloatMicroOp, ...]:
    """d := n * m + addend, or -n * m + addend."""
    if not negated:
        return (FloatCompute(FloatOp.FMA, d, n, m, addend),)
    return FloatCompute(FloatOp.NEG, F0, n), FloatCompute(FloatOp.FMA, d, F0, m, addend)


_UNARY = {(0, 0): FloatOp.MOV, (0, 1): FloatOp.ABS, (1, 0): FloatOp.NEG, (1, 1): FloatOp.SQRT}


def _other(word: int, d: int, m: int) -> tuple[FloatMicroOp, ...]:
    """The instructions with one operand, vmov of a constant, comparisons and conversions."""
    kind, top = word >> 16 & 15, word >> 7 & 1
    if word >> 6 & 1 == 0:
        return (FloatConstant(d, constant(kind << 4 | word & 15)),)
    match kind:
        case 0 | 1:
            return (FloatCompute(_UNARY[kind, top], d, m),)
        case 4:
            return (FloatCompare(d, m),)
        case 5:
            return (FloatCompare(d, None),)
        case 8:
            return (FromInteger(d, m, bool(top)),)
        case 12 | 13:
            return (ToInteger(d, m, bool(kind & 1), rounds=not top),)
        case 10 | 11 | 14 | 15:
            size = 32 if top else 16
            fraction = size - ((word & 15) << 1 | word >> 5 & 1)
            if fraction < 0:
                return unknown(d)
            if kind & 4:
                return (ToInteger(d, d, not kind & 1, size, fraction),)
            return (FromInteger(d, d, not kind & 1, size, fraction),)
    return unknown(d)


def constant(eight: int) -> int:
    """VFPExpandImm for binary32."""
    exponent = 0b0_1111100 if eight & 0x40 else 0b1_0000000
    return (eight & 0x80) << 24 | exponent << 23 | (eight & 0x3F) << 19


def _double(word: int, d: int) -> tuple[FloatMicroOp, ...]:
    """Double precision: results are unknown, be they a d register or (vcvt) an s register."""
    if word >> 20 & 0b1011 == 0b1011 and word >> 6 & 1 and word >> 16 & 14 == 4:
        return (FloatMode(None),)
    return unknown(*halves(word, 12, 22), d)
