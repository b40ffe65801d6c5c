"""The 32-bit Thumb instructions: two half-words to their meaning. Source: ARM DDI 0406C chapter A6.3 and A8.

The bl pair of ARMv4T has the same encoding as the 32-bit bl with J1 = J2 = 1.
"""

from __future__ import annotations

from mauve.wcet.binary import arithmetic
from mauve.wcet.binary.a32 import exclusive_load, exclusive_store, hint, write_status
from mauve.wcet.binary.coprocessor import decode_coprocessor
from mauve.wcet.binary.media import Prefix, Shape
from mauve.wcet.binary.microop import (
    LR,
    PC,
    SP,
    Call,
    Compute,
    Condition,
    Imm,
    Kind,
    Op,
    Operand,
    Stop,
    TableJump,
    Traits,
)
from mauve.wcet.binary.semantics import (
    MASK,
    T1,
    Action,
    Index,
    ShifterOperand,
    Undecodable,
    compute,
    data_processing,
    double_transfer,
    multiple_transfer,
    opaque_result,
    registers,
    require,
    rotated_immediate,
    shifted_by_constant,
    shifted_by_register,
    single_transfer,
)
from mauve.wcet.binary.t16 import thumb_branch

_CONDITIONS = tuple(Condition(value) for value in range(15))
_UNDEFINED = "is not an instruction of this architecture"


def decode_t32(first: int, second: int, address: int, in_it: bool) -> tuple[Condition | None, Action]:
    """The meaning of the half-words at `address`, with the condition of a conditional branch (else None). Raises
    Undecodable."""
    if first >> 11 & 3 == 2:
        if second & 0x8000:
            return _branch_or_control(first, second, address, in_it)
        return None, (_plain_immediate(first, second, address) if first & 0x200 else _modified_immediate(first, second))
    if first & 0x400:  # bits 27..24 = 11xx behind the same prefix as A32's condition
        require(first & 0x1000 == 0, "is an Advanced SIMD or unknown coprocessor instruction")
        return None, decode_coprocessor((first & 0xFFF) << 16 | second, address + 4 & ~3)
    if first >> 11 & 3 == 1:
        if first & 0x200:
            return None, _shifted_register(first, second)
        if first & 0x40:
            return None, _double_exclusive_table(first, second, address)
        return None, _multiple(first, second)
    match first >> 8 & 7:
        case 2:
            return None, _register(first, second)
        case 3:
            return None, _long_multiply(first, second) if first & 0x80 else _multiply(first, second)
        case _:
            return None, _single(first, second, address)


def _plain(*numbers: int) -> None:
    """Most 32-bit instructions refuse sp and pc."""
    require(all(number not in (SP, PC) for number in numbers), "uses sp or pc where that is unpredictable")


# ---------------------------------------------------------------------------------------------------- data processing
_NAMES = {0: "and", 1: "bic", 2: "orr", 3: "orn", 4: "eor", 8: "add", 10: "adc", 11: "sbc", 13: "sub", 14: "rsb"}
_COMPARES = {"and": "tst", "eor": "teq", "add": "cmn", "sub": "cmp"}


def _named(first: int, second: int, operand: ShifterOperand) -> Action:
    opcode, sets_flags, rn, rd = first >> 5 & 15, bool(first & 16), first & 15, second >> 8 & 15
    require(opcode in _NAMES, _UNDEFINED)
    name = _NAMES[opcode]
    if rd == PC and sets_flags and name in _COMPARES:
        name, rd = _COMPARES[name], 0
        require(rn != PC and (rn != SP or name in ("cmp", "cmn")), "uses sp or pc where that is unpredictable")
        return data_processing(name, True, rd, rn, operand)
    if rn == PC:
        require(name in ("orr", "orn"), "uses the program counter as an operand")
        name = "mov" if name == "orr" else "mvn"
        plain_copy = name == "mov" and not sets_flags and not operand.before and not isinstance(operand.value, Imm)
        require(rd != PC and (rd != SP or plain_copy), "uses sp or pc where that is unpredictable")
        return data_processing(name, sets_flags, rd, 0, operand)
    stack = name in ("add", "sub") and rn == SP
    require(rd != PC and (rd != SP or stack) and (rn != SP or stack), "uses sp or pc where that is unpredictable")
    return data_processing(name, sets_flags, rd, rn, operand)


def _expand(twelve: int) -> ShifterOperand:
    """ThumbExpandImm_C."""
    byte = twelve & 255
    if twelve >> 10 == 0:
        pattern = twelve >> 8 & 3
        require(pattern == 0 or byte != 0, "has an unpredictable constant")
        return ShifterOperand(Imm(byte * (1, 0x00010001, 0x01000100, 0x01010101)[pattern]))
    return rotated_immediate(0x80 | twelve & 127, twelve >> 7)


def _twelve(first: int, second: int) -> int:
    return (first & 0x400) << 1 | second >> 4 & 0x700 | second & 255


def _modified_immediate(first: int, second: int) -> Action:
    return _named(first, second, _expand(_twelve(first, second)))


def _shifted_register(first: int, second: int) -> Action:
    require(second & 0x8000 == 0, _UNDEFINED)
    amount, kind, rm = second >> 10 & 0x1C | second >> 6 & 3, second >> 4 & 3, second & 15
    if first >> 5 & 15 == 6:
        require(first & 16 == 0 and kind in (0, 2), _UNDEFINED)
        _plain(second >> 8 & 15, first & 15, rm)
        return arithmetic.pack_halves(second >> 8 & 15, first & 15, rm, kind == 2, amount)
    copies = first & 0xFFFF == 0xEA4F and amount == 0 and kind == 0
    require(rm != PC and (rm != SP or (copies and second >> 8 & 15 != SP)), "uses sp or pc where that is unpredictable")
    return _named(first, second, shifted_by_constant(rm, kind, amount))


def _plain_immediate(first: int, second: int, address: int) -> Action:
    rn, rd = first & 15, second >> 8 & 15
    lsb, width = second >> 10 & 0x1C | second >> 6 & 3, second & 31
    require(first & 0x100 == 0 or (first & 0x400 == 0 and second & 0x20 == 0), _UNDEFINED)
    match first >> 4 & 31:
        case 0 | 10 as code:
            op = Op.SUB if code else Op.ADD
            base: Operand = Imm(address + 4 & ~3) if rn == PC else rn
            require(rd != PC and (rd != SP or rn == SP), "uses sp or pc where that is unpredictable")
            offset = Imm(_twelve(first, second))
            return Action((compute(op, rd, base, offset),), Traits(Kind.ALU, registers(base), writes=(rd,)))
        case 4 | 12 as code:
            _plain(rd)
            value = rn << 12 | _twelve(first, second)
            if code == 12:
                return arithmetic.move_top(rd, value)
            return Action((Compute(Op.MOV, rd, Imm(value)),), Traits(Kind.ALU, writes=(rd,), logical=True))
        case 16 | 18 | 24 | 26 as op:
            _plain(rd, rn)
            if op & 2 and second & 0x70C0 == 0:  # ssat16, usat16
                return opaque_result(Kind.SATURATING, (rd,), (rn,))
            signed, shift = op < 24, second >> 10 & 0x1C | second >> 6 & 3
            return arithmetic.saturate(rd, rn, (second & 31) + signed, signed, shift, bool(op & 2))
        case 20 | 28 as code:
            _plain(rd, rn)
            return arithmetic.bit_field_extract(rd, rn, lsb, width + 1, code == 20)
        case 22:
            _plain(rd)
            require(rn != SP, "uses sp or pc where that is unpredictable")
            return arithmetic.bit_field_insert(rd, None if rn == PC else rn, lsb, width)
    raise Undecodable(_UNDEFINED)


_SHIFT_EXTENDS = {0: Op.SXTH, 1: Op.UXTH, 4: Op.SXTB, 5: Op.UXTB}
_PREFIXES = {0: Prefix.S, 1: Prefix.Q, 2: Prefix.SH, 4: Prefix.U, 5: Prefix.UQ, 6: Prefix.UH}
_SHAPES = {0: Shape.ADD8, 1: Shape.ADD16, 2: Shape.ASX, 4: Shape.SUB8, 5: Shape.SUB16, 6: Shape.SAX}
_REVERSALS = (Op.REV, Op.REV16, Op.RBIT, Op.REVSH)


def _register(first: int, second: int) -> Action:
    require(second >> 12 == 15, _UNDEFINED)
    op1, op2 = first >> 4 & 15, second >> 4 & 15
    rn, rd, rm = first & 15, second >> 8 & 15, second & 15
    _plain(rd, rm)
    if op1 < 8 and op2 == 0:
        _plain(rn)
        return data_processing("mov", bool(op1 & 1), rd, 0, shifted_by_register(rn, op1 >> 1, rm))
    require(rn != SP, "uses sp or pc where that is unpredictable")
    if op1 < 6 and op2 >= 8:
        require(op2 < 12, _UNDEFINED)
        accumulate = None if rn == PC else rn
        if op1 in _SHIFT_EXTENDS:
            return arithmetic.extend(_SHIFT_EXTENDS[op1], rd, rm, 8 * (op2 & 3), accumulate)
        return opaque_result(Kind.SIMD, (rd,), (rm,) if accumulate is None else (accumulate, rm))
    _plain(rn)
    if op1 >= 8 and op2 < 8:
        require(op1 in (8, 9, 10, 12, 13, 14) and op2 & 3 != 3, _UNDEFINED)
        return arithmetic.parallel(rd, rn, rm, _PREFIXES[op2], _SHAPES[op1 & 7])
    match op1, op2:
        case 8, 8 | 9 | 10 | 11:
            return opaque_result(Kind.SATURATING, (rd,), (rm, rn))
        case 9, 8 | 9 | 10 | 11:
            require(rn == rm, "is an unpredictable form of a reversal")
            return arithmetic.unary(_REVERSALS[op2 & 3], rd, rm)
        case 10, 8:
            return arithmetic.select(rd, rn, rm)
        case 11, 8:
            require(rn == rm, "is an unpredictable form of clz")
            return arithmetic.unary(Op.CLZ, rd, rm, Kind.CLZ)
    raise Undecodable(_UNDEFINED)


# ---------------------------------------------------------------------------------------------------- multiplications
def _multiply(first: int, second: int) -> Action:
    op1, op2 = first >> 4 & 7, second >> 4 & 3
    rn, ra, rd, rm = first & 15, second >> 12, second >> 8 & 15, second & 15
    require(second >> 6 & 3 == 0, _UNDEFINED)
    _plain(rn, rd, rm)
    require(ra != SP, "uses sp or pc where that is unpredictable")
    accumulate = None if ra == PC else ra
    match op1:
        case 0 if op2 < 2:
            require(op2 == 0 or accumulate is not None, _UNDEFINED)
            return arithmetic.multiply(rd, rn, rm, accumulate, op2 == 1, False, rm)
        case 1:
            return arithmetic.half_multiply(rd, rn, rm, op2 >> 1, op2 & 1, accumulate)
        case 3 if op2 < 2:
            return arithmetic.word_half_multiply(rd, rn, rm, op2 & 1, accumulate)
        case 2 | 4 if op2 < 2:
            return opaque_result(Kind.SIMD, (rd,), (rn, rm), () if accumulate is None else (accumulate,))
        case 5 | 6 if op2 < 2:
            require(op1 == 5 or accumulate is not None, _UNDEFINED)
            return arithmetic.most_significant_multiply(rd, rn, rm, accumulate, op1 == 6, bool(op2 & 1))
        case 7 if op2 == 0:
            return opaque_result(Kind.SIMD, (rd,), (rn, rm), () if accumulate is None else (accumulate,))
    raise Undecodable(_UNDEFINED)


def _long_multiply(first: int, second: int) -> Action:
    op1, op2 = first >> 4 & 7, second >> 4 & 15
    rn, low, high, rm = first & 15, second >> 12, second >> 8 & 15, second & 15
    _plain(rn, high, rm)
    match op1, op2:
        case (1, 15) | (3, 15):
            require(low == 15, "is an unpredictable form of a division")
            return arithmetic.divide(high, rn, rm, signed=op1 == 1)
    _plain(low)
    match op1, op2:
        case ((0 | 2 | 4 | 6), 0):
            return arithmetic.long_multiply(low, high, rn, rm, op1 in (0, 4), op1 >= 4, False, rm)
        case 4, (8 | 9 | 10 | 11):
            return arithmetic.half_long_accumulate(low, high, rn, rm, op2 >> 1 & 1, op2 & 1)
        case ((4 | 5), (12 | 13)):
            return opaque_result(Kind.SIMD, (low, high), (rn, rm), (low, high))
        case 6, 6:
            return arithmetic.multiply_accumulate_accumulate(low, high, rn, rm)
    raise Undecodable(_UNDEFINED)


# ---------------------------------------------------------------------------------------------------- loads and stores
def _single(first: int, second: int, address: int) -> Action:
    require(first & 0x0110 != 0x0100, "is an Advanced SIMD load or store")
    signed, load, size_code = bool(first & 0x100), bool(first & 16), first >> 5 & 3
    require(size_code != 3 and not (signed and (size_code == 2 or not load)), _UNDEFINED)
    size, rn, rt = 1 << size_code, first & 15, second >> 12
    require(load or rn != PC, _UNDEFINED)
    index, user = _single_index(first, second, address)
    if load and rt == PC and size < 4:
        require(not index.updates and not user, "loads part of the program counter")
        return Action((), Traits(Kind.PRELOAD, tuple(dict.fromkeys(registers(index.base) + index.offset.reads))))
    require(load or rt != PC, "stores the program counter")
    require(rt != SP or size == 4, "uses sp or pc where that is unpredictable")
    return single_transfer(load, rt, index, size, signed, user)


def _single_index(first: int, second: int, address: int) -> tuple[Index, bool]:
    """The addressing mode, and whether the access is unprivileged."""
    rn = first & 15
    if rn == PC:
        distance = second & 0xFFF if first & 0x80 else -(second & 0xFFF)
        return Index(Imm((address + 4 & ~3) + distance & MASK), ShifterOperand(Imm(0))), False
    if first & 0x80:
        return Index(rn, ShifterOperand(Imm(second & 0xFFF))), False
    if second & 0x800:
        pre, add, writeback = (bool(second >> bit & 1) for bit in (10, 9, 8))
        require(pre or writeback, _UNDEFINED)
        user = pre and add and not writeback
        return Index(rn, ShifterOperand(Imm(second & 255)), add, pre, writeback), user
    require(second & 0x7C0 == 0, _UNDEFINED)
    rm = second & 15
    _plain(rm)
    return Index(rn, shifted_by_constant(rm, 0, second >> 4 & 3)), False


def _multiple(first: int, second: int) -> Action:
    mode, writeback, load, rn = first >> 7 & 3, bool(first & 0x20), bool(first & 16), first & 15
    require(mode in (1, 2), "saves or restores the processor state")
    require(second & 0x2000 == 0 and (load or second & 0x8000 == 0), "transfers sp, or stores pc")
    require(second.bit_count() >= 2 and second & 0xC000 != 0xC000, "has an unpredictable register list")
    require(not (writeback and second >> rn & 1), "transfers its own base register with writeback")
    return multiple_transfer(load, rn, second, mode == 2, mode == 1, writeback)


def _double_exclusive_table(first: int, second: int, address: int) -> Action:
    pre, up, writeback, load = (bool(first >> bit & 1) for bit in (8, 7, 5, 4))
    rn, rt, rt2 = first & 15, second >> 12, second >> 8 & 15
    if pre or writeback:
        _plain(rt, rt2)
        base: Operand = rn
        if rn == PC:
            require(load and not writeback, "stores relative to the program counter")
            base = Imm(address + 4 & ~3)
        return double_transfer(load, rt, rt2, Index(base, ShifterOperand(Imm(4 * (second & 255))), up, pre, writeback))
    if not up:
        return _exclusive_word(load, rn, rt, rt2, 4 * (second & 255))
    kind, low = second >> 4 & 15, second & 15
    if load and kind < 2:
        return _table_branch(rn, low, kind + 1, second, address)
    require(kind in (4, 5, 7), _UNDEFINED)
    _plain(rt)
    require(kind == 7 or rt2 == PC, _UNDEFINED)
    require(not load or low == PC, _UNDEFINED)
    if load:
        return exclusive_load(rn, rt, rt2 if kind == 7 else None, {4: 1, 5: 2, 7: 8}[kind])
    return exclusive_store(rn, low, (rt, rt2) if kind == 7 else (rt,), {4: 1, 5: 2, 7: 8}[kind])


def _exclusive_word(load: bool, rn: int, rt: int, rd: int, offset: int) -> Action:
    _plain(rt)
    require(rn != PC, "uses the program counter in an exclusive access")
    address = T1 if offset else rn
    if load:
        require(rd == PC, _UNDEFINED)
        action = exclusive_load(rn, rt, None, 4)
    else:
        _plain(rd)
        action = exclusive_store(rn, rd, (rt,), 4)
    if not offset:
        return action
    moved = exclusive_load(T1, rt, None, 4) if load else exclusive_store(T1, rd, (rt,), 4)
    return Action((Compute(Op.ADD, address, rn, Imm(offset)), *moved.ops), action.traits)


def _table_branch(rn: int, rm: int, size: int, second: int, address: int) -> Action:
    require(second & 0xFF00 == 0xF000 and rn != SP, "is an unknown form of a table branch")
    _plain(rm)
    table: Operand = Imm(address + 4) if rn == PC else rn
    traits = Traits(Kind.TABLE_BRANCH, registers(table, rm), transfers=1, width=size, writes_pc=True)
    return Action((), traits, TableJump(table, rm, size, address + 4))


# ---------------------------------------------------------------------------------------------------- branches, control
def _branch_or_control(first: int, second: int, address: int, in_it: bool) -> tuple[Condition | None, Action]:
    sign, j1, j2 = first >> 10 & 1, second >> 13 & 1, second >> 11 & 1
    if second & 0x5000 == 0:
        code = first >> 6 & 15
        if code >= 14:
            return None, _control(first, second)
        require(not in_it, "is a conditional branch inside an IT block")
        offset = -sign << 20 | j2 << 19 | j1 << 18 | (first & 63) << 12 | (second & 0x7FF) << 1
        return _CONDITIONS[code], thumb_branch((address + 4 + offset) & MASK)
    i1, i2 = 1 - (j1 ^ sign), 1 - (j2 ^ sign)
    offset = -sign << 24 | i1 << 23 | i2 << 22 | (first & 0x3FF) << 12 | (second & 0x7FF) << 1
    target = (address + 4 + offset) & MASK
    if second & 0x4000 == 0:
        return None, thumb_branch(target)
    thumb = bool(second & 0x1000)
    if not thumb:
        require(second & 1 == 0, _UNDEFINED)
        target = (target & ~3) if address & 2 == 0 else ((address + 4 & ~3) + offset) & MASK
    link = Compute(Op.MOV, LR, Imm((address + 4) | 1))
    return None, Action((link,), Traits(Kind.BRANCH_LINK, writes=(LR,), writes_pc=True), Call(target, thumb))


def _control(first: int, second: int) -> Action:
    rn, rd = first & 15, second >> 8 & 15
    match first >> 4 & 0x7F:
        case 0x38 | 0x39:
            _plain(rn)
            require(second & 0x3020 == 0, _UNDEFINED)
            return write_status(rd, bool(first & 16), (rn,))
        case 0x3A:
            if rd & 7 == 0:
                return hint(second & 255)
            return Action((), Traits(Kind.CPS))
        case 0x3B:
            require(second >> 4 & 15 in (2, 4, 5, 6), _UNDEFINED)
            return Action((), Traits(Kind.BARRIER))
        case 0x3E | 0x3F:
            _plain(rd)
            require(rn == PC and second & 0x3020 == 0, _UNDEFINED)
            return opaque_result(Kind.MRS, (rd,))
        case 0x7F if second >> 12 & 7 == 2:
            return Action((), Traits(Kind.HINT), Stop())
    raise Undecodable(_UNDEFINED)
