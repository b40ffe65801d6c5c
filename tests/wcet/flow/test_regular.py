"""Calls that pass no subnormal operands: the helper's loops over these are left out there, and nowhere else."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest

from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.flow.facts import Argument, AssumeFact
from mauve.wcet.flow.program import analyse_program
from mauve.wcet.flow.regular import WORDS, regular_routines
from mauve.wcet.flow.result import ProgramFlow
from mauve.wcet.hardware.board import Board, Memory
from mauve.wcet.hardware.core import load_core
from mauve.wcet.ipet.bottom_up import bound_program
from tests.emulator import Emulator

IMAGES = Path(__file__).parent / "images"
CASES = [("logarithm-arm7tdmi", "arm7tdmi"), ("logarithm-cortex-m3", "cortex-m3")]


@cache
def analysed(image: str) -> ProgramFlow:
    binary = load(IMAGES / f"{image}.elf")
    assert isinstance(binary, Binary)
    return analyse_program(binary, binary.function("logarithm").key)  # type: ignore[union-attr]


@pytest.mark.parametrize(("image", "cpu"), CASES)
def test_only_the_calls_that_are_proven_leave_the_loops_out(image: str, cpu: str) -> None:
    program = analysed(image)
    assert not program.problems and not any(flow.problems for flow in program.functions.values())
    inside = next(flow for flow in program.functions.values() if flow.cfg.name == "__ieee754_log")
    called = {name for callees in inside.calls.values() for _, name in callees}
    assert called == {"", WORDS}
    core = load_core(cpu)
    assert core is not None
    bounds = bound_program(program, core, Board("desk", cpu, 1_000_000, (Memory("all", 0, 1 << 32, 0, 0),), ()))
    helper = {key[1]: bounds[key].cycles for key in bounds if program.functions[key].cfg.name == "__aeabi_dmul"}
    assert helper[WORDS] is not None and helper[""] is not None and 3 * helper[WORDS] < helper[""]


@pytest.mark.parametrize(("image", "cpu"), CASES)
def test_a_subnormal_argument_is_normalised_once(image: str, cpu: str) -> None:
    program = analysed(image)
    helper = next(f for key, f in program.functions.items() if f.cfg.name == "__aeabi_dmul" and key[1] == WORDS)
    plain = next(f for key, f in program.functions.items() if f.cfg.name == "__aeabi_dmul" and key[1] == "")
    closed = helper.infeasible - plain.infeasible
    headers = {helper.cfg.blocks[helper.cfg.edges[index].target].address for index in closed}
    assert len(headers) == 2
    emulator = Emulator(IMAGES / f"{image}.elf", cpu)
    for words, most in (((1, 0), 52), ((0, 0x0008_0000), 1), ((0, 0x0010_0000), 0), ((0, 0x3FF8_0000), 0), ((0, 0), 0)):
        run = emulator.call("logarithm", list(words))
        assert sum(run.counts.get(header, 0) for header in headers) == most


def test_an_angle_of_known_size_is_not_reduced_as_a_large_one() -> None:
    """The upper word of a double says how large it is: 0x40590000 is that of 100."""
    binary = load(IMAGES / "angle-cortex-m3.elf")
    assert isinstance(binary, Binary)
    key = binary.function("angle").key  # type: ignore[union-attr]
    program = analyse_program(binary, key, facts=(AssumeFact(Argument("angle", 2), 0, 0x40590000),))
    assert not any(flow.problems for flow in program.functions.values())
    names = {flow.cfg.name for flow in program.functions.values()}
    assert "__ieee754_rem_pio2" in names and "__kernel_rem_pio2" not in names


def test_the_table_is_complete() -> None:
    known = regular_routines().values()
    names = {name for one in known for name in one.names}
    assert {"__kernel_sin", "__kernel_cos", "__kernel_tan", "__kernel_rem_pio2", "__ieee754_rem_pio2"} <= names
    assert {"__ieee754_exp", "__ieee754_log", "__ieee754_pow", "atan"} <= names
    for one in known:
        assert one.proof and one.found
        assert len(one.but) == {"__ieee754_log": 1, "__ieee754_pow": 19}.get(one.names[0], 0)
