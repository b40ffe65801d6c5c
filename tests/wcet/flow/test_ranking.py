"""Ranking arguments: what the fixtures' comments promise is proven, and no execution exceeds a bound."""

from __future__ import annotations

import random
import re
import struct
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import pytest

from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import LoopNest, loop_nest
from mauve.wcet.flow.locations import Cell, NoValues
from mauve.wcet.flow.ranking import RankBound, bound_by_ranking
from tests.emulator import EmulationError, Emulator

FIXTURES = Path(__file__).resolve().parents[1] / "fixtures"


@dataclass(frozen=True, slots=True)
class Literals(NoValues):
    """Nothing is known but literal pools."""

    binary: Binary

    def constant(self, cell: Cell) -> int | None:
        data = self.binary.read_constant(cell.offset, cell.size)
        return None if data is None else int.from_bytes(data, "little")


@cache
def image(name: str) -> Binary:
    binary = load(FIXTURES / name)
    assert isinstance(binary, Binary)
    return binary


def ranked(name: str, function: str) -> tuple[Cfg, LoopNest, list[RankBound | None]]:
    binary = image(name)
    cfg = build_cfg(binary, binary.function(function).key)
    nest = loop_nest(cfg)
    return cfg, nest, [bound_by_ranking(cfg, nest, loop, Literals(binary)) for loop in nest.loops]


O0, O2 = "arm7tdmi-arm-O0.elf", "arm7tdmi-arm-O2.elf"


@pytest.mark.parametrize(
    ("name", "function", "bounds"),
    [
        (O0, "sum", [101]),
        (O2, "sum", [100]),
        (O0, "loop_nested", [9, 13]),
        (O2, "loop_nested", [8, 12]),
        (O0, "loop_down_signed", [65]),
        (O0, "loop_step_up", [15]),
        (O0, "loop_ne", [17]),
        (O0, "loop_two_indices", [21]),
        (O2, "loop_variable_step", [50]),
        (O2, "loop_rejected", [50]),
        (O2, "loop_clamped", [60]),
        (O0, "loop_uint8_counter", [256]),
        (O0, "binary_search", [8]),
        (O0, "clear_lowest_bit", [33]),
        (O0, "shift_count_bits", [33]),
        (O2, "list_sum_budget", [12]),
        (O2, "__udivsi3", [8, 31, 8]),
    ],
)
def test_bounds_of_the_fixtures(name: str, function: str, bounds: list[int]) -> None:
    _, _, found = ranked(name, function)
    assert [b.bound if b is not None else None for b in found] == bounds


@pytest.mark.parametrize("function", ["sum_range", "list_sum", "string_length", "wait_for_flag", "spin_forever"])
@pytest.mark.parametrize("name", [O0, O2])
def test_no_bound_where_none_follows_from_the_code(name: str, function: str) -> None:
    assert ranked(name, function)[2] == [None]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "cpu"),
    [
        (O0, "arm7tdmi"),
        (O2, "arm7tdmi"),
        ("cortex-m0-thumb-Os.elf", "cortex-m0"),
        ("cortex-m3-thumb-O2.elf", "cortex-m3"),
    ],
)
def test_no_execution_exceeds_a_bound(name: str, cpu: str) -> None:
    """Outermost loops run with random arguments: executions of the header, entered once per call at most."""
    emulator = Emulator(FIXTURES / name, cpu)
    rng = random.Random(7)
    table = emulator.alloc(struct.pack("<256I", *(rng.getrandbits(rng.choice((1, 4, 8, 32))) for _ in range(256))))
    checked = 0
    for function in image(name).function_names():
        if not re.fullmatch("loop_.*|binary_.*|shift_.*|clear_.*|crc.*|parse_.*|insertion_.*|__u?divsi3", function):
            continue
        cfg, nest, bounds = ranked(name, function)
        for _ in range(20):
            first = rng.getrandbits(32) if function.startswith("__") else table
            arguments = [first, *(rng.getrandbits(rng.randint(1, 32)) for _ in range(3))]
            try:
                run = emulator.call(function, arguments, max_instructions=50_000)
            except EmulationError:
                continue
            for loop, bound in zip(nest.loops, bounds, strict=True):
                if bound is not None and loop.depth == 1:
                    assert run.counts.get(cfg.blocks[loop.header].address, 0) <= bound.bound, (function, arguments)
                    checked += 1
    assert checked > 200
