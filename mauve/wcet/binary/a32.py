"""The A32 instruction set: a word to its meaning. Source: ARM DDI 0406C chapter A5 and A8; DDI 0100I for ARMv4T and
v5TE.

Words that later architectures gave a meaning (movw, ldrd, the media space) are decoded with it: a binary for an older
core does not contain them. Forms that the manual calls UNPREDICTABLE are refused.
"""

from __future__ import annotations

from mauve.wcet.binary import arithmetic
from mauve.wcet.binary.coprocessor import decode_coprocessor
from mauve.wcet.binary.media import Prefix, Shape
from mauve.wcet.binary.microop import (
    LR,
    PC,
    Call,
    Compute,
    Condition,
    FlagKind,
    Imm,
    IndirectCall,
    Kind,
    Load,
    MicroOp,
    Op,
    Operand,
    SetFlags,
    Stop,
    Store,
    StoreUnknown,
    SupervisorCall,
    Traits,
)
from mauve.wcet.binary.semantics import (
    MASK,
    T0,
    T5,
    Action,
    Index,
    ShifterOperand,
    Undecodable,
    data_processing,
    double_transfer,
    jump_to,
    multiple_transfer,
    opaque_result,
    registers,
    require,
    rotated_immediate,
    shifted_by_constant,
    shifted_by_register,
    single_transfer,
)

_OPCODES = (
    "and", "eor", "sub", "rsb", "add", "adc", "sbc", "rsc", "tst", "teq", "cmp", "cmn", "orr", "mov", "bic", "mvn",
)  # fmt: skip
_CONDITIONS = tuple(Condition(value) for value in range(15))


def decode_a32(word: int, address: int) -> tuple[Condition, Action]:
    """The condition and meaning of the word at `address`. Raises Undecodable."""
    top = word >> 28
    if top == 15:
        return Condition.AL, _unconditional(word, address)
    condition = _CONDITIONS[top]
    match word >> 25 & 7:
        case 0:
            return condition, _register_space(word, address)
        case 1:
            return condition, _immediate_space(word, address)
        case 2:
            return condition, _word_or_byte(word, address)
        case 3:
            if word & 0x10:
                return condition, _media(word)
            return condition, _word_or_byte(word, address)
        case 4:
            return condition, _multiple(word)
        case 5:
            return condition, _branch(word, address)
        case 6:
            return condition, decode_coprocessor(word, address + 8)
        case _:
            if word & 1 << 24:
                return condition, supervisor_call(word & 0xFFFFFF)
            return condition, decode_coprocessor(word, address + 8)


def supervisor_call(number: int) -> Action:
    """svc: the operating system may leave anything in the registers that a call may change."""
    unknown = tuple(Compute(Op.UNKNOWN, register) for register in (0, 1, 2, 3, 12))
    ops: tuple[MicroOp, ...] = (*unknown, SetFlags(FlagKind.UNKNOWN))
    return Action(ops, Traits(Kind.SUPERVISOR, writes=(0, 1, 2, 3, 12), sets_flags=True), SupervisorCall(number))


def _value(register: int, address: int) -> Operand:
    return Imm((address + 8) & MASK) if register == PC else register


# ---------------------------------------------------------------------------------------------------- data processing
def _register_space(word: int, address: int) -> Action:
    if word & 0x90 == 0x90:
        if word & 0x60:
            return _extra_transfer(word, address)
        return _multiply_or_swap(word)
    if word & 0x01900000 == 0x01000000:
        return _miscellaneous(word, address)
    opcode, sets_flags = _OPCODES[word >> 21 & 15], bool(word & 1 << 20)
    rn, rd, rm, kind = word >> 16 & 15, word >> 12 & 15, word & 15, word >> 5 & 3
    moves, compares = opcode in ("mov", "mvn"), word >> 23 & 3 == 2
    require(not moves or rn == 0, "has a register where zero should be")
    _check_compare(compares, rd)
    if word & 0x10:
        rs = word >> 8 & 15
        require(PC not in (rd, rm, rs) and (moves or rn != PC), "uses the program counter with a register shift")
        return data_processing(opcode, sets_flags, rd, rn, shifted_by_register(rm, kind, rs))
    operand = shifted_by_constant(_value(rm, address), kind, word >> 7 & 31)
    return data_processing(opcode, sets_flags, rd, _value(rn, address), operand)


def _check_compare(compares: bool, rd: int) -> None:
    """rd should be zero in tst, teq, cmp and cmn; 15 was the 26-bit form that writes the mode bits."""
    require(not compares or rd == 0, "is a compare with a destination")


def _immediate_space(word: int, address: int) -> Action:
    rn, rd = word >> 16 & 15, word >> 12 & 15
    match word >> 20 & 31:
        case 0b10000:
            require(rd != PC, "moves a constant to the program counter")
            value = rn << 12 | word & 0xFFF
            return Action((Compute(Op.MOV, rd, Imm(value)),), Traits(Kind.ALU, writes=(rd,), logical=True))
        case 0b10100:
            return arithmetic.move_top(rd, rn << 12 | word & 0xFFF)
        case 0b10010 | 0b10110:
            return _status_immediate(word)
    opcode, sets_flags = _OPCODES[word >> 21 & 15], bool(word & 1 << 20)
    require(opcode not in ("mov", "mvn") or rn == 0, "has a register where zero should be")
    _check_compare(word >> 23 & 3 == 2, rd)
    operand = rotated_immediate(word & 255, 2 * (word >> 8 & 15))
    return data_processing(opcode, sets_flags, rd, _value(rn, address), operand)


def _status_immediate(word: int) -> Action:
    require(word >> 12 & 15 == 15, "is an unknown form of msr")
    if word & 1 << 22 == 0 and word >> 16 & 15 == 0:
        require(word >> 8 & 15 == 0, "is an unknown hint")
        return hint(word & 255)
    return write_status(word >> 16 & 15, bool(word & 1 << 22), ())


def hint(number: int) -> Action:
    """nop, yield, sev and other hints; wfe and wfi wait."""
    return Action((), Traits(Kind.WAIT if number in (2, 3) else Kind.HINT))


def write_status(mask: int, saved: bool, reads: tuple[int, ...]) -> Action:
    """msr: a write to the flag field makes the flags unknown. Control bits may mask interrupts; the mode is taken to
    stay."""
    require(mask != 0, "writes no field of the status register")
    flags = bool(mask & 8) and not saved
    ops: tuple[MicroOp, ...] = (SetFlags(FlagKind.UNKNOWN),) if flags else ()
    kind = Kind.MSR_FLAGS if mask == 8 and not saved else Kind.MSR
    return Action(ops, Traits(kind, reads, sets_flags=flags))


def _miscellaneous(word: int, address: int) -> Action:
    op, rd, rm, rn, rs = word >> 21 & 3, word >> 12 & 15, word & 15, word >> 16 & 15, word >> 8 & 15
    match word >> 4 & 15:
        case 0 if op & 1 == 0:
            require(word & 0x000F0FFF == 0x000F0000, "is an unknown form of mrs")
            return opaque_result(Kind.MRS, (rd,))
        case 0:
            require(word & 0xFFF0 == 0xF000 and rm != PC, "is an unknown form of msr")
            return write_status(rn, bool(op & 2), (rm,))
        case 1 if op == 1:
            require(word & 0xFFF00 == 0xFFF00, "is an unknown form of bx")
            traits = Traits(Kind.BRANCH_EXCHANGE, registers(rm), writes_pc=True)
            return Action((), traits, jump_to(_value(rm, address), exchanges=True, returns=rm == LR))
        case 1 if op == 3:
            require(word & 0xF0F00 == 0xF0F00, "is an unknown form of clz")
            return arithmetic.unary(Op.CLZ, rd, rm, Kind.CLZ)
        case 3 if op == 1:
            require(word & 0xFFF00 == 0xFFF00 and rm != PC, "is an unknown form of blx")
            return link_to_register(rm, address + 4)
        case 5:
            require(rs == 0, "is an unknown form of a saturating addition")
            return opaque_result(Kind.SATURATING, (rd,), (rm, rn))
        case 7 if op == 1:
            return Action((), Traits(Kind.HINT), Stop())
        case kind if kind & 9 == 8:
            return _half_multiplies(op, word >> 5 & 1, word >> 6 & 1, rn, rd, rm, rs)
    raise Undecodable("is not an instruction of this architecture")


def link_to_register(rm: int, back: int) -> Action:
    """blx rm: `back` is the return address as the core writes it to lr."""
    link = Compute(Op.MOV, LR, Imm(back))
    traits = Traits(Kind.BRANCH_EXCHANGE, (rm,), writes=(LR,), writes_pc=True)
    if rm == LR:
        return Action((Compute(Op.MOV, T5, LR), link), traits, IndirectCall(T5))
    return Action((link,), traits, IndirectCall(rm))


def _half_multiplies(op: int, x: int, y: int, rd: int, ra: int, rm: int, rs: int) -> Action:
    """smlaxy, smlawy and smulwy, smlalxy, smulxy: rd stands in bits 19..16, the accumulator in 15..12."""
    match op:
        case 0:
            return arithmetic.half_multiply(rd, rm, rs, x, y, ra)
        case 1:
            require(not x or ra == 0, "has a register where zero should be")
            return arithmetic.word_half_multiply(rd, rm, rs, y, None if x else ra)
        case 2:
            return arithmetic.half_long_accumulate(ra, rd, rm, rs, x, y)
        case _:
            require(ra == 0, "has a register where zero should be")
            return arithmetic.half_multiply(rd, rm, rs, x, y, None)


def _multiply_or_swap(word: int) -> Action:
    rd, ra, rs, rm = word >> 16 & 15, word >> 12 & 15, word >> 8 & 15, word & 15
    sets_flags = bool(word & 1 << 20)
    match word >> 21 & 15:
        case 0:
            require(ra == 0, "has a register where zero should be")
            return arithmetic.multiply(rd, rm, rs, None, False, sets_flags, rs)
        case 1:
            return arithmetic.multiply(rd, rm, rs, ra, False, sets_flags, rs)
        case 2:
            require(not sets_flags, "is not an instruction of this architecture")
            return arithmetic.multiply_accumulate_accumulate(ra, rd, rm, rs)
        case 3:
            require(not sets_flags, "is not an instruction of this architecture")
            return arithmetic.multiply(rd, rm, rs, ra, True, False, rs)
        case 4 | 5 | 6 | 7 as kind:
            return arithmetic.long_multiply(ra, rd, rm, rs, bool(kind & 2), bool(kind & 1), sets_flags, rs)
        case 8 | 10 as kind:
            require(not sets_flags and rs == 0, "is not an instruction of this architecture")
            return _swap(rd, ra, rm, 1 if kind == 10 else 4)
        case kind:
            return _exclusive(kind & 3, bool(sets_flags), rd, ra, rm, rs)


def _swap(rn: int, rt: int, rm: int, size: int) -> Action:
    require(PC not in (rn, rt, rm) and rn not in (rt, rm), "swaps with its own base register")
    ops = (Load(T0, rn, size), Store(rn, rm, size), Compute(Op.MOV, rt, T0))
    return Action(ops, Traits(Kind.SWAP, (rn,), (rm,), (rt,), (rt,), transfers=2, width=size))


def _exclusive(kind: int, load: bool, rn: int, rd: int, rt: int, rs: int) -> Action:
    """ldrex, strex and their byte, half-word and double forms."""
    require(rs == 15, "is not an instruction of this architecture")
    if load:
        require(rt == 15 and (kind != 1 or rd % 2 == 0), "is an unknown form of ldrex")
        return exclusive_load(rn, rd, rd + 1 if kind == 1 else None, (4, 8, 1, 2)[kind])
    return exclusive_store(rn, rd, (rt, rt + 1) if kind == 1 else (rt,), (4, 8, 1, 2)[kind])


def exclusive_load(rn: int, rt: int, rt2: int | None, size: int) -> Action:
    """ldrex: a load as any other."""
    require(PC not in (rn, rt, rt2), "uses the program counter in an exclusive access")
    if rt2 is None:
        return Action((Load(rt, rn, size),), Traits(Kind.EXCLUSIVE, (rn,), (), (rt,), (rt,), 1, size))
    require(rt != rt2, "loads one register twice")
    ops = (Compute(Op.ADD, T0, rn, Imm(4)), Compute(Op.MOV, T5, rn), Load(rt, T5), Load(rt2, T0))
    return Action(ops, Traits(Kind.EXCLUSIVE, (rn,), (), (rt, rt2), (rt, rt2), 2))


def exclusive_store(rn: int, rd: int, stored: tuple[int, ...], size: int) -> Action:
    """strex: it may fail, so memory and the status register hold anything afterwards."""
    require(PC not in (rn, rd, *stored) and rd not in (rn, *stored), "is an unknown form of strex")
    ops = (StoreUnknown(rn, size), Compute(Op.UNKNOWN, rd))
    return Action(ops, Traits(Kind.EXCLUSIVE, (rn,), stored, (rd,), transfers=len(stored), width=min(size, 4)))


# ---------------------------------------------------------------------------------------------------- loads and stores
def _extra_transfer(word: int, address: int) -> Action:
    """Half-words, signed bytes and double words."""
    pre, add, immediate, writeback, load = (bool(word >> bit & 1) for bit in (24, 23, 22, 21, 20))
    rn, rt, rm = word >> 16 & 15, word >> 12 & 15, word & 15
    require(rt != PC, "transfers part of the program counter")
    if immediate:
        offset = ShifterOperand(Imm((word >> 8 & 15) << 4 | rm))
    else:
        require(rm != PC and word >> 8 & 15 == 0, "uses the program counter as an offset")
        offset = ShifterOperand(rm, reads=(rm,))
    user = writeback and not pre
    index = Index(_value(rn, address), offset, add, pre, writeback)
    kind = word >> 5 & 3
    if not load and kind >= 2:
        require(rt % 2 == 0 and rt != LR and not user, "is an unknown form of ldrd or strd")
        return double_transfer(kind == 2, rt, rt + 1, index)
    require(not (user and rm == PC and not immediate), "uses the program counter as an offset")
    return single_transfer(load, rt, index, 1 if kind == 2 else 2, kind >= 2)


def _word_or_byte(word: int, address: int) -> Action:
    register, pre, add, byte, writeback, load = (bool(word >> bit & 1) for bit in (25, 24, 23, 22, 21, 20))
    rn, rt, rm = word >> 16 & 15, word >> 12 & 15, word & 15
    if register:
        require(rm != PC, "uses the program counter as an offset")
        offset = shifted_by_constant(rm, word >> 5 & 3, word >> 7 & 31)
    else:
        offset = ShifterOperand(Imm(word & 0xFFF))
    index = Index(_value(rn, address), offset, add, pre, writeback)
    return single_transfer(load, rt, index, 1 if byte else 4, user=writeback and not pre)


def _multiple(word: int) -> Action:
    before, up, user, writeback, load = (bool(word >> bit & 1) for bit in (24, 23, 22, 21, 20))
    require(not user, "transfers user registers or returns from an exception")
    return multiple_transfer(load, word >> 16 & 15, word & 0xFFFF, before, up, writeback)


def _branch(word: int, address: int) -> Action:
    target = (address + 8 + (((word & 0xFFFFFF) ^ 0x800000) - 0x800000) * 4) & MASK
    if word & 1 << 24:
        link = Compute(Op.MOV, LR, Imm((address + 4) & MASK))
        return Action((link,), Traits(Kind.BRANCH_LINK, writes=(LR,), writes_pc=True), Call(target, False))
    return Action((), Traits(Kind.BRANCH, writes_pc=True), jump_to(Imm(target), exchanges=False))


# ---------------------------------------------------------------------------------------------------- ARMv6 media space
_EXTENDS = {2: Op.SXTB, 3: Op.SXTH, 6: Op.UXTB, 7: Op.UXTH}


_PREFIXES = {1: Prefix.S, 2: Prefix.Q, 3: Prefix.SH, 5: Prefix.U, 6: Prefix.UQ, 7: Prefix.UH}
_SHAPES = {0: Shape.ADD16, 1: Shape.ASX, 2: Shape.SAX, 3: Shape.SUB16, 4: Shape.ADD8, 7: Shape.SUB8}


def _media(word: int) -> Action:
    op1, op2 = word >> 20 & 31, word >> 5 & 7
    rn, rd, rs, rm = word >> 16 & 15, word >> 12 & 15, word >> 8 & 15, word & 15
    match op1:
        case 1 | 2 | 3 | 5 | 6 | 7:
            require(rs == 15 and op2 in (0, 1, 2, 3, 4, 7), "is not an instruction of this architecture")
            return arithmetic.parallel(rd, rn, rm, _PREFIXES[op1], _SHAPES[op2])
        case _ if op1 >> 3 == 1:
            return _pack_extend_reverse(word, op1 & 7, op2)
        case _ if op1 >> 3 == 2:
            return _signed_multiplies(word, op1 & 7, op2)
        case 0b11000 if op2 == 0:
            late = () if rd == PC else (rd,)
            return opaque_result(Kind.SIMD, (rn,), (rm, rs), late)
        case 0b11010 | 0b11011 | 0b11110 | 0b11111 if op2 & 3 == 2:
            signed = not word >> 22 & 1
            return arithmetic.bit_field_extract(rd, rm, word >> 7 & 31, (word >> 16 & 31) + 1, signed)
        case 0b11100 | 0b11101 if op2 & 3 == 0:
            return arithmetic.bit_field_insert(rd, None if rm == PC else rm, word >> 7 & 31, word >> 16 & 31)
        case 0b11111 if op2 == 7 and word >> 28 == 14:
            return Action((), Traits(Kind.HINT), Stop())
    raise Undecodable("is not an instruction of this architecture")


def _pack_extend_reverse(word: int, op1: int, op2: int) -> Action:
    rn, rd, rm = word >> 16 & 15, word >> 12 & 15, word & 15
    if op1 == 0 and op2 & 1 == 0:
        return arithmetic.pack_halves(rd, rn, rm, bool(op2 & 2), word >> 7 & 31)
    if op1 & 2 and op2 & 1 == 0:
        signed = not op1 & 4
        bits = (word >> 16 & 31) + signed
        return arithmetic.saturate(rd, rm, bits, signed, word >> 7 & 31, bool(word & 64))
    if op2 == 3:
        accumulate = None if rn == PC else rn
        rotation = 8 * (word >> 10 & 3)
        require(word >> 8 & 3 == 0, "is an unknown form of an extend")
        if op1 in _EXTENDS:
            return arithmetic.extend(_EXTENDS[op1], rd, rm, rotation, accumulate)
        require(op1 in (0, 4), "is not an instruction of this architecture")
        return opaque_result(Kind.SIMD, (rd,), (rm,) if accumulate is None else (accumulate, rm))
    full = word >> 8 & 15 == 15
    match op1, op2:
        case 0, 5 if full:
            return arithmetic.select(rd, rn, rm)
        case (2, 1) | (6, 1) if full:
            return opaque_result(Kind.SATURATING, (rd,), (rm,))
        case 3, 1 if full and rn == 15:
            return arithmetic.unary(Op.REV, rd, rm)
        case 3, 5 if full and rn == 15:
            return arithmetic.unary(Op.REV16, rd, rm)
        case 7, 1 if full and rn == 15:
            return arithmetic.unary(Op.RBIT, rd, rm)
        case 7, 5 if full and rn == 15:
            return arithmetic.unary(Op.REVSH, rd, rm)
    raise Undecodable("is not an instruction of this architecture")


def _signed_multiplies(word: int, op1: int, op2: int) -> Action:
    rd, ra, rs, rm = word >> 16 & 15, word >> 12 & 15, word >> 8 & 15, word & 15
    accumulate = None if ra == PC else ra
    match op1:
        case 0 if op2 < 4:
            return opaque_result(Kind.SIMD, (rd,), (rm, rs), () if accumulate is None else (accumulate,))
        case 1 | 3 if op2 == 0 and ra == 15:
            return arithmetic.divide(rd, rm, rs, signed=op1 == 1)
        case 4 if op2 < 4:
            return opaque_result(Kind.SIMD, (ra, rd), (rm, rs), (ra, rd))
        case 5 if op2 in (0, 1, 6, 7):
            require(accumulate is not None or op2 < 2, "is not an instruction of this architecture")
            return arithmetic.most_significant_multiply(rd, rm, rs, accumulate, op2 >= 6, bool(op2 & 1))
    raise Undecodable("is not an instruction of this architecture")


# ------------------------------------------------------------------------------------------------ unconditional space
_PRELOADS = ((0x0F30F000, 0x0510F000), (0x0F30F010, 0x0710F000), (0x0F70F000, 0x0450F000), (0x0F70F010, 0x0650F000))
"""Mask and value of pld and pli with an immediate and with a register offset."""


def _unconditional(word: int, address: int) -> Action:
    if word >> 25 & 7 == 5:
        offset = (((word & 0xFFFFFF) ^ 0x800000) - 0x800000) * 4 + (word >> 23 & 2)
        link = Compute(Op.MOV, LR, Imm((address + 4) & MASK))
        traits = Traits(Kind.BRANCH_LINK, writes=(LR,), writes_pc=True)
        return Action((link,), traits, Call((address + 8 + offset) & MASK, True))
    if any(word & mask == value for mask, value in _PRELOADS):
        reads = registers(*((word >> 16 & 15, word & 15) if word >> 25 & 1 else (word >> 16 & 15,)))
        return Action((), Traits(Kind.PRELOAD, reads))
    if word == 0xF57FF01F or (word & 0x0FFFFF00 == 0x057FF000 and word >> 4 & 15 in (4, 5, 6)):
        return Action((), Traits(Kind.BARRIER))
    if word & 0x0FF1FE20 == 0x01000000 and word >> 17 & 1 == 0:
        return Action((), Traits(Kind.CPS))
    if word & 0x0E000000 in (0x0C000000, 0x0E000000) and word >> 24 & 15 != 15 and word >> 8 & 15 not in (10, 11):
        return decode_coprocessor(word, address + 8)
    raise Undecodable("is not an instruction of this architecture")
