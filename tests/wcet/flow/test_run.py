"""Runs from the linked data: exactly what an emulator executes, and every way that unknown values leave open."""

from __future__ import annotations

import struct
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.wcet.binary.elf import Binary, Segment, load
from mauve.wcet.binary.microop import Shift
from mauve.wcet.flow import program
from mauve.wcet.flow.domain import TOP
from mauve.wcet.flow.program import Programs
from mauve.wcet.flow.result import FunctionFlow, ProgramFlow
from mauve.wcet.flow.run import flags, words
from mauve.wcet.flow.run.covering import merge
from mauve.wcet.flow.run.memory import Lost, Memory
from mauve.wcet.flow.run.words import MASK, UNKNOWN, Low, Some, Stack, Undecided, range_of
from mauve.wcet.hardware.board import Board
from mauve.wcet.hardware.core import load_core
from mauve.wcet.ipet.bottom_up import bound_program
from tests.emulator import Emulator
from tests.wcet.soundness.replay import Replay, record

WHOLE = Path(__file__).parent / "whole"
DEVICE = 0x7000_1000
IMAGES = {
    "arm7tdmi-O0": "arm7tdmi",
    "arm7tdmi-O2": "arm7tdmi",
    "cortex-m0-Os": "cortex-m0",
    "cortex-m3-O2": "cortex-m3",
    "cortex-m4f-O0": "cortex-m4f",
    "cortex-m4f-O2": "cortex-m4f",
}


@cache
def ran(image: str) -> ProgramFlow:
    binary = load(WHOLE / f"{image}.elf")
    assert isinstance(binary, Binary)
    return Programs(binary, initial_data=True).program(binary.function("main").key)


@pytest.mark.parametrize("image", IMAGES)
def test_every_loop_that_runs_has_the_bound_that_is_reached(image: str) -> None:
    """Greatest counts over what a device may answer; contexts of a function together, as an emulator sees them."""
    flow = ran(image)
    assert program.RAN in flow.assumptions
    bounds: dict[int, int] = {}
    for (_, _), function in flow.functions.items():
        for index, bound in function.bounds.items():
            header = function.cfg.blocks[function.nest.loops[index].header].address
            if not function.cfg.name.startswith("__"):  # of a division of unknown numbers any number of steps may come
                bounds[header] = max(bounds.get(header, 0), bound.bound)
    assert len(bounds) > 8
    emulator = Emulator(WHOLE / f"{image}.elf", IMAGES[image])
    seen: dict[int, int] = dict.fromkeys(bounds, 0)
    for answer in (0, 1, 2, 3, 4, 5, 6):
        emulator.reset()
        if answer == 0:
            emulator._uc.mem_map(DEVICE & -0x1000, 0x1000)
        emulator._uc.mem_write(DEVICE, struct.pack("<I", answer))
        replay = _collapsed(flow)
        replay.walk(record(emulator, "main", []))
        assert not replay.wrong
        for (name, index), (most, _) in replay.seen.items():
            function = replay.program.functions[name]
            header = function.cfg.blocks[function.nest.loops[index].header].address
            assert most <= function.bounds[index].bound
            if header in seen:
                seen[header] = max(seen[header], most)
    assert seen == bounds


def _collapsed(flow: ProgramFlow) -> Replay:
    """A replay that takes the contexts of a function for one (an emulator does not tell them apart)."""
    merged: dict[tuple[int, str], FunctionFlow] = {}
    for (key, _), function in flow.functions.items():
        before = merged.get((key, ""), function)
        bounds = {k: max(b, before.bounds.get(k, b), key=lambda x: x.bound) for k, b in function.bounds.items()}
        merged[key, ""] = replace(
            function,
            bounds={**before.bounds, **bounds},
            infeasible=before.infeasible & function.infeasible,
            edge_limits={},
            calls={e: tuple((k, "") for k in edge.callees) for e, edge in enumerate(function.cfg.edges)},
        )
    return Replay(replace(flow, functions=merged, entry=(flow.entry[0], "")), ())


@pytest.mark.parametrize("image", IMAGES)
def test_the_bound_covers_the_longest_execution(image: str) -> None:
    flow, cpu = ran(image), IMAGES[image]
    core, board = load_core(cpu), Board("ideal", cpu, 1_000_000)
    assert core is not None
    bounds = bound_program(flow, core, board)
    assert bounds[flow.entry].cycles is not None


def test_recursion_has_a_depth() -> None:
    contexts = [key for key, f in ran("arm7tdmi-O0").functions.items() if f.cfg.name == "fibonacci"]
    assert len(contexts) == 7  # one per argument from 7 on down; 1 and 0 behave alike


def test_after_a_store_through_an_unknown_pointer_nothing_is_known() -> None:
    """`sort` entered with unknown arguments writes anywhere."""
    binary = load(WHOLE / "arm7tdmi-O0.elf")
    assert isinstance(binary, Binary)
    flow = Programs(binary, initial_data=True).program(binary.function("sort").key, 6)
    (mine,) = flow.functions.values()
    assert not mine.bounds and len(mine.problems) == 2


# ------------------------------------------------------------------------------------------------------------ values
numbers = st.integers(0, MASK) | st.sampled_from([0, 1, 7, 0x7FFF_FFFF, 0x8000_0000, MASK])


@given(st.integers(-64, 64), st.integers(0, 15), st.integers(0, 31))
def test_addresses_in_the_stack_compute_like_numbers(offset: int, number: int, amount: int) -> None:
    """With any base that is a multiple of 8, what is known of a result is what the numbers give."""
    for base in (0x2000_0000, 0x2000_0FF8):
        address, real = Stack(offset), base + offset
        assert (address + number) - Stack(0) == offset + number
        assert (address & 7) == real & 7
        shifted = (address << amount) & MASK if amount >= 29 else None
        assert shifted is None or shifted == (real << amount) & MASK
        assert (((address | number) & 3) == (real | number) & 3) and (((address ^ number) & 7) == (real ^ number) & 7)
        assert (address > 0) and address != 0 and (address == Stack(offset))


def test_what_depends_on_an_unknown_is_undecided() -> None:
    for condition in (lambda: UNKNOWN == 3, lambda: UNKNOWN < 3, lambda: bool(UNKNOWN & 4), lambda: Stack(0) == 9):
        with pytest.raises(Undecided):
            condition()
    assert (UNKNOWN & 0) == 0 and (UNKNOWN + 3) is UNKNOWN and range_of(merge(UNKNOWN, 3)) == TOP and merge(3, 3) == 3
    assert type((Stack(4) | 9) & MASK) is Low and (Stack(4) | 1) == Stack(5) and (Stack(5) ^ 7) == Stack(2)


@settings(max_examples=200, deadline=None)
@given(numbers, numbers, st.integers(0, 1))
def test_flags_are_those_of_the_manual(a: int, b: int, carry: int) -> None:
    def of(total: int, signed_total: int) -> tuple[int, int, int, int]:
        word = total & MASK
        return word >> 31, int(word == 0), int(total > MASK), int(words.signed(word) != signed_total)

    s = words.signed
    assert flags.of_sum_with_carry(a, b, carry) == of(a + b + carry, s(a) + s(b) + carry)
    assert flags.of_difference(a, b) == of(a + (b ^ MASK) + 1, s(a) - s(b))
    assert flags.of_difference_with_borrow(a, b, carry) == of(a + (b ^ MASK) + carry, s(a) + s(b ^ MASK) + carry)
    assert flags.carry_out(Shift.LSR, a, 3, 0) == a >> 2 & 1


def test_a_word_between_two_segments_has_the_bytes_of_both() -> None:
    """And a byte that no segment holds is unknown, not zero; what is written to the word stays."""
    whole = load(WHOLE / "cortex-m3-O2.elf")
    assert isinstance(whole, Binary)
    first = Segment(0x100, 6, b"abcdef", False, True)
    second = Segment(0x106, 4, b"gh", False, False)
    third = Segment(0x202, 3, b"xyz", True, False)
    memory = Memory(replace(whole, segments=(first, second, third)), True)
    site = memory.site()
    assert memory.load(0x104, site) == int.from_bytes(b"efgh", "little")
    assert [memory.load_byte(address, site) for address in (0x108, 0x109)] == [0, 0]
    assert all(type(memory.load_byte(address, site)) is Some for address in (0x10A, 0x201))
    assert range_of(memory.load(0x108, site)).unsigned_bounds() == (0, 0xFFFF_0000)
    assert memory.load_byte(0x202, site) == ord("x")
    memory.store_byte(0x202, 7, site)
    assert memory.load_byte(0x202, site) == 7 and memory.load_byte(0x203, site) == ord("y")
    with pytest.raises(Lost):
        memory.store_byte(0x106, 7, site)
