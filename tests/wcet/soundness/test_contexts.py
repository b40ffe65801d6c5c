"""Contexts of functions called from many places and deep down: every call is held, whatever the limits on contexts."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest
from emulator import EmulationError, Emulator
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from wcet.soundness.machine_code import START, Symbol, branch, executable
from wcet.soundness.replay import Replay, record

from mauve.records import record as frozen
from mauve.wcet.analysis import analyse
from mauve.wcet.binary.elf import Binary, load_bytes
from mauve.wcet.flow.program import analyse_program
from mauve.wcet.hardware.board import Board
from mauve.wcet.hardware.core import load_core
from mauve.wcet.ipet.bottom_up import bound_program

BOARD = Board("bench", "arm7tdmi", 1_000_000)
PUSH, POP, KEEP, COUNT = 0xE92D_4030, 0xE8BD_8030, 0xE1A0_4000, 0xE1A0_5004
"""push {r4, r5, lr}; pop {r4, r5, pc}; mov r4, r0; mov r5, r4."""


@frozen
class Call:
    """A call of the function `callee` with `number`, or with the caller's own argument plus it."""

    callee: int
    number: int
    relative: bool


@frozen
class Function:
    """A function of one argument, which counts a loop as often as it says where it `loops`."""

    loops: bool
    calls: tuple[Call, ...]


def code(functions: list[Function]) -> tuple[list[int], list[Symbol]]:
    """The functions as A32 code; the first is `f`, and calls with its argument unchanged are unknown to it."""
    sizes = [4 + 3 * here.loops + 2 * len(here.calls) - 1 for here in functions]
    starts = [sum(sizes[:number]) for number in range(len(functions))]
    words: list[int] = []
    for here in functions:
        words += [PUSH, KEEP]
        if here.loops:
            words += [COUNT, 0xE255_5001, branch(len(words) + 2, len(words) + 1, condition=0xC)]  # subs; bgt
        for call in here.calls:
            words.append((0xE284_0000 if call.relative else 0xE3A0_0000) | call.number)
            words.append(branch(len(words), starts[call.callee], link=True))
        words.append(POP)
    places = enumerate(zip(starts, sizes, strict=True))
    return words, [(f"c{n}" if n else "f", START + 4 * at, 4 * size) for n, (at, size) in places]


def image(functions: list[Function]) -> bytes:
    return executable(*code(functions))


def loaded(functions: list[Function]) -> Binary:
    found = load_bytes(image(functions), "f.elf")
    assert isinstance(found, Binary), found
    return found


def passing(length: int) -> list[Function]:
    """Functions that pass their argument on, and a loop at the end."""
    calls = [Function(False, (Call(number + 1, 0, True),)) for number in range(length)]
    return [*calls, Function(True, ())]


@pytest.mark.parametrize("length", [3, 20, 200])
def test_an_argument_is_known_at_the_end_of_a_long_chain(length: int) -> None:
    functions = [Function(False, (Call(1, 17, False),)), *(shifted(here, 1) for here in passing(length))]
    (found,) = analyse(loaded(functions), ["f"], BOARD, timeout=60)
    (loop,) = found.loops
    assert found.bounded
    assert loop.bound == 17


def shifted(here: Function, by: int) -> Function:
    return Function(here.loops, tuple(Call(call.callee + by, call.number, call.relative) for call in here.calls))


def test_calls_that_share_a_context_are_all_in_it() -> None:
    """More values than contexts are kept apart for, deep down: the bound is that of the greatest."""
    calls = tuple(Call(1, number, False) for number in (3, 90, *range(4, 60)))
    functions = [Function(False, calls), *(shifted(here, 1) for here in passing(15))]
    (found,) = analyse(loaded(functions), ["f"], BOARD, timeout=60)
    assert found.bounded
    assert max(loop.bound or 0 for loop in found.loops) == 90


def test_a_call_with_an_unknown_argument_is_not_lost_among_the_others() -> None:
    functions = [Function(False, (Call(1, 3, False), Call(1, 0, True), Call(1, 5, False)))]
    functions += [shifted(here, 1) for here in passing(30)]
    (found,) = analyse(loaded(functions), ["f"], BOARD, timeout=60)
    assert not found.bounded or any((loop.bound or 0) >= 1 << 31 for loop in found.loops)


def test_a_wide_pyramid_of_calls_takes_little(tmp_path: Path) -> None:
    """Each function calls the next two layers' functions twice: 2^18 ways to the loop at the bottom."""
    functions = [
        Function(number == 18, () if number == 18 else (Call(number + 1, 1, True), Call(number + 1, 2, True)))
        for number in range(19)
    ]
    functions = [Function(False, (Call(1, 0, False),)), *(shifted(here, 1) for here in functions)]
    (found,) = analyse(loaded(functions), ["f"], BOARD, timeout=60)
    assert found.bounded
    assert max(loop.bound or 0 for loop in found.loops) == 36


@st.composite
def programs(draw: st.DrawFn) -> list[Function]:
    """A few functions, each of which calls some that come later; the first one passes numbers only."""
    count = draw(st.integers(3, 18))
    functions = []
    for number in range(count):
        later = st.integers(number + 1, min(count - 1, number + 3))
        call = st.builds(Call, later, st.integers(0, 6), st.booleans() if number else st.just(False))
        calls = draw(st.lists(call, max_size=2)) if number + 1 < count else []
        if number + 1 < count and draw(st.integers(0, 3)):
            calls = [*calls, Call(number + 1, draw(st.integers(0, 2)), number > 0)]
        functions.append(Function(draw(st.booleans()), tuple(calls[:3])))
    return functions


@settings(max_examples=6, deadline=None)
@given(functions=programs())
def test_what_runs_is_in_the_contexts(functions: list[Function], tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.mktemp("contexts") / "f.elf"
    path.write_bytes(image(functions))
    binary = loaded(functions)
    flow = analyse_program(binary, START)
    core = load_core(BOARD.core)
    assert core is not None
    bounds = bound_program(flow, core, BOARD)
    try:
        run = record(Emulator(path, "arm7tdmi"), "f", [2], most=200_000)
    except EmulationError:  # calls that branch at every level take too long to be followed
        reject()
    replay = Replay(flow, (bounds,))
    cycles = replay.walk(run)
    assert not replay.wrong
    assert cycles is not None
    bound = bounds[flow.entry].cycles
    assert functions[0].loops or bound is not None
    assert bound is None or cycles[0] <= bound


def test_the_layers_of_a_test_program_are_what_they_say() -> None:
    words, symbols = code([Function(True, (Call(1, 3, True),)), Function(False, ())])
    assert len(words) == sum(size for _, _, size in symbols) // 4
    assert all(after[1] == before[1] + before[2] for before, after in pairwise(symbols))
