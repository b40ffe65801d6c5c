"""The emulator harness itself: counts are exact, arguments and results follow AAPCS, failures are reported."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import pytest
from emulator import EmulationError, Emulator, Int64, f32

FIXTURES = Path(__file__).parents[1] / "wcet" / "fixtures"
IMAGES = [
    ("arm7tdmi-arm-O0.elf", "arm7tdmi"),
    ("arm926ej-s-arm-O2.elf", "arm926ej-s"),
    ("arm7tdmi-thumb-O2.elf", "arm7tdmi"),
    ("cortex-m0-thumb-Os.elf", "cortex-m0"),
    ("cortex-m3-thumb-O2.elf", "cortex-m3"),
]


@pytest.fixture(params=IMAGES, ids=lambda image: image[0])
def emulator(request: pytest.FixtureRequest) -> Emulator:
    name, cpu = request.param
    return Emulator(FIXTURES / name, cpu)


def single_steps(emulator: Emulator, function: str, args: list[Any]) -> dict[int, int]:
    """Counts by a hook on every instruction: slow, and independent of how runs are cut."""
    from unicorn import UC_HOOK_CODE

    counts: dict[int, int] = {}

    def on_code(_uc: Any, address: int, _size: int, _: object) -> None:
        counts[address] = counts.get(address, 0) + 1

    hook = emulator._uc.hook_add(UC_HOOK_CODE, on_code)
    try:
        emulator.call(function, args)
    finally:
        emulator._uc.hook_del(hook)
    return counts


def test_counts_equal_single_steps(emulator: Emulator) -> None:
    """Conditional instructions, calls, library code and switches are counted as stepping counts them.

    Stepping does not see an instruction that an IT block skips; the harness counts it, since it is issued.
    """
    content = struct.pack("<100i", *(i * 37 % 101 - 50 for i in range(100)))
    table = emulator.alloc(content)
    calls: list[tuple[str, list[Any]]] = [
        ("sum", [table]),
        ("loop_triangular", [table]),
        ("conditional_execution", [3, 4, 5]),
        ("switch_wide", [11, 5, 6]),
        ("divide_64", [Int64(10**17), Int64(977)]),
        ("newton_root", [7.25]),
    ]
    for function, args in calls:
        execution = emulator.call(function, args)
        emulator.write(table, content)
        stepped = single_steps(emulator, function, args)
        emulator.write(table, content)
        if "thumb2_it_max" in emulator.by_name:
            assert set(stepped) <= set(execution.counts), function
            assert all(execution.counts[at] >= times for at, times in stepped.items()), function
        else:
            assert execution.counts == stepped, function
        assert execution.instructions == sum(execution.counts.values())


def test_results_and_arguments(emulator: Emulator) -> None:
    assert emulator.call("sum", [emulator.alloc(struct.pack("<100i", *range(100)))]).r0 == 4950
    assert emulator.call("leaf_sub", [1, 2]).signed == -9
    assert emulator.call("double_sub", [1.5, 4.0]).float64 == -2.5
    assert emulator.call("float_mul", [f32(1.5), f32(-3.0)]).float32 == -4.5
    assert emulator.call("divide_64_signed", [Int64(-(10**12)), Int64(7)]).int64 == -(10**12 // 7)
    assert emulator.call("multiply_accumulate_64", [Int64(5), 6, -7]).int64 == -37


def test_figure_2_at_o0_has_header_101_and_body_100() -> None:
    emulator = Emulator(FIXTURES / "arm7tdmi-arm-O0.elf", "arm7tdmi")
    execution = emulator.call("sum", [emulator.alloc(400)])
    assert sorted(set(execution.counts.values())) == [1, 100, 101]


def test_trace_lists_the_runs_in_order(emulator: Emulator) -> None:
    execution = emulator.call("tail_call", [1, 2], trace=True)
    assert execution.blocks[0][0] == emulator.by_name["tail_call"].address
    assert execution.r0 == 3
    deep = emulator.call("stack_array", [4], trace=True)
    assert deep.stack_bytes >= 96


def test_no_return_and_bad_access_are_errors(emulator: Emulator) -> None:
    with pytest.raises(EmulationError, match="no return"):
        emulator.call("spin_forever", [emulator.alloc(4)], max_instructions=10_000)
    with pytest.raises(EmulationError, match="sum"):
        emulator.call("sum", [0x9000_0000])


def test_reset_restores_the_image(emulator: Emulator) -> None:
    first = [emulator.call("filter_step", [sample]).r0 for sample in (5, 6, 7)]
    emulator.reset()
    assert [emulator.call("filter_step", [sample]).r0 for sample in (5, 6, 7)] == first
