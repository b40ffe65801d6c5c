"""Distances between values through loops and joins: indices that several loops move, and loops left when two meet."""

from __future__ import annotations

from wcet.flow.assembler import Code

from mauve.wcet.binary.loops import loop_nest
from mauve.wcet.binary.microop import Condition, Imm, Load, Op
from mauve.wcet.flow import anchors, domain, effects, linear
from mauve.wcet.flow.function import FunctionResult, Limits, analyse_function
from mauve.wcet.flow.joining import join
from mauve.wcet.flow.order import arrange
from mauve.wcet.flow.state import State, Symbols
from mauve.wcet.flow.transfer import NoImage

NOTHING_CALLED = effects.ProgramCalls({}, frozenset())


def analyse(code: Code) -> FunctionResult:
    cfg = code.cfg()
    entry = State(Symbols())
    entry.require(entry.regs[0], 1, 40)
    return analyse_function(
        arrange(cfg, loop_nest(cfg)), entry, NoImage(), NOTHING_CALLED, {}, None, Limits(steps=2000), thorough=False
    )


def words(inner_exit: Condition) -> Code:
    """i = 0; do { do { i++; if (i inner_exit n) return; } while (*p++ != 0); } while (i < n), with n in r0."""
    code = Code()
    code.move(1, Imm(0))
    code.label("word")
    code.label("letter")
    code.compute(Op.ADD, 1, 1, Imm(1))
    code.compare(1, 0)
    code.branch("end", inner_exit)
    code.do(Load(3, 2, 1))
    code.compute(Op.ADD, 2, 2, Imm(1))
    code.compare(3, Imm(0))
    code.branch("letter", Condition.NE)
    code.compute(Op.ADD, 4, 4, Imm(1))
    code.compare(1, 0)
    code.branch("word", Condition.CC)
    code.label("end")
    code.move(5, Imm(0))
    return code


def test_an_index_that_two_loops_move_bounds_both() -> None:
    for leave in (Condition.EQ, Condition.CS):
        result = analyse(words(leave))
        assert not result.unbounded
        assert all(39 <= bound.bound <= 41 for bound in result.bounds.values())


def test_an_index_that_may_pass_its_limit_bounds_nothing() -> None:
    code = words(Condition.EQ)
    index = next(i for i, (_, ops, _) in enumerate(code.lines) if i and ops and getattr(ops[0], "dst", 0) == 1)
    when, (step,), target = code.lines[index]
    code.lines[index] = (when, (type(step)(step.op, 1, 1, Imm(2)),), target)
    assert analyse(code).unbounded


def test_a_join_keeps_how_far_a_value_is_from_what_both_know() -> None:
    first = State(Symbols())
    base = linear.of_symbol(linear.entry_symbol(0))
    second = first.copy()
    first.regs[1] = linear.add(base, first.fresh(domain.between(0, 9)))
    second.regs[1] = linear.add(base, second.fresh(domain.between(20, 30)))
    both = join(first, second)
    distance = both.range_of(linear.sub(both.regs[1], base))
    assert distance.unsigned_bounds() == (0, 30)


def test_a_compare_is_remembered_as_a_distance_where_no_end_of_a_range_tells_it() -> None:
    state = State(Symbols())
    a, b = state.fresh(domain.between(0, 100)), state.fresh(domain.between(0, 100))
    assert state._assume_less(a, b, 1, False)
    assert state.range_of(linear.sub(b, a)).unsigned_bounds() == (1, 100)
    assert anchors.reached(state, b) == {*linear.symbols(a), *linear.symbols(b)}
