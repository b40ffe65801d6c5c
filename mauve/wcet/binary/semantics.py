"""The meaning of ARM instructions as micro-operations, shared by the A32, T16 and T32 decoders.

Each function takes the decoded fields of one instruction class and gives its `Action`. Operands are register numbers or
constants: whoever decodes the fields has replaced the program counter by its value already. Micro-operations act one
after the other; so flags that are computed from the inputs stand before the operation that overwrites an input.
Semantics follow ARM DDI 0406C (ARMv7-A/R), DDI 0403E (ARMv7-M) and DDI 0100I (ARMv4T to v6).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from mauve.wcet.binary.microop import (
    FIRST_TEMPORARY,
    LR,
    PC,
    SP,
    Compute,
    FlagKind,
    Flow,
    Imm,
    IndirectJump,
    Jump,
    Kind,
    Load,
    MicroOp,
    Next,
    Op,
    Operand,
    SetCarry,
    SetFlags,
    Shift,
    Store,
    Traits,
)

MASK = 0xFFFFFFFF
T0, T1, T2, T3, T4, T5, T6 = range(FIRST_TEMPORARY, FIRST_TEMPORARY + 7)
NEXT = Next()


class Undecodable(Exception):
    """Raised inside the decoders for words that are undefined, unpredictable or not modelled; `Decoder` turns it into
    data."""


class Action(NamedTuple):
    """What an instruction does: operations, where control goes, and what a timing model asks for."""

    ops: tuple[MicroOp, ...]
    traits: Traits
    flow: Flow = NEXT


@dataclass(frozen=True, slots=True)
class ShifterOperand:
    """The flexible second operand: `before` computes `value` (into T0), `carry` sets C when the instruction sets
    flags."""

    value: Operand
    before: tuple[MicroOp, ...] = ()
    carry: tuple[MicroOp, ...] = ()
    reads: tuple[int, ...] = ()
    by_register: bool = False
    shifts: bool = False


def registers(*operands: Operand) -> tuple[int, ...]:
    """The distinct architectural registers among operands, in order."""
    return tuple(dict.fromkeys(o for o in operands if not isinstance(o, Imm) and o < PC))


def require(possible: bool, reason: str) -> None:
    """Refuse a word that has no defined meaning."""
    if not possible:
        raise Undecodable(reason)


# ---------------------------------------------------------------------------------------------------- shifter operand
_SHIFTS = (Shift.LSL, Shift.LSR, Shift.ASR, Shift.ROR)
_SHIFT_OPS = (Op.SHL, Op.LSR, Op.ASR, Op.ROR)


def shifted_by_constant(rm: Operand, kind: int, amount: int) -> ShifterOperand:
    """Register shifted by an immediate: `kind` and `amount` as encoded (LSR and ASR 0 mean 32, ROR 0 means RRX)."""
    if kind == 0 and amount == 0:
        return ShifterOperand(rm, reads=registers(rm))
    if kind == 3 and amount == 0:
        before: tuple[MicroOp, ...] = (Compute(Op.RRX, T0, rm),)
        return ShifterOperand(T0, before, (SetCarry(Shift.RRX, rm, Imm(1)),), registers(rm), shifts=True)
    by = Imm(amount or 32)
    carry = (SetCarry(_SHIFTS[kind], rm, by),)
    return ShifterOperand(T0, (Compute(_SHIFT_OPS[kind], T0, rm, by),), carry, registers(rm), shifts=True)


def shifted_by_register(rm: int, kind: int, rs: int) -> ShifterOperand:
    """Register shifted by the low byte of a register."""
    before = (Compute(_SHIFT_OPS[kind], T0, rm, rs),)
    return ShifterOperand(T0, before, (SetCarry(_SHIFTS[kind], rm, rs),), registers(rm, rs), by_register=True)


def rotated_immediate(byte: int, rotation: int) -> ShifterOperand:
    """A byte rotated right; the carry-out is bit 31 of the result unless the rotation is 0."""
    if rotation == 0:
        return ShifterOperand(Imm(byte))
    value = (byte >> rotation | byte << (32 - rotation)) & MASK
    return ShifterOperand(Imm(value), carry=(SetCarry(Shift.ROR, Imm(byte), Imm(rotation)),))


# ---------------------------------------------------------------------------------------------------- data processing
_LOGICAL = {"and": Op.AND, "eor": Op.XOR, "orr": Op.OR, "bic": Op.AND, "orn": Op.OR, "tst": Op.AND, "teq": Op.XOR}
_ARITHMETIC = {
    "add": (Op.ADD, FlagKind.ADD),
    "cmn": (Op.ADD, FlagKind.ADD),
    "sub": (Op.SUB, FlagKind.SUB),
    "cmp": (Op.SUB, FlagKind.SUB),
    "rsb": (Op.SUB, FlagKind.SUB),
    "adc": (Op.ADC, FlagKind.ADC),
    "sbc": (Op.SBC, FlagKind.SBC),
    "rsc": (Op.SBC, FlagKind.SBC),
}
_COMPARES = frozenset(("tst", "teq", "cmp", "cmn"))


_ZERO = Imm(0)


def compute(op: Op, dst: int, a: Operand, b: Operand = _ZERO) -> Compute:
    """A computation, folded when it adds or subtracts constants."""
    if isinstance(a, Imm) and isinstance(b, Imm) and op in (Op.ADD, Op.SUB):
        return Compute(Op.MOV, dst, Imm((a.value + b.value if op is Op.ADD else a.value - b.value) & MASK))
    if op is Op.NOT and isinstance(a, Imm):
        return Compute(Op.MOV, dst, Imm(a.value ^ MASK))
    return Compute(op, dst, a, b)


def data_processing(name: str, sets_flags: bool, rd: int, rn: Operand, operand: ShifterOperand) -> Action:
    """and, eor, sub, rsb, add, adc, sbc, rsc, tst, teq, cmp, cmn, orr, mov, bic, mvn, orn; rd 15 is a branch."""
    compares = name in _COMPARES
    writes_pc = rd == PC and not compares
    require(not (writes_pc and sets_flags), "returns from an exception")
    logical = name not in _ARITHMETIC
    moves = name in ("mov", "mvn")
    dst = T2 if compares or writes_pc else rd
    ops = (
        _logical_ops(name, sets_flags, dst, rn, operand)
        if logical
        else _arithmetic_ops(name, sets_flags, dst, rn, operand)
    )
    if compares and not logical:
        ops = tuple(op for op in ops if not (isinstance(op, Compute) and op.dst == T2))
    flow: Flow = NEXT
    if writes_pc:
        plain = name == "mov" and not operand.before
        flow = jump_to(operand.value if plain else T2, exchanges=False, returns=plain and operand.value == LR)
        ops = () if plain else ops
    traits = Traits(
        Kind.ALU,
        reads=tuple(dict.fromkeys((() if moves else registers(rn)) + operand.reads)),
        writes=() if compares or writes_pc else (rd,),
        shifts_by_register=operand.by_register,
        shifts=operand.shifts,
        writes_pc=writes_pc,
        logical=logical,
        sets_flags=sets_flags,
    )
    return Action(ops, traits, flow)


def _logical_ops(name: str, sets_flags: bool, dst: int, rn: Operand, operand: ShifterOperand) -> tuple[MicroOp, ...]:
    before, value = operand.before, operand.value
    carry = operand.carry if sets_flags else ()
    flags: tuple[MicroOp, ...] = (SetFlags(FlagKind.LOGIC, dst),) if sets_flags else ()
    if name == "mov":
        if len(before) == 1 and isinstance(before[0], Compute) and before[0].op is not Op.RRX:
            shift = before[0]
            return (*carry, Compute(shift.op, dst, shift.a, shift.b), *flags)
        return (*before, *carry, Compute(Op.MOV, dst, value), *flags)
    if name == "mvn":
        return (*before, *carry, compute(Op.NOT, dst, value), *flags)
    if name in ("bic", "orn"):
        if isinstance(value, Imm):
            value = Imm(value.value ^ MASK)
        else:
            before = (*before, Compute(Op.NOT, T1, value))
            value = T1
    return (*before, *carry, Compute(_LOGICAL[name], dst, rn, value), *flags)


def _arithmetic_ops(name: str, sets_flags: bool, dst: int, rn: Operand, operand: ShifterOperand) -> tuple[MicroOp, ...]:
    op, flags = _ARITHMETIC[name]
    a, b = (operand.value, rn) if name in ("rsb", "rsc") else (rn, operand.value)
    if not sets_flags:
        return (*operand.before, compute(op, dst, a, b))
    if op in (Op.ADC, Op.SBC):  # the operation needs the carry that the flags overwrite
        return (*operand.before, Compute(op, T2, a, b), SetFlags(flags, a, b), Compute(Op.MOV, dst, T2))
    return (*operand.before, SetFlags(flags, a, b), Compute(op, dst, a, b))


def jump_to(target: Operand, exchanges: bool, returns: bool = False) -> Flow:
    """The flow of a write to the program counter; a constant target makes a plain jump (A32 state unless bit 0 says
    Thumb)."""
    if isinstance(target, Imm):
        require(exchanges or target.value & 3 == 0, "jumps to an address that is not aligned")
        thumb = bool(target.value & 1)
        require(thumb or target.value & 3 == 0, "jumps to an address that is not aligned")
        return Jump(target.value & ~1, thumb)
    return IndirectJump(target, exchanges, returns)


# ---------------------------------------------------------------------------------------------------- loads and stores
class Index(NamedTuple):
    """How a single transfer forms its address: base plus or minus offset, before or after, with writeback or not."""

    base: Operand
    offset: ShifterOperand
    add: bool = True
    pre: bool = True
    writeback: bool = False

    @property
    def updates(self) -> bool:
        """Whether the base register changes."""
        return self.writeback or not self.pre


def _addresses(index: Index, protect: tuple[int, ...]) -> tuple[tuple[MicroOp, ...], Operand, tuple[MicroOp, ...]]:
    """Operations before the access, the address operand, and the base update after it. `protect` are registers that the
    access overwrites, which a later base update must not read."""
    base, offset = index.base, index.offset.value
    op = Op.ADD if index.add else Op.SUB
    before = index.offset.before
    zero = isinstance(offset, Imm) and offset.value == 0
    if index.updates:
        require(not isinstance(base, Imm), "writes back to the program counter")
        require(base not in protect, "transfers its own base register with writeback")
    if index.pre and not index.updates:
        if zero:
            return before, base, ()
        if isinstance(base, Imm) and isinstance(offset, Imm):
            value = base.value + offset.value if index.add else base.value - offset.value
            return before, Imm(value & MASK), ()
        return (*before, Compute(op, T1, base, offset)), T1, ()
    assert isinstance(base, int)
    if index.pre:
        return (*before, Compute(op, base, base, offset)), base, ()
    if isinstance(offset, Imm):
        return before, base, (Compute(op, base, base, offset),)
    return (*before, Compute(op, T1, base, offset)), base, (Compute(Op.MOV, base, T1),)


def single_transfer(
    load: bool, rt: int, index: Index, size: int = 4, signed: bool = False, user: bool = False
) -> Action:
    """ldr, str and their byte and half-word forms; rt 15 loads the program counter."""
    pc_load = load and rt == PC
    if rt == PC:
        require(size == 4 and not user, "transfers part of the program counter")
    before, address, after = _addresses(index, (rt,))
    access: tuple[MicroOp, ...]
    if load:
        access = (Load(T3 if pc_load else rt, address, size, signed),)
    elif rt == PC:  # the value stored is the instruction's address plus 8 or 12, as the core chooses
        access = (Compute(Op.UNKNOWN, T3), Store(address, T3, size))
    else:
        access = (Store(address, rt, size),)
    base = registers(index.base)
    traits = Traits(
        Kind.LOAD if load else Kind.STORE,
        reads=tuple(dict.fromkeys(base + index.offset.reads)),
        late_reads=() if load else registers(rt),
        writes=(() if pc_load or not load else (rt,)) + (base if index.updates else ()),
        loaded=(rt,) if load and not pc_load else (),
        transfers=1,
        width=size,
        signed=signed,
        shifts=index.offset.shifts,
        scaled_offset=index.offset.shifts,
        literal=load and isinstance(index.base, Imm),
        immediate_offset=isinstance(index.offset.value, Imm),
        writes_pc=pc_load,
    )
    flow: Flow = IndirectJump(T3, exchanges=True, returns=index.base == SP) if pc_load else NEXT
    return Action((*before, *access, *after), traits, flow)


def double_transfer(load: bool, rt: int, rt2: int, index: Index) -> Action:
    """ldrd and strd: two words at the address and behind it."""
    require(rt < PC and rt2 < PC, "transfers the program counter")
    require(not load or rt != rt2, "loads one register twice")
    before, address, after = _addresses(index, (rt, rt2))
    ops: list[MicroOp] = list(before)
    if load and address in (rt, rt2):
        ops.append(Compute(Op.MOV, T4, address))
        address = T4
    if isinstance(address, Imm):
        second: Operand = Imm((address.value + 4) & MASK)
    else:
        ops.append(Compute(Op.ADD, T5, address, Imm(4)))
        second = T5
    ops += [Load(rt, address), Load(rt2, second)] if load else [Store(address, rt), Store(second, rt2)]
    base = registers(index.base)
    traits = Traits(
        Kind.LOAD_DOUBLE if load else Kind.STORE_DOUBLE,
        reads=tuple(dict.fromkeys(base + index.offset.reads)),
        late_reads=() if load else (rt, rt2),
        writes=((rt, rt2) if load else ()) + (base if index.updates else ()),
        loaded=(rt, rt2) if load else (),
        transfers=2,
        literal=load and isinstance(index.base, Imm),
        immediate_offset=isinstance(index.offset.value, Imm),
        scaled_offset=index.offset.shifts,
        shifts=index.offset.shifts,
    )
    return Action((*ops, *after), traits)


def multiple_transfer(load: bool, rn: int, mask: int, before: bool, up: bool, writeback: bool) -> Action:
    """ldm and stm in all four modes: increment or decrement (`up`), before or after; `mask` bit 15 is the program
    counter."""
    listed = tuple(r for r in range(16) if mask >> r & 1)
    require(bool(listed), "transfers no register")
    require(rn != PC, "uses the program counter as base")
    count = len(listed)
    lowest = (4 if before else 0) if up else (0 if before else 4) - 4 * count
    require(not (load and writeback and rn in listed), "loads its own base register with writeback")
    ops: list[MicroOp] = []
    base = rn
    if load and rn in listed and rn != listed[-1]:
        ops.append(Compute(Op.MOV, T4, rn))
        base = T4
    for position, register in enumerate(listed):
        offset = lowest + 4 * position
        address = base
        if offset:
            address = T1
            ops.append(Compute(Op.ADD if offset > 0 else Op.SUB, T1, base, Imm(abs(offset))))
        if load:
            ops.append(Load(T3 if register == PC else register, address))
        elif register == PC or (register == rn and writeback and position > 0):
            ops += [Compute(Op.UNKNOWN, T3), Store(address, T3)]
        else:
            ops.append(Store(address, register))
    if writeback:
        ops.append(Compute(Op.ADD if up else Op.SUB, rn, rn, Imm(4 * count)))
    core = tuple(r for r in listed if r < PC)
    pc_load = load and PC in listed
    traits = Traits(
        Kind.LOAD_MULTIPLE if load else Kind.STORE_MULTIPLE,
        reads=(rn,),
        late_reads=() if load else core,
        writes=tuple(dict.fromkeys((core if load else ()) + ((rn,) if writeback else ()))),
        loaded=core if load else (),
        transfers=count,
        writes_pc=pc_load,
    )
    # A frame-pointer epilogue (ldmea fp, {fp, sp, pc}) returns as well: it reloads the stack pointer on its way out.
    flow: Flow = IndirectJump(T3, exchanges=True, returns=rn == SP or SP in listed) if pc_load else NEXT
    return Action(tuple(ops), traits, flow)


# ---------------------------------------------------------------------------------------------------- not modelled
def opaque_result(
    kind: Kind, writes: tuple[int, ...], reads: tuple[int, ...] = (), late_reads: tuple[int, ...] = ()
) -> Action:
    """An instruction whose results are not modelled: every register it writes is unknown afterwards."""
    require(all(r < PC for r in (*reads, *writes, *late_reads)), "uses the program counter as a plain register")
    ops = tuple(Compute(Op.UNKNOWN, register) for register in writes)
    return Action(ops, Traits(kind, tuple(dict.fromkeys(reads)), late_reads, writes))
