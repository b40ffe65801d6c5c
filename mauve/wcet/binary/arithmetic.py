"""The meaning of multiplications, bit-field, extension and other unary operations as micro-operations; see
`semantics`."""

from __future__ import annotations

from mauve.wcet.binary.media import Parallel, Prefix, Refine, Saturate, Select, Shape
from mauve.wcet.binary.microop import (
    Compute,
    FlagKind,
    Imm,
    Kind,
    MicroOp,
    Op,
    Operand,
    SetCarry,
    SetFlags,
    Shift,
    Traits,
)
from mauve.wcet.binary.semantics import MASK, T0, T1, T2, T3, T4, T5, Action, opaque_result, registers, require


def _below_pc(*numbers: int) -> None:
    require(all(number < 15 for number in numbers), "uses the program counter in a multiplication or bit operation")


# ---------------------------------------------------------------------------------------------------- multiplications
# ARMv4 leaves C (and V, for long forms) with a meaningless value; later cores keep them. Unknown covers both.
_CARRY_UNKNOWN: tuple[MicroOp, ...] = (Compute(Op.UNKNOWN, T5), SetCarry(Shift.LSR, T5, Imm(1)))


def multiply(
    rd: int, rm: int, rs: int, accumulate: int | None, subtract: bool, sets_flags: bool, early: int | None
) -> Action:
    """mul, mla, mls; `early` is the register whose value decides early termination of the multiplier."""
    _below_pc(rd, rm, rs, *(() if accumulate is None else (accumulate,)))
    ops: list[MicroOp] = []
    if accumulate is None:
        ops.append(Compute(Op.MUL, rd, rm, rs))
    else:
        ops += [Compute(Op.MUL, T0, rm, rs), Compute(Op.SUB if subtract else Op.ADD, rd, accumulate, T0)]
    if sets_flags:
        ops += [SetFlags(FlagKind.LOGIC, rd), *_CARRY_UNKNOWN]
    traits = Traits(
        Kind.MUL if accumulate is None else Kind.MLA,
        reads=registers(rm, rs),
        late_reads=() if accumulate is None else (accumulate,),
        writes=(rd,),
        sets_flags=sets_flags,
        multiplier=early,
    )
    return Action(tuple(ops), traits)


def _carry_of_sum(a: Operand, b: Operand, total: int, dst: int) -> tuple[MicroOp, ...]:
    """dst := carry out of a + b, whose sum is in `total`: the majority of the top bits (a & b | (a | b) & ~total)."""
    return (
        Compute(Op.AND, T4, a, b),
        Compute(Op.OR, T5, a, b),
        Compute(Op.NOT, dst, total),
        Compute(Op.AND, dst, dst, T5),
        Compute(Op.OR, dst, dst, T4),
        Compute(Op.LSR, dst, dst, Imm(31)),
    )


def _add_wide(low: int, high: int) -> tuple[MicroOp, ...]:
    """(high:low) += (T1:T0)."""
    return (
        Compute(Op.ADD, T2, low, T0),
        *_carry_of_sum(low, T0, T2, T3),
        Compute(Op.MOV, low, T2),
        Compute(Op.ADD, high, high, T1),
        Compute(Op.ADD, high, high, T3),
    )


def long_multiply(
    low: int, high: int, rm: int, rs: int, signed: bool, accumulate: bool, sets_flags: bool, early: int
) -> Action:
    """umull, smull, umlal, smlal: the exact 64-bit product or sum."""
    _below_pc(low, high, rm, rs)
    require(low != high, "writes both halves of a product to one register")
    product = (Compute(Op.MUL, T0, rm, rs), Compute(Op.SMULH if signed else Op.UMULH, T1, rm, rs))
    ops: tuple[MicroOp, ...]
    if accumulate:
        ops = (*product, *_add_wide(low, high))
    else:
        ops = (*product, Compute(Op.MOV, low, T0), Compute(Op.MOV, high, T1))
    if sets_flags:
        ops = (*ops, SetFlags(FlagKind.UNKNOWN), SetFlags(FlagKind.WIDE, low, high))
    traits = Traits(
        Kind.LONG_MLA if accumulate else Kind.LONG_MUL,
        reads=registers(rm, rs),
        late_reads=(low, high) if accumulate else (),
        writes=(low, high),
        signed=signed,
        sets_flags=sets_flags,
        multiplier=early,
    )
    return Action(ops, traits)


def multiply_accumulate_accumulate(low: int, high: int, rm: int, rs: int) -> Action:
    """umaal: (high:low) := rm * rs + high + low."""
    _below_pc(low, high, rm, rs)
    require(low != high, "writes both halves of a product to one register")
    ops = (
        Compute(Op.MUL, T0, rm, rs),
        Compute(Op.UMULH, T1, rm, rs),
        Compute(Op.ADD, T2, T0, low),
        *_carry_of_sum(T0, low, T2, T3),
        Compute(Op.ADD, T1, T1, T3),
        Compute(Op.ADD, T0, T2, high),
        *_carry_of_sum(T2, high, T0, T3),
        Compute(Op.MOV, low, T0),
        Compute(Op.ADD, high, T1, T3),
    )
    traits = Traits(Kind.LONG_MLA, registers(rm, rs), (low, high), (low, high), multiplier=rs)
    return Action(ops, traits)


def _half(dst: int, source: int, top: int) -> Compute:
    return Compute(Op.ASR, dst, source, Imm(16)) if top else Compute(Op.SXTH, dst, source)


def half_multiply(rd: int, rm: int, rs: int, top_m: int, top_s: int, accumulate: int | None) -> Action:
    """smulxy and smlaxy: signed 16 x 16 -> 32 bits (the Q flag is not modelled: nothing branches on it)."""
    _below_pc(rd, rm, rs, *(() if accumulate is None else (accumulate,)))
    ops: tuple[MicroOp, ...] = (_half(T0, rm, top_m), _half(T1, rs, top_s))
    if accumulate is None:
        ops = (*ops, Compute(Op.MUL, rd, T0, T1))
    else:
        ops = (*ops, Compute(Op.MUL, T0, T0, T1), Compute(Op.ADD, rd, T0, accumulate))
    late = () if accumulate is None else (accumulate,)
    return Action(ops, Traits(Kind.HALF_MUL, registers(rm, rs), late, (rd,), multiplier=rs))


def word_half_multiply(rd: int, rm: int, rs: int, top_s: int, accumulate: int | None) -> Action:
    """smulwy and smlawy: bits 47..16 of the signed 32 x 16 product."""
    _below_pc(rd, rm, rs, *(() if accumulate is None else (accumulate,)))
    ops: tuple[MicroOp, ...] = (
        _half(T1, rs, top_s),
        Compute(Op.MUL, T0, rm, T1),
        Compute(Op.SMULH, T1, rm, T1),
        Compute(Op.LSR, T0, T0, Imm(16)),
        Compute(Op.SHL, T1, T1, Imm(16)),
        Compute(Op.OR, rd if accumulate is None else T0, T0, T1),
    )
    if accumulate is not None:
        ops = (*ops, Compute(Op.ADD, rd, T0, accumulate))
    late = () if accumulate is None else (accumulate,)
    return Action(ops, Traits(Kind.HALF_MUL, registers(rm, rs), late, (rd,), multiplier=rs))


def half_long_accumulate(low: int, high: int, rm: int, rs: int, top_m: int, top_s: int) -> Action:
    """smlalxy: a 64-bit sum plus a signed 16 x 16 product."""
    _below_pc(low, high, rm, rs)
    require(low != high, "writes both halves of a product to one register")
    ops = (
        _half(T0, rm, top_m),
        _half(T1, rs, top_s),
        Compute(Op.MUL, T0, T0, T1),
        Compute(Op.ASR, T1, T0, Imm(31)),
        *_add_wide(low, high),
    )
    return Action(ops, Traits(Kind.HALF_LONG_MLA, registers(rm, rs), (low, high), (low, high), multiplier=rs))


def most_significant_multiply(
    rd: int, rm: int, rs: int, accumulate: int | None, subtract: bool, rounds: bool
) -> Action:
    """smmul, smmla, smmls: the upper word; only smmul without rounding is exact here."""
    _below_pc(rd, rm, rs, *(() if accumulate is None else (accumulate,)))
    exact = accumulate is None and not rounds and not subtract
    ops = (Compute(Op.SMULH, rd, rm, rs),) if exact else (Compute(Op.UNKNOWN, rd),)
    late = () if accumulate is None else (accumulate,)
    kind = Kind.MUL if accumulate is None else Kind.MLA
    return Action(ops, Traits(kind, registers(rm, rs), late, (rd,), multiplier=rs))


# ---------------------------------------------------------------------------------------------------- other results
def divide(rd: int, rn: int, rm: int, signed: bool) -> Action:
    """sdiv and udiv; division by zero gives 0 (the trap of SCB.CCR.DIV_0_TRP is taken to be off)."""
    _below_pc(rd, rn, rm)
    return Action(
        (Compute(Op.SDIV if signed else Op.UDIV, rd, rn, rm),), Traits(Kind.DIV, registers(rn, rm), (), (rd,))
    )


def unary(op: Op, rd: int, rm: int, kind: Kind = Kind.EXTEND) -> Action:
    """clz, rbit, rev, rev16, revsh."""
    _below_pc(rd, rm)
    return Action((Compute(op, rd, rm),), Traits(kind, (rm,), (), (rd,)))


def extend(op: Op, rd: int, rm: int, rotation: int, accumulate: int | None) -> Action:
    """sxtb, sxth, uxtb, uxth of a rotated register, and the forms that add."""
    _below_pc(rd, rm, *(() if accumulate is None else (accumulate,)))
    ops: list[MicroOp] = []
    source = rm
    if rotation:
        ops.append(Compute(Op.ROR, T0, rm, Imm(rotation)))
        source = T0
    if accumulate is None:
        ops.append(Compute(op, rd, source))
    else:
        ops += [Compute(op, T0, source), Compute(Op.ADD, rd, accumulate, T0)]
    reads = registers(rm) if accumulate is None else registers(accumulate, rm)
    return Action(tuple(ops), Traits(Kind.EXTEND, reads, (), (rd,), shifts=rotation != 0))


def bit_field_extract(rd: int, rn: int, lsb: int, width: int, signed: bool) -> Action:
    """ubfx and sbfx."""
    _below_pc(rd, rn)
    require(lsb + width <= 32, "extracts bits beyond the register")
    ops: list[MicroOp] = []
    if signed:
        ops = [Compute(Op.SHL, T0, rn, Imm(32 - lsb - width)), Compute(Op.ASR, rd, T0, Imm(32 - width))]
    elif lsb + width == 32:
        ops = [Compute(Op.LSR, rd, rn, Imm(lsb))]
    elif lsb:
        ops = [Compute(Op.LSR, T0, rn, Imm(lsb)), Compute(Op.AND, rd, T0, Imm((1 << width) - 1))]
    else:
        ops = [Compute(Op.AND, rd, rn, Imm((1 << width) - 1))]
    return Action(tuple(ops), Traits(Kind.EXTEND, (rn,), (), (rd,)))


def bit_field_insert(rd: int, rn: int | None, lsb: int, msb: int) -> Action:
    """bfi, and bfc when rn is None."""
    _below_pc(rd, *(() if rn is None else (rn,)))
    require(msb >= lsb, "inserts a bit field of no width")
    mask = ((1 << (msb - lsb + 1)) - 1) << lsb
    clear = Compute(Op.AND, rd, rd, Imm(~mask & MASK))
    if rn is None:
        return Action((clear,), Traits(Kind.EXTEND, (rd,), (), (rd,)))
    ops = (
        Compute(Op.SHL, T0, rn, Imm(lsb)),
        Compute(Op.AND, T0, T0, Imm(mask)),
        clear,
        Compute(Op.OR, rd, rd, T0),
    )
    return Action(ops, Traits(Kind.EXTEND, registers(rd, rn), (), (rd,)))


def pack_halves(rd: int, rn: int, rm: int, top_bottom: bool, amount: int) -> Action:
    """pkhbt (rm shifted left supplies the top) and pkhtb (rm shifted right supplies the bottom)."""
    _below_pc(rd, rn, rm)
    shift = Compute(Op.ASR if top_bottom else Op.SHL, T0, rm, Imm((amount or 32) if top_bottom else amount))
    low, high = (T0, rn) if top_bottom else (rn, T0)
    ops = (
        shift,
        Compute(Op.AND, T1, low, Imm(0xFFFF)),
        Compute(Op.AND, T2, high, Imm(0xFFFF0000)),
        Compute(Op.OR, rd, T1, T2),
    )
    return Action(ops, Traits(Kind.SIMD, registers(rn, rm), (), (rd,), shifts=amount != 0 or top_bottom))


def parallel(rd: int, rn: int, rm: int, prefix: Prefix, shape: Shape) -> Action:
    """sadd16, uadd8 and the like."""
    return _refined(rd, (rn, rm), Kind.SIMD, (Parallel(T0, prefix, shape, rn, rm),))


def select(rd: int, rn: int, rm: int) -> Action:
    """sel."""
    return _refined(rd, (rn, rm), Kind.SIMD, (Select(T0, rn, rm),))


def saturate(rd: int, rn: int, bits: int, signed: bool, shift: int, by_right: bool) -> Action:
    """ssat and usat of a register that is shifted first; the flag Q is not modelled."""
    shifted = Compute(Op.ASR if by_right else Op.SHL, T0, rn, Imm(shift or (32 if by_right else 0)))
    return _refined(rd, (rn,), Kind.SATURATING, (shifted, Saturate(T0, T0, bits, signed)))


def _refined(rd: int, reads: tuple[int, ...], kind: Kind, ops: tuple[MicroOp, ...]) -> Action:
    """A result in T0 that not every analysis knows of."""
    action = opaque_result(kind, (rd,), reads)
    return action._replace(ops=(*ops, *action.ops, Refine(rd, T0)))


def move_top(rd: int, value: int) -> Action:
    """movt: the upper half becomes `value`."""
    _below_pc(rd)
    ops = (Compute(Op.AND, T0, rd, Imm(0xFFFF)), Compute(Op.OR, rd, T0, Imm(value << 16)))
    return Action(ops, Traits(Kind.ALU, (rd,), (), (rd,), logical=True))
