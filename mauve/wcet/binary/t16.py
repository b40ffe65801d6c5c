"""The 16-bit Thumb instructions: a half-word to its meaning. Source: ARM DDI 0406C chapter A6.2 and A8.

Inside an IT block the arithmetic instructions leave the flags alone; the caller says so with `in_it`.
"""

from __future__ import annotations

from mauve.wcet.binary import arithmetic
from mauve.wcet.binary.a32 import hint, link_to_register, supervisor_call
from mauve.wcet.binary.microop import (
    LR,
    PC,
    SP,
    CompareBranch,
    Compute,
    Condition,
    Imm,
    Kind,
    Op,
    Operand,
    Stop,
    Traits,
)
from mauve.wcet.binary.semantics import (
    MASK,
    T2,
    Action,
    Index,
    ShifterOperand,
    Undecodable,
    compute,
    data_processing,
    jump_to,
    multiple_transfer,
    registers,
    require,
    shifted_by_constant,
    shifted_by_register,
    single_transfer,
)

_CONDITIONS = tuple(Condition(value) for value in range(15))


def decode_t16(half: int, address: int, in_it: bool) -> tuple[Condition | None, Action]:
    """The meaning of the half-word at `address`, with the condition of a conditional branch (else None). Raises
    Undecodable."""
    flags = not in_it
    match half >> 12:
        case 0 | 1:
            return None, _shift_add_subtract(half, flags)
        case 2 | 3:
            name = ("mov", "cmp", "add", "sub")[half >> 11 & 3]
            register, operand = half >> 8 & 7, ShifterOperand(Imm(half & 255))
            return None, data_processing(name, flags or name == "cmp", register, register, operand)
        case 4:
            if half & 0x800:
                literal = Imm(((address + 4) & ~3) + 4 * (half & 255) & MASK)
                return None, single_transfer(True, half >> 8 & 7, Index(literal, ShifterOperand(Imm(0))))
            return None, _high_registers(half, address) if half & 0x400 else _two_registers(half, flags)
        case 5:
            return None, _register_offset(half)
        case 6 | 7 | 8:
            return None, _immediate_offset(half)
        case 9:
            offset = ShifterOperand(Imm(4 * (half & 255)))
            return None, single_transfer(bool(half & 0x800), half >> 8 & 7, Index(SP, offset))
        case 10:
            return None, _address(half, address)
        case 11:
            return None, _miscellaneous(half, address, in_it)
        case 12:
            base, mask, load = half >> 8 & 7, half & 255, bool(half & 0x800)
            return None, multiple_transfer(load, base, mask, False, True, not (load and mask >> base & 1))
        case 13:
            return _conditional_branch(half, address, in_it)
        case _:
            require(half >> 11 == 0b11100, "is half of a longer instruction")
            target = (address + 4 + (((half & 0x7FF) ^ 0x400) - 0x400) * 2) & MASK
            return None, thumb_branch(target)


def thumb_branch(target: int) -> Action:
    """b with an immediate."""
    return Action((), Traits(Kind.BRANCH, writes_pc=True), jump_to(Imm(target | 1), exchanges=True))


def _shift_add_subtract(half: int, flags: bool) -> Action:
    rd, rm = half & 7, half >> 3 & 7
    kind = half >> 11 & 3
    if kind < 3:
        return data_processing("mov", flags, rd, 0, shifted_by_constant(rm, kind, half >> 6 & 31))
    third = half >> 6 & 7
    operand = ShifterOperand(Imm(third)) if half & 0x400 else ShifterOperand(third, reads=(third,))
    return data_processing("sub" if half & 0x200 else "add", flags, rd, rm, operand)


_TWO_REGISTERS = (
    "and", "eor", "lsl", "lsr", "asr", "adc", "sbc", "ror", "tst", "rsb", "cmp", "cmn", "orr", "mul", "bic", "mvn",
)  # fmt: skip


def _two_registers(half: int, flags: bool) -> Action:
    name, rd, rm = _TWO_REGISTERS[half >> 6 & 15], half & 7, half >> 3 & 7
    match name:
        case "lsl" | "lsr" | "asr" | "ror":
            kind = ("lsl", "lsr", "asr", "ror").index(name)
            return data_processing("mov", flags, rd, 0, shifted_by_register(rd, kind, rm))
        case "rsb":
            return data_processing("rsb", flags, rd, rm, ShifterOperand(Imm(0)))
        case "mul":  # muls rd, rm, rd: the old rd decides the multiplier's early termination
            return arithmetic.multiply(rd, rm, rd, None, False, flags, rd)
        case _:
            return data_processing(
                name, flags or name in ("tst", "cmp", "cmn"), rd, rd, ShifterOperand(rm, reads=(rm,))
            )


def _high_registers(half: int, address: int) -> Action:
    rd, rm = half & 7 | half >> 4 & 8, half >> 3 & 15
    pc = Imm((address + 4) & MASK)
    source: Operand = pc if rm == PC else rm
    operand = ShifterOperand(source, reads=registers(source))
    match half >> 8 & 3:
        case 0:
            if rd == PC:
                require(rm != PC, "adds the program counter to itself")
                return _add_to_pc(rm, pc)
            return data_processing("add", False, rd, rd, operand)
        case 1:
            require(PC not in (rd, rm), "compares the program counter")
            return data_processing("cmp", True, 0, rd, operand)
        case 2:
            if rd == PC:
                return write_pc(source)
            return data_processing("mov", False, rd, 0, operand)
        case _:
            require(half & 7 == 0, "is an unknown form of bx")
            if half & 0x80:
                require(rm != PC, "is an unknown form of blx")
                return link_to_register(rm, (address + 2) | 1)
            traits = Traits(Kind.BRANCH_EXCHANGE, registers(source), writes_pc=True)
            aligned: Operand = Imm(pc.value & ~3) if rm == PC else rm
            return Action((), traits, jump_to(aligned, exchanges=True, returns=rm == LR))


def write_pc(source: Operand) -> Action:
    """mov pc, rm in Thumb state: stays in Thumb state, bit 0 is dropped."""
    target: Operand = Imm(source.value | 1) if isinstance(source, Imm) else source
    flow = jump_to(target, exchanges=isinstance(target, Imm), returns=target == LR)
    return Action((), Traits(Kind.ALU, registers(source), writes_pc=True, logical=True), flow)


def _add_to_pc(rm: int, pc: Imm) -> Action:
    traits = Traits(Kind.ALU, (rm,), writes_pc=True)
    return Action((Compute(Op.ADD, T2, pc, rm),), traits, jump_to(T2, exchanges=False))


_REGISTER_OFFSETS = (  # load, size, signed
    (False, 4, False), (False, 2, False), (False, 1, False), (True, 1, True),
    (True, 4, False), (True, 2, False), (True, 1, False), (True, 2, True),
)  # fmt: skip


def _register_offset(half: int) -> Action:
    load, size, signed = _REGISTER_OFFSETS[half >> 9 & 7]
    rm = half >> 6 & 7
    index = Index(half >> 3 & 7, ShifterOperand(rm, reads=(rm,)))
    return single_transfer(load, half & 7, index, size, signed)


def _immediate_offset(half: int) -> Action:
    size = 2 if half >> 12 == 8 else 1 if half >> 12 == 7 else 4
    index = Index(half >> 3 & 7, ShifterOperand(Imm((half >> 6 & 31) * size)))
    return single_transfer(bool(half & 0x800), half & 7, index, size)


def _address(half: int, address: int) -> Action:
    rd, offset = half >> 8 & 7, 4 * (half & 255)
    base: Operand = SP if half & 0x800 else Imm((address + 4) & ~3 & MASK)
    return Action((compute(Op.ADD, rd, base, Imm(offset)),), Traits(Kind.ALU, registers(base), writes=(rd,)))


def _miscellaneous(half: int, address: int, in_it: bool) -> Action:
    low, register = half & 7, half >> 3 & 7
    match half >> 8 & 15:
        case 0:
            op = Op.SUB if half & 0x80 else Op.ADD
            return Action((Compute(op, SP, SP, Imm(4 * (half & 127))),), Traits(Kind.ALU, (SP,), writes=(SP,)))
        case 1 | 3 | 9 | 11:
            require(not in_it, "is a branch inside an IT block")
            offset = (half >> 3 & 0x40) | (half >> 2 & 0x3E)
            flow = CompareBranch(low, bool(half & 0x800), (address + 4 + offset) & MASK)
            return Action((), Traits(Kind.BRANCH, (low,), writes_pc=True), flow)
        case 2:
            op = (Op.SXTH, Op.SXTB, Op.UXTH, Op.UXTB)[half >> 6 & 3]
            return arithmetic.extend(op, low, register, 0, None)
        case 4 | 5:
            mask = half & 255 | (half & 0x100) << 6
            return multiple_transfer(False, SP, mask, True, False, True)
        case 12 | 13:
            mask = half & 255 | (half & 0x100) << 7
            return multiple_transfer(True, SP, mask, False, True, True)
        case 6 if half & 0xFFE8 == 0xB660:
            require(not in_it, "changes the processor state inside an IT block")
            return Action((), Traits(Kind.CPS))
        case 10:
            require(half >> 6 & 3 != 2, "is not an instruction of this architecture")
            return arithmetic.unary((Op.REV, Op.REV16, Op.REV, Op.REVSH)[half >> 6 & 3], low, register)
        case 14:
            return Action((), Traits(Kind.HINT), Stop())
        case 15 if half & 15 == 0:
            return hint(half >> 4 & 15)
    raise Undecodable("is not an instruction of this architecture")


def _conditional_branch(half: int, address: int, in_it: bool) -> tuple[Condition | None, Action]:
    code = half >> 8 & 15
    if code == 15:
        return None, supervisor_call(half & 255)
    if code == 14:
        return None, Action((), Traits(Kind.HINT), Stop())
    require(not in_it, "is a conditional branch inside an IT block")
    target = (address + 4 + (((half & 255) ^ 128) - 128) * 2) & MASK
    return _CONDITIONS[code], thumb_branch(target)
