"""Runs on unknown inputs: walks to ends that data decide, value by value and for all values at once."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from random import Random

import pytest

from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.flow.facts import AssumeFact, AtSymbol
from mauve.wcet.flow.program import RAN, Programs
from mauve.wcet.flow.result import ProgramFlow
from mauve.wcet.flow.run import machine, program
from mauve.wcet.flow.run.census import Measure, rank
from tests.emulator import Emulator
from tests.wcet.soundness.replay import Replay, record

WALKS = Path(__file__).parent / "walks"
IMAGES = {"arm7tdmi-O0": "arm7tdmi", "cortex-m3-O2": "cortex-m3"}
INPUTS = (
    AssumeFact(AtSymbol("text"), None, None, 0),
    AssumeFact(AtSymbol("length"), 0, 24, 1),
    AssumeFact(AtSymbol("samples"), None, None, 0),
    AssumeFact(AtSymbol("number"), None, None, 0),
)
NAMES = ("split", "measure", "reverse", "sort", "find", "drain", "records")


@cache
def image(name: str) -> Binary:
    found = load(WALKS / f"{name}.elf")
    assert isinstance(found, Binary)
    return found


def analysed(name: str, function: str) -> ProgramFlow:
    binary = image(name)
    return Programs(binary, INPUTS, initial_data=True).program(binary.function(function).key)


def replayed(name: str, function: str, flow: ProgramFlow) -> Replay:
    """Executions on random inputs beside what the analysis says."""
    emulator, replay = Emulator(WALKS / f"{name}.elf", IMAGES[name]), Replay(flow, ())
    for seed in range(12):
        random = Random(seed)
        emulator.reset()
        letters = b",,ab" if seed % 2 else bytes(range(256))
        for symbol, data in (
            ("text", bytes(random.choice(letters) for _ in range(24))),
            ("length", bytes([random.choice([0, 24, random.randrange(25)])])),
            ("samples", random.randbytes(40)),
            ("number", random.choice([b"\0" * 4, b"\xff" * 4, random.randbytes(4)])),
        ):
            emulator.write(emulator.by_name[symbol].address, data)
        replay.walk(record(emulator, function, []))
    return replay


@pytest.mark.parametrize("function", NAMES)
@pytest.mark.parametrize("name", IMAGES)
def test_each_loop_has_a_bound_that_no_input_exceeds(name: str, function: str) -> None:
    flow = analysed(name, function)
    assert not flow.problems and not any(found.problems for found in flow.functions.values())
    assert not replayed(name, function, flow).wrong
    mine = [found for found in flow.functions.values() if found.cfg.name == function]
    most = {"split": 25, "measure": 24, "reverse": 11, "sort": 20, "find": 21, "drain": 31, "records": 13}[function]
    assert all(bound.bound <= most for found in mine for bound in found.bounds.values())


@pytest.mark.parametrize("function", NAMES)
@pytest.mark.parametrize("name", IMAGES)
def test_what_is_short_of_time_follows_all_values_at_once(
    name: str, function: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(program, "STEPS", 300_000)
    flow = analysed(name, function)
    assert not replayed(name, function, flow).wrong
    assert any(found.bounds for found in flow.functions.values())


@pytest.mark.parametrize("function", ["find", "drain", "records", "names"])
def test_lists_and_pointers_that_move_with_a_count_have_bounds_all_values_at_once(
    function: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(machine, "UNHURRIED", 1 << 40)
    flow = analysed("cortex-m3-O2", function)
    assert not flow.problems and not any(found.problems for found in flow.functions.values())
    assert not replayed("cortex-m3-O2", function, flow).wrong
    assert all(bound.bound <= 40 for found in flow.functions.values() for bound in found.bounds.values())


def test_words_that_move_in_turn_have_a_bound(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine, "UNHURRIED", 1 << 40)
    binary = image("cortex-m3-O2")
    facts = (INPUTS[0], AssumeFact(AtSymbol("length"), 23, 24, 1))
    flow = Programs(binary, facts, initial_data=True).program(binary.function("nested").key)
    (mine,) = flow.functions.values()
    assert not mine.problems and mine.bounds and all(bound.bound <= 25 * 13 for bound in mine.bounds.values())


def test_ways_of_a_loop_are_ranked_one_word_after_the_other() -> None:
    counter, depth = Measure(10, ((-1, -1), (0, 0), (-2, -1))), Measure(4, ((0, 4), (-1, -1), (0, 0)))
    every = frozenset(range(3))
    assert rank((counter,), every) is None
    assert rank((counter, depth), every) == 10 + 11 * 4
    assert rank((counter,), frozenset((0, 2))) == 10
    assert rank((counter.turned(),), frozenset((0, 2))) == 10
    taking = Measure(8, ((-1, -1), (0, 0))), Measure(5, ((1, 1), (-1, -1)))
    assert rank(taking, frozenset((0, 1))) == 8 + 9 * 5
    meeting = Measure(20, ((3, 3), (-1, -1))), Measure(30, ((-4, -4), (0, 0)))
    assert rank(meeting, frozenset((0, 1))) == 7 + 8 * 20
    assert rank((Measure(9, ((1, 1), (-1, -1))), Measure(9, ((1, 2), (0, 0)))), frozenset((0, 1))) == 9 + 10 * 9
    assert rank((Measure(9, ((1, 1), (-2, -2))), Measure(9, ((-2, -2), (1, 1)))), frozenset((0, 1))) == 18


def test_what_the_last_iteration_does_that_is_followed_counts() -> None:
    """The iteration after which nothing new comes may be the first to pass some edges."""
    path = WALKS / "lexer-cortex-m3-O3.elf"
    binary = load(path)
    assert isinstance(binary, Binary)
    flow = Programs(binary).program(binary.function("run").key, 6)
    emulator, replay = Emulator(path, "cortex-m3"), Replay(flow, ())
    for seed in range(30):
        random = Random(seed)
        emulator.reset()
        letters = b'a1 "\\./' if seed % 2 else bytes(range(256))
        emulator.write(emulator.by_name["line"].address, bytes(random.choice(letters) for _ in range(65)))
        replay.walk(record(emulator, "run", []))
    assert not replay.wrong


@pytest.mark.parametrize("function", ["split", "measure"])
@pytest.mark.parametrize("name", IMAGES)
def test_what_may_start_in_any_state_is_run_from_unknown_data(name: str, function: str) -> None:
    binary = image(name)
    flow = Programs(binary, INPUTS).program(binary.function(function).key)
    assert not flow.problems and RAN not in flow.assumptions
    assert not replayed(name, function, flow).wrong
    (mine,) = (found for found in flow.functions.values() if found.cfg.name == function)
    assert mine.bounds and not mine.problems and all(bound.bound <= 25 for bound in mine.bounds.values())
