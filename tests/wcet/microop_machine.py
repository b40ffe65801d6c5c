"""A concrete machine for micro-operations: the meaning of `Instruction`, written a second time for the tests.

A value is an int, or None for unknown: whatever depends on an unknown is unknown, and nothing is claimed of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

from mauve.wcet.binary.floats import (
    FloatCompute,
    FloatConstant,
    FloatOp,
    FromFloat,
    FromInteger,
    ToFloat,
    ToInteger,
)
from mauve.wcet.binary.microop import (
    Call,
    CompareBranch,
    Compute,
    Condition,
    FlagKind,
    Imm,
    IndirectCall,
    IndirectJump,
    Instruction,
    Jump,
    Load,
    Op,
    SetCarry,
    SetFlags,
    Shift,
    Stop,
    Store,
    StoreUnknown,
    TableJump,
)

M = 0xFFFFFFFF
Value = int | None


@dataclass
class State:
    """Registers 0..14 (and temporaries), flags N, Z, C, V, bytes of memory; `pc` and `thumb` say what is next."""

    registers: list[Value]
    flags: list[Value]
    read: Callable[[int], int]
    memory: dict[int, Value] = field(default_factory=dict)
    accesses: list[tuple[int, int]] = field(default_factory=list)
    floats: dict[int, Value] = field(default_factory=dict)
    """words of FPU registers, as far as they are known; arithmetic on them is not modelled here"""
    wild: bool = False
    """an access had an unknown address"""
    pc: Value = None
    thumb: bool | None = None


def execute(instruction: Instruction, state: State) -> None:
    """One step."""
    state.registers += [None] * (32 - len(state.registers))
    holds = _holds(instruction.condition, state.flags)
    assert holds is not None, "the tests start with known flags"
    state.pc, state.thumb = instruction.end, instruction.thumb
    if not holds:
        return
    for op in instruction.ops:
        _operation(op, state)
    flow = instruction.flow
    match flow:
        case Jump(target, thumb) | Call(target, thumb):
            state.pc, state.thumb = target, thumb
        case CompareBranch(register, nonzero, target):
            if bool(_value(register, state)) is nonzero:
                state.pc = target
        case IndirectJump(target=target, exchanges=exchanges) | IndirectCall(target=target, exchanges=exchanges):
            value = _value(target, state)
            if exchanges:
                state.thumb = None if value is None else bool(value & 1)
            state.pc = None if value is None else value & ~1 if exchanges or instruction.thumb else value
        case TableJump(table, index, size, pc):
            base, number = _value(table, state), _value(index, state)
            entry = _load(state, (base + number * size) & M, size) if None not in (base, number) else None
            state.pc = None if entry is None else (pc + 2 * entry) & M
        case Stop():
            state.pc = None


def _value(operand: int | Imm, state: State) -> Value:
    return operand.value if isinstance(operand, Imm) else state.registers[operand]


def _holds(condition: Condition, flags: list[Value]) -> bool | None:
    n, z, c, v = flags
    if condition is Condition.AL:
        return True
    base = condition.value >> 1
    needed = [(z,), (c,), (n,), (v,), (c, z), (n, v), (n, z, v)][base]
    if None in needed:
        return None
    result = [z == 1, c == 1, n == 1, v == 1, c == 1 and z == 0, n == v, z == 0 and n == v][base]
    return result != bool(condition.value & 1)


def _signed(x: int) -> int:
    return x - (1 << 32) if x & 1 << 31 else x


def _operation(op: object, state: State) -> None:
    match op:
        case Compute(name, dst, a, b):
            state.registers[dst] = _compute(name, _value(a, state), _value(b, state), state.flags[2])
        case Load(dst, address, size, signed):
            at = _value(address, state)
            state.wild |= at is None
            value = None if at is None else _load(state, at, size)
            if value is not None and signed and value >> (8 * size - 1):
                value |= M << 8 * size & M
            state.registers[dst] = value
        case Store(address, value, size):
            at, word = _value(address, state), _value(value, state)
            _store(state, at, [None if word is None else word >> 8 * n & 255 for n in range(size)])
        case StoreUnknown(address, size):
            _store(state, _value(address, state), [None] * size)
        case SetFlags(kind, a, b):
            _set_flags(kind, _value(a, state), _value(b, state), state.flags)
        case SetCarry(shift, value, amount):
            state.flags[2] = _carry(shift, _value(value, state), _value(amount, state), state.flags[2])
        case ToFloat(dst, source):
            state.floats[dst] = state.registers[source]
        case FromFloat(dst, source):
            state.registers[dst] = state.floats.get(source)
        case FloatCompute(op=FloatOp.MOV, dst=dst, a=a):
            state.floats[dst] = state.floats.get(a)
        case FloatConstant(dst, word):
            state.floats[dst] = word
        case FloatCompute(dst=dst) | FromInteger(dst=dst) | ToInteger(dst=dst):
            state.floats[dst] = None


def _load(state: State, at: int, size: int) -> Value:
    state.accesses.append((at, size))
    found = [state.memory[at + n] if at + n in state.memory else state.read(at + n) for n in range(size)]
    return None if None in found else sum(byte << 8 * n for n, byte in enumerate(found))


def _store(state: State, at: Value, content: list[Value]) -> None:
    if at is None:
        state.wild = True
        return
    state.accesses.append((at, len(content)))
    for n, byte in enumerate(content):
        state.memory[at + n] = byte


def _compute(op: Op, a: Value, b: Value, carry: Value) -> Value:
    if op is Op.UNKNOWN or a is None or b is None or (op in (Op.ADC, Op.SBC, Op.RRX) and carry is None):
        return None
    n = b & 255
    bits = f"{a:032b}"
    match op:
        case Op.MOV:
            r = a
        case Op.NOT:
            r = a ^ M
        case Op.ADD:
            r = a + b
        case Op.SUB:
            r = a - b
        case Op.ADC:
            r = a + b + carry
        case Op.SBC:
            r = a - b - 1 + carry
        case Op.AND:
            r = a & b
        case Op.OR:
            r = a | b
        case Op.XOR:
            r = a ^ b
        case Op.SHL:
            r = a << n
        case Op.LSR:
            r = a >> n
        case Op.ASR:
            r = _signed(a) >> n
        case Op.ROR:
            r = (a << 32 | a) >> n % 32
        case Op.RRX:
            r = (carry << 32 | a) >> 1
        case Op.MUL:
            r = a * b
        case Op.UMULH:
            r = a * b >> 32
        case Op.SMULH:
            r = _signed(a) * _signed(b) >> 32
        case Op.UDIV:
            r = a // b if b else 0
        case Op.SDIV:
            x, y = _signed(a), _signed(b)
            r = abs(x) // abs(y) * (1 if (x < 0) == (y < 0) else -1) if y else 0
        case Op.CLZ:
            r = len(bits) - len(bits.lstrip("0"))
        case Op.RBIT:
            r = int(bits[::-1], 2)
        case Op.REV:
            r = int.from_bytes(a.to_bytes(4, "little"), "big")
        case Op.REV16:
            r = (a & 0xFF00FF) << 8 | a >> 8 & 0xFF00FF
        case Op.REVSH:
            r = (a >> 8 & 255) | ((a & 255 ^ 128) - 128) << 8
        case Op.SXTB:
            r = (a & 255 ^ 128) - 128
        case Op.SXTH:
            r = (a & 0xFFFF ^ 0x8000) - 0x8000
        case Op.UXTB:
            r = a & 255
        case Op.UXTH:
            r = a & 0xFFFF
    return r & M


def _set_flags(kind: FlagKind, a: Value, b: Value, flags: list[Value]) -> None:
    carry = flags[2]
    if kind is FlagKind.UNKNOWN:
        flags[:] = [None] * 4
        return
    if kind is FlagKind.LOGIC:
        flags[:2] = [None, None] if a is None else [a >> 31, int(a == 0)]
        return
    if kind is FlagKind.WIDE:
        flags[:2] = [None, None] if a is None or b is None else [b >> 31, int(a == 0 and b == 0)]
        return
    if a is None or b is None or (kind in (FlagKind.ADC, FlagKind.SBC) and carry is None):
        flags[:] = [None] * 4
        return
    other = b if kind in (FlagKind.ADD, FlagKind.ADC) else b ^ M
    extra = {FlagKind.ADD: 0, FlagKind.SUB: 1}.get(kind, carry)
    total = a + other + extra
    plain = _signed(a) + _signed(other) + extra
    result = total & M
    flags[:] = [result >> 31, int(result == 0), int(total > M), int(_signed(result) != plain)]


def _carry(shift: Shift, value: Value, amount: Value, carry: Value) -> Value:
    if shift is Shift.RRX:
        return None if value is None else value & 1
    if amount is None:
        return None
    n = amount & 255
    if n == 0:
        return carry
    if value is None:
        return None
    match shift:
        case Shift.LSL:
            return value << n >> 32 & 1
        case Shift.LSR:
            return value >> (n - 1) & 1
        case Shift.ASR:
            return _signed(value) >> (n - 1) & 1
        case _:
            return value >> (n - 1) % 32 & 1
