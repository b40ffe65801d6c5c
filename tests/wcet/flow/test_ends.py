"""Walks to the ends of strings, without a run: what is known of an end bounds them, and nothing else does."""

from __future__ import annotations

from functools import cache
from pathlib import Path
from random import Random

import pytest

from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.loops import Loop
from mauve.wcet.flow.function import _confirmed
from mauve.wcet.flow.program import Programs
from mauve.wcet.flow.record import Record
from mauve.wcet.flow.result import LoopBound, ProgramFlow
from tests.emulator import Emulator
from tests.wcet.soundness.replay import Replay, record

ENDS = Path(__file__).parent / "ends"
A32, T32 = "arm7tdmi-O0", "cortex-m3-O2"
STRING = "end of a string"


@cache
def analysed(name: str, function: str) -> tuple[ProgramFlow, tuple[LoopBound | None, ...]]:
    """The result without a run, from any data, and the bounds of the function's own loops, innermost last."""
    binary = load(ENDS / f"{name}.elf")
    assert isinstance(binary, Binary)
    flow = Programs(binary).without_run(binary.function(function).key)
    (mine,) = (found for found in flow.functions.values() if found.cfg.name == function)
    return flow, tuple(mine.bounds.get(loop.id) for loop in mine.nest.loops)


@pytest.mark.parametrize(
    ("name", "function", "bounds"),
    [
        (A32, "digits", [24, 24]),
        (T32, "digits", [23, None]),
        (A32, "unescape", [24]),
        (T32, "unescape", [23]),
    ],
)
def test_a_walk_ends_where_the_string_does(name: str, function: str, bounds: list[int | None]) -> None:
    _, found = analysed(name, function)
    assert [bound and bound.bound for bound in found] == bounds
    assert all(bound.method == STRING for bound in found if bound is not None)


@pytest.mark.parametrize("name", [A32, T32])
def test_the_length_of_a_string_bounds_what_counts_to_it(name: str) -> None:
    flow, found = analysed(name, "pairs")
    assert not flow.problems and all(bound is not None and bound.bound <= 24 for bound in found)


@pytest.mark.parametrize("function", ["hasty", "restored", "erased", "overrun"])
@pytest.mark.parametrize("name", [A32, T32])
def test_no_end_is_taken_for_granted_that_may_be_missed(name: str, function: str) -> None:
    _, (*_, bound) = analysed(name, function)
    assert bound is not None and bound.method != STRING and bound.bound > 24


@pytest.mark.parametrize("function", ["digits", "unescape", "pairs", "hasty", "restored", "erased", "overrun"])
@pytest.mark.parametrize("name", [A32, T32])
def test_no_execution_exceeds_a_bound(name: str, function: str) -> None:
    flow, _ = analysed(name, function)
    emulator, replay = Emulator(ENDS / f"{name}.elf", name.rpartition("-")[0]), Replay(flow, ())
    for seed in range(12):
        random = Random(seed)
        emulator.reset()
        letters = (b"\\\\a", b"1234567890", b"    1", bytes(range(256)))[seed % 4]
        emulator.write(emulator.by_name["text"].address, bytes(random.choice(letters) for _ in range(24)))
        replay.walk(record(emulator, function, []))
    assert not replay.wrong and replay.seen


def test_guesses_hold_together_or_not_at_all() -> None:
    """The second loop's guess is proven only as long as the third's is taken for granted, which is not proven."""
    nest = [Loop(number, number, frozenset({number}), (), (), None, 1) for number in range(3)]
    tried = []

    def execute(guessed: dict[int, int]) -> Record:
        tried.append(dict(guessed))
        return Record(visits=dict(guessed))

    def ranking(loop: Loop, values: Record) -> tuple[int, str] | None:
        proven = loop.id == 0 or (loop.id == 1 and 2 in values.visits)
        return (4 - loop.id, "counter") if proven else None

    confirmed = _confirmed({0: 4, 1: 9, 2: 5}, nest, ranking, execute)
    assert confirmed is not None and {loop: bound.bound for loop, bound in confirmed[1].items()} == {0: 4}
    assert tried == [{0: 4, 1: 9, 2: 5}, {0: 4, 1: 9}, {0: 4}]
    assert _confirmed({1: 9}, nest, ranking, execute) is None
    assert _confirmed({0: 3}, nest, ranking, execute) is None
