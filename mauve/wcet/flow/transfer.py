"""What a micro-operation does to an abstract state."""

from __future__ import annotations

from collections.abc import Callable

from mauve.wcet.binary.microop import (
    Compute,
    FlagKind,
    Imm,
    Load,
    MicroOp,
    Op,
    Operand,
    SetCarry,
    SetFlags,
    Shift,
    Store,
    StoreUnknown,
)
from mauve.wcet.flow import domain, flags, linear, spills
from mauve.wcet.flow.domain import MASK, SIGN, TOP, Range
from mauve.wcet.flow.image import Image, NoImage
from mauve.wcet.flow.linear import FRAME, MOST_TERMS, Value
from mauve.wcet.flow.state import State

Noted = Callable[[State, int, Value, int], None]
"""Called with the state, the index of the micro-operation, the address and the size of each access."""


def run(state: State, ops: tuple[MicroOp, ...], image: Image, note: Noted | None = None) -> None:
    """Change the state as the micro-operations do, one after the other."""
    regs = state.regs
    for index, op in enumerate(ops):
        kind = type(op)
        if kind is Compute:
            assert isinstance(op, Compute)
            a = op.a.value if isinstance(op.a, Imm) else regs[op.a]
            b = op.b.value if isinstance(op.b, Imm) else regs[op.b]
            regs[op.dst] = compute(state, op.op, a, b)
        elif kind is Load:
            assert isinstance(op, Load)
            address = op.address.value if isinstance(op.address, Imm) else regs[op.address]
            if note is not None:
                note(state, index, address, op.size)
            regs[op.dst] = state.load(address, op.size, op.signed, image)
        elif kind is Store:
            assert isinstance(op, Store)
            address = op.address.value if isinstance(op.address, Imm) else regs[op.address]
            if note is not None:
                note(state, index, address, op.size)
            state.store(address, op.value.value if isinstance(op.value, Imm) else regs[op.value], op.size)
        elif kind is SetFlags:
            assert isinstance(op, SetFlags)
            set_flags(state, op.kind, _operand(state, op.a), _operand(state, op.b))
        elif kind is SetCarry:
            assert isinstance(op, SetCarry)
            set_carry(state, op.shift, _operand(state, op.value), _operand(state, op.amount))
        elif kind is StoreUnknown:
            assert isinstance(op, StoreUnknown)
            address = _operand(state, op.address)
            if note is not None:
                note(state, index, address, op.size)
            for offset in range(0, op.size, 4):
                state.store(linear.add(address, offset), None, min(4, op.size - offset))
        else:
            spills.operate(state, op)


def _operand(state: State, operand: Operand) -> Value:
    return operand.value if isinstance(operand, Imm) else state.regs[operand]


def compute(state: State, op: Op, a: Value, b: Value) -> Value:
    """The result of a micro-operation on two values."""
    if op is Op.MOV:
        return a
    if op is Op.ADD:
        return state.limited(linear.add(a, b))
    if op is Op.SUB:
        return state.limited(linear.sub(a, b))
    if op is Op.ADC or op is Op.SBC:
        carry = flags.carry_of(state.flags)
        extra: Value = state.fresh(domain.BIT) if carry is None else carry
        other = linear.sub(MASK, b) if op is Op.SBC else b
        return state.limited(linear.add(linear.add(a, other), extra))
    if op is Op.UNKNOWN:
        return state.tainted(state.fresh(), state.mask(a) | state.mask(b))
    if op is Op.RRX:
        carry = flags.carry_of(state.flags)
        if carry is None or type(a) is not int:
            return state.tainted(state.fresh(), state.mask(a))
        return carry << 31 | a >> 1
    if type(a) is int and (type(b) is int or op in _ONE_OPERAND):
        return domain.concrete(op, a, b if type(b) is int else 0)
    linear_result = _linear(state, op, a, b)
    if linear_result is not None:
        return linear_result
    result = state.fresh(domain.apply(op, state.range_of(a), state.range_of(b)))
    return state.tainted(result, state.mask(a) | state.mask(b))


_ONE_OPERAND = frozenset({Op.NOT, Op.CLZ, Op.RBIT, Op.REV, Op.REV16, Op.REVSH, Op.SXTB, Op.SXTH, Op.UXTB, Op.UXTH})
_EXTENDS = {
    Op.UXTB: domain.BYTE,
    Op.UXTH: domain.HALF,
    Op.SXTB: domain.SIGNED_BYTE,
    Op.SXTH: domain.SIGNED_HALF,
}


def _linear(state: State, op: Op, a: Value, b: Value) -> Value | None:
    """The result where it is a linear expression of the operands."""
    if op is Op.NOT:
        return linear.sub(MASK, a)
    if op in _EXTENDS:
        return a if domain.includes(_EXTENDS[op], _hull(state.range_of(a))) else None
    fixed_b = state.constant_of(b)
    if op is Op.MUL:
        if fixed_b is None:
            a, fixed_b = b, state.constant_of(a)
        return None if fixed_b is None else linear.scale(a, domain.signed(fixed_b))
    if op in (Op.AND, Op.OR, Op.XOR):
        fixed_a = state.constant_of(a)
        if fixed_b is None:
            a, b, fixed_a, fixed_b = b, a, fixed_b, fixed_a
        return _combined(state, op, a, b) if fixed_b is None else _masked(state, op, a, fixed_b)
    if fixed_b is None or op not in (Op.SHL, Op.LSR, Op.ASR):
        return None
    amount = fixed_b & 0xFF
    if op is Op.SHL:
        return linear.scale(a, 1 << amount) if amount < 32 else 0
    if amount == 0:
        return a
    if amount > 31:
        return None
    quotient = linear.divide(a, 1 << amount)
    if quotient is None:
        return None
    half = SIGN >> amount
    limit = domain.between(0, MASK >> amount) if op is Op.LSR else domain.between(-half, half - 1)
    return quotient if domain.includes(limit, _hull(state.range_of(quotient))) else None


def _hull(known: Range) -> Range:
    return known if known.values is None else Range(known.low, known.step, known.n)


def _combined(state: State, op: Op, a: Value, b: Value) -> Value | None:
    """Bits of two values put together are their sum where they have none in common."""
    if op is Op.AND:
        return None
    common = domain.bit_and(_hull(state.range_of(a)), _hull(state.range_of(b)))
    total = linear.add(a, b)
    short = type(total) is int or len(total) <= 2 * MOST_TERMS + 1  # type: ignore[arg-type]
    return total if common.n == 0 and common.low == 0 and short else None


def _masked(state: State, op: Op, a: Value, mask: int) -> Value | None:
    if op is Op.XOR:
        return linear.sub(MASK, a) if mask == MASK else (a if mask == 0 else None)
    if op is Op.OR:
        if mask == 0 or _is_at_multiple(a, mask):
            return linear.add(a, mask)
        known = domain.bit_and(state.range_of(a), domain.constant(mask))
        return linear.add(a, mask) if known.n == 0 and known.low == 0 else None
    low = mask ^ MASK
    if low & (low + 1) == 0 and linear.factor_of(a, FRAME) == 1:
        return linear.sub(a, state.fresh(domain.between(0, low)))  # an address of the frame, aligned
    if mask & (mask + 1) == 0 and domain.includes(domain.between(0, mask), _hull(state.range_of(a))):
        return a
    return None


def _is_at_multiple(a: Value, bits: int) -> bool:
    """Whether an address has a constant distance from sp at the function's entry, and none of some low bits: sp is a
    multiple of 4 at any time (AAPCS, 6.2.1.1). clang writes the address of a buffer's second byte so."""
    return type(a) is tuple and a[1:] == (FRAME, 1) and bits < 4 and not a[0] & bits


# ------------------------------------------------------------------------------------------------------- flags
def set_flags(state: State, kind: FlagKind, a: Value, b: Value) -> None:
    """Set the possible flags and remember the compare that they come from."""
    if kind is FlagKind.LOGIC:
        state.flags = flags.of_logic(state.range_of(a), state.flags)
        state.origin = None if type(a) is int else (kind, a, 0)
        return
    if kind is FlagKind.SUB:
        state.flags = _subtraction(state, a, b)
        state.origin = None if type(a) is int and type(b) is int else (kind, a, b)
        return
    state.origin = None
    if kind is FlagKind.UNKNOWN:
        state.flags = flags.ANY
    elif kind is FlagKind.WIDE:
        state.flags = flags.of_wide(state.range_of(a), state.range_of(b), state.flags)
    else:
        _addition(state, kind, a, b)


def _subtraction(state: State, a: Value, b: Value) -> int:
    if type(a) is int and type(b) is int:
        return flags.of_sum_of_words(a, b ^ MASK, 1)
    difference = state.range_of(linear.sub(a, b))
    ordered = None
    if linear.factor_of(a, FRAME) == 1 and linear.factor_of(b, FRAME) == 1:
        low, high = difference.signed_bounds()
        ordered = 1 if low >= 0 else -1 if high < 0 else None
    return flags.of_subtraction(state.range_of(a), state.range_of(b), difference, ordered)


def _addition(state: State, kind: FlagKind, a: Value, b: Value) -> None:
    carry = 0 if kind is FlagKind.ADD else flags.carry_of(state.flags)
    second = linear.sub(MASK, b) if kind is FlagKind.SBC else b
    if type(a) is int and type(second) is int and carry is not None:
        state.flags = flags.of_sum_of_words(a, second, carry)
        return
    extra = domain.BIT if carry is None else domain.constant(carry)
    total = state.range_of(linear.add(a, second))
    state.flags = flags.of_addition(state.range_of(a), state.range_of(second), domain.add(total, extra), extra)
    if kind is FlagKind.ADD and type(b) is int and b not in (0, SIGN):
        # Except for these two numbers, a + b sets Z, N, C and V as a - (-b) does.
        state.origin = (FlagKind.SUB, a, -b & MASK)
    elif kind is FlagKind.ADD:
        state.origin = (FlagKind.LOGIC, linear.add(a, b), 0)


def set_carry(state: State, shift: Shift, value: Value, amount: Value) -> None:
    """C := the carry-out of a shift; a compare remembered stays good for conditions that do not look at C."""
    by, word = state.constant_of(amount), state.constant_of(value)
    if by is not None and by & 0xFF == 0 and shift is not Shift.RRX:
        return
    carry = None if by is None or word is None else _carry_out(shift, word, by & 0xFF)
    state.flags = flags.with_carry(state.flags, carry)
    if by is None:
        state.flags |= flags.with_carry(state.flags, None)
    if state.origin is not None and state.origin[0] is not FlagKind.LOGIC:
        state.origin = None


def _carry_out(shift: Shift, word: int, by: int) -> int:
    match shift:
        case Shift.LSL:
            return word >> (32 - by) & 1 if by <= 32 else 0
        case Shift.LSR:
            return word >> (by - 1) & 1
        case Shift.ASR:
            return domain.signed(word) >> (by - 1) & 1
        case Shift.ROR:
            return word >> (by - 1) % 32 & 1
        case Shift.RRX:
            return word & 1


__all__ = ["TOP", "Image", "NoImage", "compute", "run", "set_carry", "set_flags"]
