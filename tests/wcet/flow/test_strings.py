"""Where strings end: as a state knows it, as facts assume it, and as the library's routines need it."""

from __future__ import annotations

import random
from functools import cache
from pathlib import Path

import pytest

from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.flow import joining
from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.effects import enter
from mauve.wcet.flow.facts import Argument, AssumeFact, AtSymbol, Fact
from mauve.wcet.flow.image import NoImage
from mauve.wcet.flow.linear import entry_symbol, of_symbol
from mauve.wcet.flow.program import analyse_program
from mauve.wcet.flow.result import ProgramFlow
from mauve.wcet.flow.state import State, Symbols
from mauve.wcet.flow.strings import ending, longest
from tests.emulator import Emulator

IMAGE = Path(__file__).parent / "images" / "strings-cortex-m3.elf"
POINTER = of_symbol(entry_symbol(0))
OTHER = of_symbol(entry_symbol(1))


def at(offset: int, base: object = POINTER) -> tuple[int, int, int]:
    assert isinstance(base, tuple)
    return (offset, base[1], 1)


def length(state: State, offset: int = 0, base: object = POINTER) -> int | None:
    return longest(state, at(offset, base), NoImage())


def test_what_is_assumed_holds_inside_the_bytes() -> None:
    state = State(Symbols())
    assert length(state) is None
    ending(state, 1, 80)
    assert [length(state, offset) for offset in (0, 1, 79)] == [80, 79, 1]
    assert length(state, 80) is None and length(state, -1 & 0xFFFFFFFF) is None and length(state, 0, OTHER) is None


def test_a_zero_in_memory_ends_a_string() -> None:
    state = State(Symbols())
    state.store(at(11), 0, 1)
    assert [length(state, offset) for offset in (0, 11)] == [12, 1] and length(state, 12) is None
    state.store(at(4), 0x00410000, 4)
    assert length(state) == 5
    state.store(at(4), 0x41414141, 4)
    assert length(state) == 12
    state.store(OTHER, 0, 4)
    assert length(state) is None


@pytest.mark.parametrize(("value", "kept"), [(0, True), (1, False), (None, False)])
def test_only_zeros_may_be_written_into_the_string(value: int | None, kept: bool) -> None:
    for offset in (3, 200):
        state = State(Symbols())
        ending(state, 1, 80)
        read = state.load(at(8), 4, False, NoImage())
        assert length(state) == 80 and read is not None
        state.store(at(offset), value, 1)
        assert (length(state) == 80 or (offset == 3 and length(state) == 4)) is kept
        again = State(Symbols())
        ending(again, 1, 80)
        again.store(at(3), 7, 1)
        again.store(at(3), 7, 1)
        assert length(again) is None


def test_a_store_anywhere_else_ends_what_is_known() -> None:
    state = State(Symbols())
    ending(state, 1, 80)
    state.store(OTHER, 0, 1)
    assert length(state) is None


def test_the_callee_knows_the_rest_of_the_string() -> None:
    state = State(Symbols())
    ending(state, 1, 80)
    state.regs[1] = at(10)
    inside = enter(state)
    assert longest(inside, inside.regs[1], NoImage()) == 70
    state.regs[1] = at(80)
    assert longest(enter(state), of_symbol(entry_symbol(1)), NoImage()) is None


def test_of_two_states_the_longer_string_counts() -> None:
    first, second = State(Symbols()), State(Symbols())
    ending(first, 1, 80)
    ending(second, 1, 20)
    assert length(joining.join(first, second)) == 80
    assert length(joining.join(first, State(Symbols()))) is None


def test_an_argument_with_a_range_is_assumed_to_be_a_pointer() -> None:
    state = State(Symbols())
    state.ranges[entry_symbol(0)] = Range(0x20000000, 1, 40)
    ending(state, 1, 16)
    assert longest(state, state.regs[0], NoImage()) == 16


# ------------------------------------------------------------------------------------------------------------ programs
@cache
def binary() -> Binary:
    found = load(IMAGE)
    assert isinstance(found, Binary)
    return found


def analysed(function: str, *facts: Fact) -> ProgramFlow:
    return analyse_program(binary(), binary().function(function).key, facts=facts)  # type: ignore[union-attr]


def ends(function: str, slot: int, size: int) -> AssumeFact:
    return AssumeFact(Argument(function, slot), ends=size)


def is_bounded(flow: ProgramFlow) -> bool:
    return not flow.problems and not any(one.problems for one in flow.functions.values())


@pytest.mark.parametrize(
    ("function", "facts"),
    [
        ("parse", (ends("parse", 1, 80),)),
        ("copies", (ends("strcpy", 2, 64), ends("strcmp", 1, 32))),
        ("keeps", (ends("keeps", 1, 80),)),
        ("keeps", ()),
        ("appends", (ends("appends", 1, 80), ends("strcat", 2, 8))),
        ("local", ()),
        ("global", (AssumeFact(AtSymbol("name", 31), 0, 0, 1),)),
    ],
)  # fmt: skip
def test_functions_that_go_through_strings_are_bounded(function: str, facts: tuple[Fact, ...]) -> None:
    assert is_bounded(analysed(function, *facts))


@pytest.mark.parametrize(
    ("function", "facts"),
    [
        ("breaks", (ends("breaks", 1, 80),)),
        ("appends", (ends("appends", 2, 64),)),
        ("global", (AssumeFact(AtSymbol("name", 31), 0, 1, 1),)),
        ("global", (AssumeFact(AtSymbol("name", 31), 1, 1, 1),)),
    ],
)  # fmt: skip
def test_without_the_fact_there_is_no_bound(function: str, facts: tuple[Fact, ...]) -> None:
    assert not is_bounded(analysed(function, *facts))


def test_a_fact_says_what_it_assumes_and_where_it_cannot_be() -> None:
    flow = analysed("keeps", ends("keeps", 1, 80))
    assert "argument 1 of `keeps` points to 80 bytes, and a string that begins in them ends in them" in flow.assumptions
    assert any("on the stack" in note.message for note in analysed("keeps", ends("keeps", 5, 80)).notes)


def test_no_routine_runs_longer_than_the_table_says() -> None:
    emulator, rng = Emulator(IMAGE, "cortex-m3"), random.Random(5)
    first, second = emulator.alloc(256), emulator.alloc(256)
    flows = {
        name: analysed(name, *(ends(name, slot, 64) for slot in slots)).functions[binary().function(name).key, ""]  # type: ignore[union-attr]
        for name, slots in (("strlen", (1,)), ("strcmp", (2,)), ("strcpy", (2,)))
    }
    assert all(set(flow.bounds) == {loop.id for loop in flow.nest.loops} for flow in flows.values())
    for turn in range(60):
        size, where = (63 if turn < 16 else rng.randrange(64)), (turn % 4, rng.randrange(4))
        for place, shift in zip((first, second), where, strict=True):
            emulator.write(place + shift, b"a" * size + b"\0" + b"b" * 8)
        for name, flow in flows.items():
            run = emulator.call(name, [first + where[0], second + where[1]])
            for loop, bound in flow.bounds.items():
                header = flow.cfg.blocks[flow.nest.loops[loop].header].address
                assert run.counts.get(header, 0) <= bound.bound, (name, size, where)
