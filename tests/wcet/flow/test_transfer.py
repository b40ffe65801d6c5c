"""Abstract execution of straight code holds every concrete execution from the states it stands for."""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from wcet import microop_machine as machine

from mauve.wcet.binary.floats import FloatCompute, FloatOp, FromFloat, ToFloat
from mauve.wcet.binary.microop import (
    Compute,
    Condition,
    FlagKind,
    Imm,
    Instruction,
    Kind,
    Load,
    Next,
    Op,
    SetCarry,
    SetFlags,
    Shift,
    Store,
    Traits,
)
from mauve.wcet.flow import domain, effects, flags, joining, linear, transfer
from mauve.wcet.flow.domain import MASK, TOP
from mauve.wcet.flow.linear import entry_symbol
from mauve.wcet.flow.rank.terms import FrameBase, add, atom, compute, number
from mauve.wcet.flow.state import State, Symbols

REGISTERS = 6
EDGES = [0, 1, 2, 3, 4, 8, 31, 32, 33, 100, 255, 256, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFC, 0xFFFFFFFF]
words = st.one_of(st.sampled_from(EDGES), st.integers(0, MASK))
registers = st.integers(0, REGISTERS - 1)
operands = st.one_of(registers, words.map(Imm))
floats = st.integers(0, 2)
slots = st.integers(-6, 6).map(lambda i: 4 * i)
STACK = 0x20001000


@st.composite
def operations(draw):
    """A few micro-operations on registers, on the stack (register 13), and between registers and those of the FPU."""
    kind = draw(st.integers(0, 11))
    if kind == 10:
        moved = ToFloat(draw(floats), draw(registers)), FloatCompute(FloatOp.MOV, draw(floats), draw(floats))
        return (draw(st.sampled_from(moved)),)
    if kind == 11:
        register = draw(registers)
        return Compute(Op.UNKNOWN, register), FromFloat(register, draw(floats))
    if kind <= 4:
        op = draw(st.sampled_from([op for op in Op if op is not Op.UNKNOWN]))
        return (Compute(op, draw(registers), draw(operands), draw(operands)),)
    if kind == 5:
        flag_kind = draw(st.sampled_from([k for k in FlagKind if k is not FlagKind.UNKNOWN]))
        return (SetFlags(flag_kind, draw(operands), draw(operands)),)
    if kind == 6:
        return (SetCarry(draw(st.sampled_from(list(Shift))), draw(operands), draw(operands)),)
    address = (Compute(Op.ADD, 16, 13, Imm(draw(slots) + draw(st.integers(0, 3)) & MASK)),)
    size = draw(st.sampled_from([1, 2, 4]))
    if kind == 7:
        return (*address, Store(16, draw(operands), size))
    return (*address, Load(draw(registers), 16, size, draw(st.booleans())))


@st.composite
def instructions(draw):
    condition = draw(st.sampled_from([Condition.AL] * 3 + list(Condition)))
    return condition, draw(operations())


@st.composite
def starts(draw):
    """Ranges of the registers and one choice of numbers in them."""
    ranges, numbers = [], []
    for _ in range(REGISTERS):
        low = draw(words)
        if draw(st.booleans()):
            ranges.append(TOP)
            numbers.append(low)
        else:
            step, n = draw(st.sampled_from([1, 1, 4, 12])), draw(st.integers(0, 40))
            ranges.append(domain.progression(low, step, n))
            numbers.append((low + step * draw(st.integers(0, n))) & MASK)
    return ranges, numbers


def abstract(ranges) -> State:
    state = State(Symbols())
    for register, known in enumerate(ranges):
        if known.n == 0:
            state.regs[register] = known.low
        elif not known.is_top:
            state.ranges[entry_symbol(register)] = known
    return state


def concrete(numbers, n, z, c, v) -> machine.State:
    values = [*numbers, *([0] * (13 - REGISTERS)), STACK, 0] + [0] * 20
    return machine.State(values, [n, z, c, v], lambda address: (address * 37 + 11) & 0xFF)


def holds(state: State, run: machine.State) -> bool:
    """Whether the state allows the registers: by their ranges and their differences, and the flags."""
    found = [state.range_of(state.regs[r]) for r in range(REGISTERS)]
    if any(run.registers[r] is not None and run.registers[r] not in found[r] for r in range(REGISTERS)):
        return False
    for first in range(REGISTERS):
        for second in range(first):
            a, b = run.registers[first], run.registers[second]
            if a is None or b is None:
                continue
            difference = state.range_of(linear.sub(state.regs[first], state.regs[second]))
            if (a - b) & MASK not in difference:
                return False
    if None in run.flags:
        return True
    n, z, c, v = (bool(flag) for flag in run.flags)
    return bool(state.flags & flags.exact(n, z, c, v))


def execute_abstract(states: list[State], condition: Condition, ops) -> list[State]:
    after = []
    for state in states:
        skipped = state.copy()
        if condition is not Condition.AL and skipped.assume(condition.negated):
            after.append(skipped)
        if state.assume(condition):
            transfer.run(state, ops, transfer.NoImage())
            after.append(state)
    return after


@settings(max_examples=120, deadline=None)
@given(starts(), st.tuples(*[st.booleans()] * 4), st.lists(instructions(), min_size=1, max_size=10), st.booleans())
def test_abstract_execution_holds_the_concrete_one(start, nzcv, code, join_always):
    ranges, numbers = start
    states, run = [abstract(ranges)], concrete(numbers, *nzcv)
    for condition, ops in code:
        instruction = Instruction(0, 4, False, "", condition, ops, Next(), Traits(Kind.ALU))
        machine.execute(instruction, run)
        states = execute_abstract(states, condition, ops)
        if join_always or len(states) > 6:
            states = [joining.join_all(states)]
        assert any(holds(state, run) for state in states)


@settings(max_examples=60, deadline=None)
@given(starts(), starts(), st.lists(operations(), max_size=4), st.lists(operations(), max_size=4))
def test_a_join_holds_both_sides(left, right, first, second):
    base = abstract(left[0])
    other = base.copy()
    run_one, run_two = concrete(left[1], 0, 0, 0, 0), concrete(left[1], 0, 0, 0, 0)
    for state, run, code in ((base, run_one, first), (other, run_two, second)):
        for ops in code:
            transfer.run(state, ops, transfer.NoImage())
            machine.execute(Instruction(0, 4, False, "", Condition.AL, ops, Next(), Traits(Kind.ALU)), run)
    joined = joining.join(base, other)
    assert holds(joined, run_one) and holds(joined, run_two)


def test_a_compare_of_a_copy_narrows_the_stack_slot_it_came_from():
    state = State(Symbols())
    address = Compute(Op.SUB, 16, 13, Imm(8))
    load = (address, Load(3, 16))
    transfer.run(state, load, transfer.NoImage())
    transfer.run(state, (SetFlags(FlagKind.SUB, 3, Imm(99)),), transfer.NoImage())
    assert state.assume(Condition.LS)
    transfer.run(state, (Compute(Op.MOV, 3, Imm(0)), *load), transfer.NoImage())
    assert repr(state.range_of(state.regs[3])) == "[0..99]"


class OwnImage(transfer.NoImage):
    """Memory of the binary up to 0x1000, none of it constant."""

    def constant(self, address, size):
        return 0 if size == 0 and address < 0x1000 else None


@pytest.mark.parametrize(
    ("base", "index", "remembered"),
    [
        (0x800, None, True),
        (0x4001_0000, None, False),
        (0, 4, True),
        (8, 4, True),
        (0x4001_0000, 4, False),
    ],
)
def test_what_is_written_to_a_device_is_not_what_is_read_from_it(base, index, remembered):
    """A fixed address outside the binary may be a device, also where an unknown index is added to it."""
    state = State(Symbols())
    address = Compute(Op.MOV, 16, Imm(base)) if index is None else Compute(Op.ADD, 16, index, Imm(base))
    transfer.run(state, (address, Store(16, Imm(1)), Load(3, 16)), OwnImage())
    assert state.constant_of(state.regs[3]) == (1 if remembered else None)
    transfer.run(state, (Load(3, 16), Load(5, 16)), OwnImage())
    assert (state.regs[3] == state.regs[5]) == remembered


def test_what_two_branches_name_differently_is_the_same_again_behind_them():
    """r4 - r5 gets a range in each branch of a compare; behind the join both are what they were."""
    state = State(Symbols())
    transfer.run(state, (Load(4, 0), Load(5, 1), Compute(Op.SUB, 3, 4, 5)), transfer.NoImage())
    before = state.regs[4:6]
    transfer.run(state, (SetFlags(FlagKind.SUB, 3, Imm(62)),), transfer.NoImage())
    below, above = state.copy(), state.copy()
    assert below.assume(Condition.CC) and above.assume(Condition.CS)
    assert repr(below.range_of(below.regs[3])) == "[0..61]"
    assert below.regs[4:6] != before
    assert joining.join(below, above).regs[4:6] == before


def test_values_with_a_constant_difference_keep_it_across_a_join():
    one, two = State(Symbols()), None
    two = one.copy()
    one.regs[0], one.regs[1] = 0, linear.of_symbol(entry_symbol(4))
    two.regs[0], two.regs[1] = 1, linear.add(linear.of_symbol(entry_symbol(4)), 4)
    joined = joining.join(one, two)
    scaled = linear.scale(joined.regs[0], 4)
    assert linear.sub(joined.regs[1], scaled) == linear.of_symbol(entry_symbol(4))
SPILL, RELOAD = ToFloat(16, 0), (Compute(Op.UNKNOWN, 3), FromFloat(3, 16))
IN_FRAME = (Compute(Op.SUB, 0, 13, Imm(8)), Compute(Op.MOV, 1, Imm(5)), Store(0, 1))


def run_over(*ops):
    state = State(Symbols())
    transfer.run(state, ops, transfer.NoImage())
    return state


def test_a_word_comes_back_from_an_fpu_register_as_it_went_there():
    state = run_over(SPILL, *RELOAD)
    assert state.regs[3] == state.regs[0]
    state = run_over(SPILL, FloatCompute(FloatOp.ADD, 16, 16, 16), *RELOAD)
    assert linear.sub(state.regs[3], state.regs[0]) != 0 and state.range_of(state.regs[3]).is_top


def test_a_store_through_an_fpu_register_reaches_the_frame():
    """An address of the frame that was kept there, followed or not, is one of the frame still."""
    store = (Store(3, Imm(9)), Compute(Op.SUB, 4, 13, Imm(8)), Load(5, 4))
    assert run_over(*IN_FRAME, Load(5, 0)).regs[5] == 5
    assert run_over(*IN_FRAME, SPILL, *RELOAD, *store).regs[5] == 9
    lost = run_over(*IN_FRAME, SPILL, FloatCompute(FloatOp.UNKNOWN, 16), *RELOAD, *store)
    assert lost.range_of(lost.regs[5]).is_top


def test_a_call_keeps_the_upper_half_of_the_fpu_registers():
    state = run_over(ToFloat(15, 0), ToFloat(16, 0))
    before = state.regs[0]
    after = effects.call(state, effects.UNKNOWN, None)
    assert after is not None
    transfer.run(after, (*RELOAD, Compute(Op.UNKNOWN, 4), FromFloat(4, 15)), transfer.NoImage())
    assert after.regs[3] == before and after.regs[4] != before


@pytest.mark.parametrize(("offset", "bits", "known"), [(-44, 1, True), (8, 3, True), (5, 1, False), (0, 4, False)])
def test_low_bits_put_into_an_address_of_the_frame_are_added(offset, bits, known):
    """clang writes `orr r1, r0, #1` for the second byte of a buffer on the stack; sp is a multiple of 4."""
    state = run_over(Compute(Op.ADD, 0, 13, Imm(offset & MASK)), Compute(Op.OR, 1, 0, Imm(bits)))
    there = linear.add(linear.of_symbol(linear.FRAME), offset + bits & MASK)
    assert (state.regs[1] == there) == known
    term = compute(Op.OR, add(atom(FrameBase()), number(offset)), number(bits))
    assert (term == add(atom(FrameBase()), number(offset + bits))) == known
