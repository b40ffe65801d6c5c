"""Loops in micro-operations: exact bounds of counted loops, and random programs that never exceed their bounds."""

from __future__ import annotations

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from wcet.flow.assembler import Code, run

from mauve.wcet.binary.loops import loop_nest
from mauve.wcet.binary.microop import Compute, Condition, FlagKind, Imm, Load, Op, SetFlags, Store
from mauve.wcet.flow import effects, execute
from mauve.wcet.flow.function import FunctionResult, Limits, analyse_function
from mauve.wcet.flow.order import arrange
from mauve.wcet.flow.state import State, Symbols
from mauve.wcet.flow.transfer import NoImage

NOTHING_CALLED = effects.ProgramCalls({}, frozenset())


def analyse(code: Code, limits: Limits | None = None) -> FunctionResult:
    cfg = code.cfg()
    order = arrange(cfg, loop_nest(cfg))
    return analyse_function(order, State(Symbols()), NoImage(), NOTHING_CALLED, {}, None, limits or Limits(steps=3000))


def counted(start: int, limit: int, step: int, condition: Condition, tests_first: bool) -> Code:
    """for (r1 = start; r1 condition limit; r1 += step)"""
    code = Code()
    code.move(1, Imm(start & 0xFFFFFFFF))
    if tests_first:
        code.branch("test")
    code.label("body")
    code.compute(Op.ADD, 0, 0, 1)
    code.compute(Op.ADD, 1, 1, Imm(step & 0xFFFFFFFF))
    if tests_first:
        code.label("test")
    code.compare(1, Imm(limit & 0xFFFFFFFF))
    code.branch("body", condition)
    return code


@pytest.mark.parametrize(
    ("start", "limit", "step", "condition", "bodies"),
    [
        (0, 100, 1, Condition.LT, 100),
        (0, 100, 1, Condition.CC, 100),
        (0, 100, 1, Condition.NE, 100),
        (0, 100, 7, Condition.LT, 15),
        (0, 99, 3, Condition.LS, 34),
        (63, 0, -1, Condition.GE, 64),
        (63, -1, -1, Condition.GT, 64),
        (200, 100, -25, Condition.HI, 4),
        (-8, 8, 1, Condition.LT, 16),
        (-8, 8, 2, Condition.NE, 8),
        (0xFFFFFFF0, 0, 4, Condition.NE, 4),
        (0, 1000000, 1, Condition.LT, 1000000),
        (5, 5, 1, Condition.EQ, 1),
    ],
)
def test_counted_loops_are_exact(start, limit, step, condition, bodies):
    result = analyse(counted(start, limit, step, condition, tests_first=True))
    assert result.bounds[0].bound == bodies + 1
    if bodies > 1:
        result = analyse(counted(start, limit, step, condition, tests_first=False))
        assert result.bounds[0].bound == bodies


@pytest.mark.parametrize(
    ("start", "limit", "step", "condition"),
    [
        (0, 100, 0, Condition.LT),
        (0, 101, 2, Condition.NE),
        (0, 0xFFFFFFFF, 1, Condition.LS),
        (0, 0x7FFFFFFF, 1, Condition.LE),
        (100, 0, -1, Condition.CS),
    ],
)
def test_loops_that_never_end_have_no_bound(start, limit, step, condition):
    assert 0 in analyse(counted(start, limit, step, condition, tests_first=True)).unbounded


def test_a_bound_that_only_reflects_a_type_is_none():
    code = Code()
    code.move(1, Imm(0))
    code.label("body")
    code.compute(Op.ADD, 1, 1, Imm(1))
    code.compare(1, 2)
    code.branch("body", Condition.LT)
    assert 0 in analyse(code).unbounded


def test_a_counter_in_a_stack_slot_beside_an_array_that_is_filled():
    code = Code()
    code.store(Imm(0), -8)
    code.branch("test")
    code.label("body")
    code.load(3, -8)
    code.do(
        Compute(Op.SHL, 17, 3, Imm(2)),
        Compute(Op.ADD, 17, 13, 17),
        Compute(Op.SUB, 17, 17, Imm(136)),
        Store(17, 3),
    )
    code.compute(Op.ADD, 3, 3, Imm(1))
    code.store(3, -8)
    code.label("test")
    code.load(3, -8)
    code.compare(3, Imm(31))
    code.branch("body", Condition.LE)
    result = analyse(code)
    assert (result.bounds[0].bound, result.bounds[0].method) == (33, "affine")


def test_a_store_over_the_counter_takes_the_bound_away():
    code = Code()
    code.store(Imm(0), -8)
    code.branch("test")
    code.label("body")
    code.do(Compute(Op.SUB, 17, 13, Imm(8)), Compute(Op.ADD, 17, 17, 1), Store(17, Imm(0)))
    code.load(3, -8)
    code.compute(Op.ADD, 3, 3, Imm(1))
    code.store(3, -8)
    code.label("test")
    code.load(3, -8)
    code.compare(3, Imm(31))
    code.branch("body", Condition.LE)
    assert 0 in analyse(code).unbounded


def test_the_two_sides_of_a_clamp_are_kept_apart():
    """n = min(n, 28); if (n == 0) return; do ... while (--n): only path-sensitive analysis knows that n is not 0."""
    code = Code()
    code.compare(1, Imm(28))
    code.move(3, 1, Condition.CC)
    code.move(3, Imm(28), Condition.CS)
    code.compare(1, Imm(0))
    code.branch("end", Condition.EQ)
    code.label("body")
    code.do(SetFlags(FlagKind.SUB, 3, Imm(1)), Compute(Op.SUB, 3, 3, Imm(1)))
    code.branch("body", Condition.NE)
    code.label("end")
    assert analyse(code).bounds[0].bound == 28


def rest_of_two(check_first: bool) -> Code:
    """n = min(r4 - r5, 62) of two numbers loaded from memory; if (r4 != r5) do ... while (--n)"""
    code = Code()
    code.do(Load(4, 0), Load(5, 1))
    if check_first:
        code.do(SetFlags(FlagKind.SUB, 4, 5), Compute(Op.SUB, 3, 4, 5))
        code.branch("end", Condition.EQ)
    else:
        code.compute(Op.SUB, 3, 4, 5)
    code.compare(3, Imm(62))
    code.move(3, Imm(62), Condition.CS)
    if not check_first:
        code.compare(4, 5)
        code.branch("end", Condition.EQ)
    code.label("body")
    code.do(SetFlags(FlagKind.SUB, 3, Imm(1)), Compute(Op.SUB, 3, 3, Imm(1)))
    code.branch("body", Condition.NE)
    code.label("end")
    return code


@pytest.mark.parametrize("check_first", [False, True])
def test_a_count_that_is_the_difference_of_two_unknowns(check_first):
    assert analyse(rest_of_two(check_first)).bounds[0].bound == 62


def test_a_count_put_together_from_bytes():
    """n = low | high << 8, checked as such and used as a sum."""
    code = Code()
    code.do(Load(2, 0, 1), Load(3, 1, 1), Compute(Op.SHL, 3, 3, Imm(8)), Compute(Op.OR, 4, 2, 3))
    code.compare(4, Imm(48))
    code.branch("end", Condition.HI)
    code.do(Compute(Op.ADD, 4, 2, 3), Compute(Op.ADD, 4, 4, Imm(3)), Compute(Op.MOV, 5, Imm(0)))
    code.label("body")
    code.compute(Op.ADD, 5, 5, Imm(1))
    code.compare(4, 5)
    code.branch("body", Condition.NE)
    code.label("end")
    assert analyse(code).bounds[0].bound == 51


# ------------------------------------------------------------------------------------------------------ random programs
CONDITIONS = [c for c in Condition if c not in (Condition.AL, Condition.VS, Condition.VC)]
small = st.integers(-3, 12).map(lambda n: Imm(n & 0xFFFFFFFF))
data = st.one_of(st.integers(0, 5), small)


class Builder:
    """Draws a structured program: assignments, ifs, loops with counters and with breaks."""

    def __init__(self, draw) -> None:
        self.draw, self.code, self.labels = draw, Code(), 0

    def name(self) -> str:
        self.labels += 1
        return f"l{self.labels}"

    def block(self, depth: int, inside: str | None) -> None:
        for _ in range(self.draw(st.integers(1, 3))):
            self.statement(depth, inside)

    def statement(self, depth: int, inside: str | None) -> None:
        kind = self.draw(st.integers(0, 10))
        if kind <= 2:
            op = self.draw(st.sampled_from([Op.ADD, Op.SUB, Op.AND, Op.LSR, Op.SHL, Op.MUL, Op.OR, Op.XOR, Op.ASR]))
            self.code.compute(op, self.draw(st.integers(0, 5)), self.draw(st.integers(0, 5)), self.draw(data))
        elif kind == 3:
            self.code.store(self.draw(data), -4 * self.draw(st.integers(1, 4)))
        elif kind == 4:
            self.code.load(self.draw(st.integers(0, 5)), -4 * self.draw(st.integers(1, 4)))
        elif kind == 5:
            self.code.compare(self.draw(st.integers(0, 5)), self.draw(data))
            self.code.move(self.draw(st.integers(0, 5)), self.draw(data), self.draw(st.sampled_from(CONDITIONS)))
        elif kind == 6:
            size = self.draw(st.sampled_from([1, 2, 4]))
            self.code.do(Load(self.draw(st.integers(0, 5)), self.draw(st.integers(0, 5)), size))
        elif kind == 7:
            self.branch(depth, inside)
        elif kind == 10:
            self.clamp()
        elif depth < 3:
            self.loop(depth)

    def clamp(self) -> None:
        """min or max of a difference (or of bits put together) and a number; perhaps a look at one of the parts"""
        target, a, b = (self.draw(st.integers(0, 5)) for _ in range(3))
        limit = self.draw(small)
        self.code.compute(self.draw(st.sampled_from([Op.SUB, Op.SUB, Op.ADD, Op.OR])), target, a, b)
        self.code.compare(target, limit)
        self.code.move(target, limit, self.draw(st.sampled_from([Condition.CS, Condition.HI, Condition.GT])))
        if self.draw(st.booleans()):
            self.code.compare(a, b)
            self.code.move(a, self.draw(data), self.draw(st.sampled_from(CONDITIONS)))

    def branch(self, depth: int, inside: str | None) -> None:
        end = self.name()
        self.code.compare(self.draw(st.integers(0, 5)), self.draw(data))
        if inside is not None and self.draw(st.booleans()):
            self.code.branch(inside, self.draw(st.sampled_from(CONDITIONS)))
            return
        self.code.branch(end, self.draw(st.sampled_from(CONDITIONS)))
        self.block(depth, inside)
        self.code.label(end)

    def loop(self, depth: int) -> None:
        body, test, end = self.name(), self.name(), self.name()
        counter, step = self.draw(st.integers(0, 5)), self.draw(st.sampled_from([1, 1, 2, 3, -1, -2]))
        slot = self.draw(st.sampled_from([None, -4, -8, -20]))
        if self.draw(st.booleans()):
            self.code.move(counter, self.draw(small))
        if slot is not None:
            self.code.store(counter, slot)
        if self.draw(st.booleans()):
            self.code.branch(test)
        self.code.label(body)
        self.block(depth + 1, end)
        if slot is not None:
            self.code.load(counter, slot)
        self.code.compute(Op.ADD, counter, counter, Imm(step & 0xFFFFFFFF))
        if slot is not None:
            self.code.store(counter, slot)
        self.code.label(test)
        self.code.compare(counter, self.draw(data))
        self.code.branch(body, self.draw(st.sampled_from(CONDITIONS)))
        self.code.label(end)


@st.composite
def programs(draw):
    builder = Builder(draw)
    builder.block(0, None)
    builder.loop(0)
    return builder.code


def compare(code: Code, registers: list[int], seed: int, limits: Limits) -> None:
    cfg = code.cfg()
    nest = loop_nest(cfg)
    assume(not nest.irreducible)
    counts = run(cfg, nest, registers, lambda address: (address * seed + seed // 7) & 0xFF)
    result = analyse(code, limits)
    for loop, seen in counts.per_entry.items():
        bound = result.bounds.get(loop)
        assert bound is not None or loop in result.unbounded, "a loop that runs was called unreachable"
        assert bound is None or seen <= bound.bound, (loop, seen, bound)
        total = None if bound is None else bound.total
        assert total is None or counts.total[loop] <= total, (loop, counts.total[loop], bound)
    assert not counts.edges & result.infeasible


numbers = st.one_of(st.integers(-5, 30).map(lambda n: n & 0xFFFFFFFF), st.integers(0, 0xFFFFFFFF))


@settings(max_examples=60, deadline=None)
@given(programs(), st.lists(numbers, min_size=6, max_size=6), st.integers(0, 1000))
def test_random_programs_never_run_more_than_their_bounds(code, registers, seed):
    compare(code, registers, seed, Limits(steps=600))


def test_random_programs_whose_inner_loops_are_passed_roughly(monkeypatch):
    monkeypatch.setattr(execute, "SEARCHED", (0,))

    @settings(max_examples=25, deadline=None)
    @given(programs(), st.lists(numbers, min_size=6, max_size=6), st.integers(0, 1000))
    def check(code, registers, seed):
        compare(code, registers, seed, Limits(steps=0))

    check()


def nest(limits: list[int | None], start: int) -> Code:
    """Counters in stack slots, one loop inside the other; a limit None is the counter of the loop around it."""
    code = Code()
    for depth in range(len(limits)):
        code.store(Imm(start), -8 - 4 * depth)
        code.branch(f"test{depth}")
        code.label(f"body{depth}")
    for depth in reversed(range(len(limits))):
        code.load(3, -8 - 4 * depth)
        code.compute(Op.ADD, 3, 3, Imm(1))
        code.store(3, -8 - 4 * depth)
        code.label(f"test{depth}")
        code.load(3, -8 - 4 * depth)
        code.load(2, -4 - 4 * depth)
        given_limit = limits[depth]
        code.compare(3, 2 if given_limit is None else Imm(given_limit))
        code.branch(f"body{depth}", Condition.LE)
    return code


def test_a_nest_of_twelve_loops():
    result = analyse(nest([7, *[None] * 11], 0), Limits())
    assert [result.bounds[loop].bound for loop in range(12)] == [9] * 12


@pytest.mark.slow
@settings(max_examples=500, deadline=None)
@given(programs(), st.lists(numbers, min_size=6, max_size=6), st.integers(0, 1000))
def test_many_random_programs_never_run_more_than_their_bounds(code, registers, seed):
    compare(code, registers, seed, Limits(steps=600))
