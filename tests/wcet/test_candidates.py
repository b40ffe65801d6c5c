"""Calls through pointers of which nothing is known: no bound, but all that they may lead to is in the result."""

from __future__ import annotations

from dataclasses import replace

import pytest

from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.graph import Unresolved, UnresolvedKind
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.flow import candidates
from mauve.wcet.flow.facts import AtAddress, AtSymbol, ControlFact, ControlKind
from mauve.wcet.flow.program import Programs
from mauve.wcet.flow.result import FunctionFlow
from mauve.wcet.hardware.board import Board
from mauve.wcet.hardware.core import load_core
from mauve.wcet.ipet.bottom_up import bound_program, calls_of, unresolved
from mauve.wcet.result import ProblemKind
from tests.wcet.programs import image

LEAVES = ("leaf_add", "leaf_sub", "leaf_mix", "leaf_max")


@pytest.mark.parametrize("name", ("arm7tdmi-arm-O1", "cortex-m0-thumb-Os", "cortex-m3-thumb-O2"))
@pytest.mark.parametrize("function", ("call_through_pointer", "tail_call_through_pointer"))
def test_candidates_are_analysed_and_named(name: str, function: str) -> None:
    binary = image(f"{name}.elf")
    program = Programs(binary).program(binary.function(function).key)  # type: ignore[union-attr]
    named = {flow.cfg.name for flow in program.functions.values()}
    assert named >= {function, *LEAVES}
    top = program.functions[program.entry]
    (problem,) = top.problems
    assert problem.kind in (ProblemKind.CALL, ProblemKind.BRANCH)
    assert "its targets are not known; " in problem.message or "targets that are not known; " in problem.message
    assert "functions have their address taken (" in problem.message
    assert all(f'"{leaf}"' in problem.suggestions[0] for leaf in LEAVES)
    assert {program.functions[key].cfg.name for _, key in calls_of(top)} >= set(LEAVES)
    core = load_core("cortex-m3")
    assert core is not None
    bound = bound_program(program, core, Board("bench", "cortex-m3", 1))[program.entry]
    assert bound.cycles is None and bound.stack is None, "unknown is never zero"


def test_stated_targets_leave_nothing_open() -> None:
    binary = image("arm7tdmi-arm-O1.elf")
    symbol = binary.function("call_through_pointer")
    (problem,) = Programs(binary).program(symbol.key).functions[symbol.key, ""].problems  # type: ignore[union-attr]
    fact = ControlFact(ControlKind.TARGETS, AtAddress(problem.address or 0), tuple(map(AtSymbol, LEAVES[:2])))
    program = Programs(binary, [fact]).program(symbol.key)  # type: ignore[union-attr]
    assert not program.functions[program.entry].problems
    assert {flow.cfg.name for flow in program.functions.values()} == {symbol.name, *LEAVES[:2]}  # type: ignore[union-attr]


def test_too_many_candidates_are_only_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(candidates, "MOST", 2)
    monkeypatch.setattr("mauve.wcet.flow.program.MOST_CANDIDATES", 2)
    binary = image("arm7tdmi-arm-O1.elf")
    program = Programs(binary).program(binary.function("call_through_pointer").key)  # type: ignore[union-attr]
    (flow,) = program.functions.values()
    assert flow.problems[0].message.endswith(" functions, too many to look at") and not flow.problems[0].suggestions


def test_every_kind_of_hole_is_a_problem() -> None:
    binary = image("arm7tdmi-arm-O2.elf")
    cfg = build_cfg(binary, binary.function("switch_wide").key)  # type: ignore[union-attr]
    for kind in UnresolvedKind:
        hole = Unresolved(cfg.address, kind, "a hole")
        flow = FunctionFlow(replace(cfg, unresolved=(hole,)), LoopNest(()), {}, frozenset(), {}, {})
        (problem,) = unresolved(flow)
        assert (problem.message, problem.address) == ("a hole", cfg.address)
