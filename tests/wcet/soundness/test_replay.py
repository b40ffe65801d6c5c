"""The oracle itself: a wrong statement about an execution is found."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from emulator import Emulator
from wcet.fixtures.cases import FOLDER
from wcet.soundness.replay import Recording, Replay, record

from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.flow.program import analyse_program
from mauve.wcet.flow.result import AddressRange, FunctionFlow, LoopBound, ProgramFlow
from mauve.wcet.result import Origin

ELF: Path = FOLDER / "arm7tdmi-arm-O2.elf"


def program(function: str) -> ProgramFlow:
    binary = load(ELF)
    assert isinstance(binary, Binary)
    return analyse_program(binary, binary.function(function).key)


def execution(function: str, *arguments: int) -> Recording:
    emulator = Emulator(ELF, "arm7tdmi")
    return record(emulator, function, arguments or [emulator.alloc(400)])


def changed(flow: ProgramFlow, **changes: object) -> ProgramFlow:
    entry: FunctionFlow = replace(flow.functions[flow.entry], **changes)  # type: ignore[arg-type]
    return replace(flow, functions={**flow.functions, flow.entry: entry})


def complaints(flow: ProgramFlow, run: Recording) -> list[str]:
    replay = Replay(flow, ())
    replay.walk(run)
    return replay.wrong


def test_a_correct_analysis_is_accepted() -> None:
    assert complaints(program("sum"), execution("sum")) == []


def test_a_bound_one_too_small_is_found() -> None:
    flow = changed(program("sum"), bounds={0: LoopBound(99, Origin.ANALYSIS, "")})
    assert "ran 100 times, bound 99" in complaints(flow, execution("sum"))[0]


def test_a_total_one_too_small_is_found() -> None:
    flow = changed(program("sum"), bounds={0: LoopBound(100, Origin.ANALYSIS, "", 99)})
    assert "ran 100 times in all, total 99" in complaints(flow, execution("sum"))[0]


def test_an_edge_called_infeasible_is_found() -> None:
    flow = program("sum")
    (back,) = flow.functions[flow.entry].nest.loops[0].back_edges
    assert "is called infeasible" in complaints(changed(flow, infeasible=frozenset({back})), execution("sum"))[0]


def test_an_access_outside_its_range_is_found() -> None:
    flow = program("sum")
    cfg = flow.functions[flow.entry].cfg
    places = [(i.address, k) for b in cfg.blocks for i in b.instructions for k in range(len(i.ops))]
    wrong = complaints(changed(flow, accesses=dict.fromkeys(places, AddressRange(0, 3))), execution("sum"))
    assert "touches 0x50000000, said to stay in 0x0..0x3" in wrong[0]


def test_an_execution_of_something_else_is_found() -> None:
    assert "expected" in complaints(program("sum"), execution("absolute_sum"))[0]
