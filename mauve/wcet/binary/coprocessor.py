"""Coprocessor and floating-point instructions: what they do to core registers, flags and memory.

A32 and T32 encode them in the same 28 bits. What the FPU does to its own registers (`vfp`) comes on top of operations
that make every core register unknown that takes a word from a coprocessor. Sources: ARM DDI 0406C chapters A6.3, A7
and A8.
"""

from __future__ import annotations

from mauve.wcet.binary import vfp
from mauve.wcet.binary.floats import FLOATS, FloatFlags, FromFloat, ToFloat
from mauve.wcet.binary.microop import (
    PC,
    Compute,
    FlagKind,
    Imm,
    Kind,
    Load,
    MicroOp,
    Op,
    Operand,
    SetFlags,
    Store,
    StoreUnknown,
    Traits,
)
from mauve.wcet.binary.semantics import MASK, T0, T1, Action, Undecodable, opaque_result, registers, require

_FPU = (10, 11)


def decode_coprocessor(word: int, aligned_pc: int) -> Action:
    """The instructions with bits 27..24 = 110x or 1110; `aligned_pc` is what a pc-relative access adds to."""
    coprocessor = word >> 8 & 15
    if word >> 25 & 7 == 0b110:
        if word >> 21 & 0xF == 0b0010 and word >> 24 & 1 == 0:
            return _two_registers(word)
        require(coprocessor in _FPU, "transfers memory to or from a coprocessor that is not the FPU")
        return _fpu_memory(word, aligned_pc)
    require(word >> 24 & 1 == 0, "is no coprocessor instruction")
    if word >> 4 & 1 == 0:
        if coprocessor not in _FPU:
            return Action((), Traits(Kind.COPROCESSOR))
        return Action(vfp.data_processing(word), Traits(_fpu_arithmetic_kind(word)))
    return _one_register(word, coprocessor in _FPU)


def _fpu_arithmetic_kind(word: int) -> Kind:
    opc1, opc3 = word >> 20 & 0b1011, word >> 6 & 1
    if opc1 in (0b0000, 0b0001, 0b1001, 0b1010):
        return Kind.FPU_MAC
    if opc1 == 0b1000:
        return Kind.FPU_DIV
    if opc1 == 0b1011 and opc3 and word >> 16 & 15 == 1 and word >> 7 & 1:
        return Kind.FPU_DIV  # vsqrt takes the divider
    return Kind.FPU


def _two_registers(word: int) -> Action:
    """mcrr, mrrc and their FPU forms."""
    rt, rt2, reads_core = word >> 12 & 15, word >> 16 & 15, not word >> 20 & 1
    fpu = word >> 8 & 15 in _FPU
    require(rt != PC and rt2 != PC, "transfers the program counter")
    if reads_core:
        moves = tuple(ToFloat(*move) for move in zip(vfp.pair_of(word), (rt, rt2), strict=False)) if fpu else ()
        return Action(moves, Traits(Kind.FPU_MOVE if fpu else Kind.COPROCESSOR, registers(rt, rt2)))
    action = opaque_result(Kind.FPU_MOVE if fpu else Kind.COPROCESSOR_READ, (rt, rt2))
    if not fpu:
        return action
    known = tuple(FromFloat(*move) for move in zip((rt, rt2), vfp.pair_of(word), strict=False))
    return action._replace(ops=action.ops + known)


def _one_register(word: int, fpu: bool) -> Action:
    """mcr, mrc; vmov between a core register and a part of an FPU register; vmrs, vmsr."""
    rt, to_core = word >> 12 & 15, word >> 20 & 1
    if not to_core:
        require(rt != PC, "transfers the program counter")
        ops = vfp.from_core(word, rt) if fpu else ()
        return Action(ops, Traits(Kind.FPU_MOVE if fpu else Kind.COPROCESSOR, (rt,)))
    kind = Kind.FPU_MOVE if fpu else Kind.COPROCESSOR_READ
    if rt == PC:  # vmrs apsr_nzcv, fpscr and mrc p15 with pc: the flags
        flags = (FloatFlags(),) if fpu and word >> 16 & 15 == vfp.FPSCR and word >> 21 & 7 == 7 else ()
        return Action((SetFlags(FlagKind.UNKNOWN), *flags), Traits(kind, sets_flags=True))
    action = opaque_result(kind, (rt,))
    return action._replace(ops=action.ops + vfp.to_core(word, rt)) if fpu else action


def _fpu_memory(word: int, aligned_pc: int) -> Action:
    """vldr, vstr, vldm, vstm, vpush, vpop."""
    pre, up, writeback, load = (word >> bit & 1 for bit in (24, 23, 21, 20))
    rn, words, double = word >> 16 & 15, word & 255, word >> 8 & 1
    offset = 4 * words
    base: Operand = Imm(aligned_pc) if rn == PC else rn
    moved = vfp.halves(word, 12, 22) if double else (vfp.single(word, 12, 22),)
    if pre and not writeback:
        count, start = 1 + double, offset if up else -offset
    else:
        if pre == up or words == 0:
            raise Undecodable("is an undefined form of vldm or vstm")
        require(rn != PC, "transfers floating-point registers relative to the program counter")
        first = word >> 12 & 15
        first = first | word >> 18 & 16 if double else first << 1 | word >> 22 & 1
        many = words // 2 if double else words
        fits = first + many <= 32 and (not double or (words % 2 == 0 and many <= 16))
        require(fits, "is an unpredictable form of vldm or vstm")
        count, start = words, 0 if up else -offset
        lowest = 2 * first if double else first
        moved = tuple(range(lowest, min(lowest + words, FLOATS)))
    ops: list[MicroOp] = []
    for position in range(count):
        distance = start + 4 * position
        address: Operand
        if isinstance(base, Imm):
            address = Imm((base.value + distance) & MASK)
        elif distance == 0:
            address = base
        else:
            ops.append(Compute(Op.ADD if distance > 0 else Op.SUB, T1, base, Imm(abs(distance))))
            address = T1
        ops += _one_word(bool(load), moved[position] if position < len(moved) else None, address)
    if writeback:
        ops.append(Compute(Op.ADD if up else Op.SUB, rn, rn, Imm(offset)))
    traits = Traits(
        Kind.FPU_LOAD if load else Kind.FPU_STORE,
        reads=registers(base),
        writes=(rn,) if writeback else (),
        transfers=count,
        literal=bool(load) and rn == PC,
        immediate_offset=bool(pre and not writeback),
    )
    return Action(tuple(ops), traits)


def _one_word(load: bool, register: int | None, address: Operand) -> tuple[MicroOp, ...]:
    """A word between memory and an FPU register; None: one that is not modelled (d16 and up)."""
    if load:
        return (Load(T0, address),) if register is None else (Load(T0, address), ToFloat(register, T0))
    if register is None:
        return (StoreUnknown(address, 4),)
    return Compute(Op.UNKNOWN, T0), FromFloat(T0, register), Store(address, T0)
