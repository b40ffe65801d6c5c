"""The time that a function may take holds for every phase of its analysis, and ends none of the next function's."""

from __future__ import annotations

import time

import pytest
from wcet.soundness.machine_code import BX_LR, NOP, START, branch, executable, nest

from mauve.wcet import clock
from mauve.wcet.analysis import analyse
from mauve.wcet.binary.cfg import Control
from mauve.wcet.binary.elf import Binary, load_bytes
from mauve.wcet.flow.function import Limits
from mauve.wcet.flow.functions import Functions
from mauve.wcet.flow.given import Given
from mauve.wcet.flow.image import NoImage
from mauve.wcet.flow.program import Programs
from mauve.wcet.flow.state import State
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import ProblemKind

BOARD = Board("bench", "arm7tdmi", 1_000_000)
MOV_R1_20, SUBS_R1_1, MOV_R2_7, SUBS_R2_1 = 0xE3A0_1014, 0xE251_1001, 0xE3A0_2007, 0xE252_2001
LONG = 50_000
"""Instructions: the decoder alone takes longer than the time allowed here."""


def image(words: list[int]) -> Binary:
    """A function `f`, and behind it a short one, `g`."""
    loaded = load_bytes(executable([*words, NOP, BX_LR], [("f", START, 0), ("g", START + 4 * len(words), 8)]), "f.elf")
    assert isinstance(loaded, Binary), loaded
    return loaded


def test_a_long_function_ends_when_its_time_is_over() -> None:
    binary = image([NOP] * LONG + [BX_LR])
    (alone,) = analyse(binary, ["g"], BOARD)
    started = time.process_time()
    long, short = analyse(binary, ["f", "g"], BOARD, timeout=0.3)
    assert time.process_time() - started < 2
    (problem,) = long.problems
    assert problem.kind is ProblemKind.LIMIT
    assert problem.address is not None and START <= problem.address < START + 4 * LONG
    assert problem.message == "the analysis of f takes longer than the 0.3 s that it may take"
    assert short.cycles == alone.cycles == 1 + 3


@pytest.mark.parametrize("ticks", [1, 30, 100, 200, 300, 400, 500, 700, 1000, 2000, 4000])
def test_time_may_end_anywhere(ticks: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whichever look at the clock finds the time over: a bound, or the reason and where; another attempt has the bound
    that it would have had without the first."""
    left = iter(range(ticks))
    words = [NOP] * 300 + nest(2, 3)[:-1] + [branch(0, 4, condition=1)] + [NOP] * 300 + [BX_LR]
    binary = image(words)
    (bound,) = analyse(binary, ["f"], BOARD)
    over = False

    def counted() -> float:
        nonlocal over
        over = over or next(left, None) is None
        return 1e9 if over else 0.0

    with monkeypatch.context() as patched:
        patched.setattr(clock, "monotonic", counted)
        (found,) = analyse(binary, ["f"], BOARD, timeout=1e6)
    if ticks == 1:
        assert not found.bounded
    assert found.cycles == bound.cycles or found.problems[0].kind is ProblemKind.LIMIT
    assert all(problem.address is not None for problem in found.problems)


@pytest.mark.parametrize("ticks", [1, 20, 60, 150, 400])
def test_what_was_found_stays_when_time_is_over(ticks: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Time ends the search for values; what is left of it suffices for loops that count between constants."""
    binary = image([*nest(2, 3)[:-1], BX_LR])
    whole = Programs(binary).program(START)
    left = iter(range(ticks))

    def counted() -> float:
        return time.monotonic() + (0.0 if next(left, None) is not None else 900_000)

    with monkeypatch.context() as patched:
        patched.setattr(clock, "monotonic", counted)
        found = Programs(binary).program(START, 1e6)
    if not found.functions:
        assert found.problems[0].kind is ProblemKind.LIMIT
        return
    (flow,), (other,) = found.functions.values(), whole.functions.values()
    missing = {problem.address for problem in flow.problems if problem.kind is ProblemKind.LOOP}
    for loop in flow.nest.loops:
        bound = flow.bounds.get(loop.id)
        assert bound is not None or flow.cfg.blocks[loop.header].address in missing
        assert bound is None or bound.bound >= other.bounds[loop.id].bound
    assert not missing or found.problems[0].kind is ProblemKind.LIMIT


def test_a_function_without_values_keeps_its_counters() -> None:
    """Time is over before the first pass: each loop is looked at alone."""
    words = [MOV_R1_20, SUBS_R1_1, branch(2, 1, condition=1), MOV_R2_7, SUBS_R2_1, branch(5, 4, condition=1), BX_LR]
    functions = Functions(image(words), NoImage(), Control(), Given(image(words), ()), Limits())
    functions.settle(START, None)
    functions.leaving, functions.limits = time.monotonic() + 1e6, Limits(deadline=time.monotonic() - 1)
    late = functions.analyse((START, ()), State(functions.symbols), True)
    assert functions.curtailed is not None and late.targets is None
    assert [bound.bound for bound in late.flow.bounds.values()] == [20, 7]
    functions.leaving = None
    with pytest.raises(clock.OutOfTime):
        functions.analyse((START, ()), State(functions.symbols), True)
