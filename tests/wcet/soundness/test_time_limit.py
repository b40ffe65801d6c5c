"""The time that a function may take holds for every phase of its analysis, and ends none of the next function's."""

from __future__ import annotations

import time

import pytest
from wcet.soundness.machine_code import BX_LR, NOP, START, branch, executable, nest

from mauve.wcet import clock
from mauve.wcet.analysis import analyse
from mauve.wcet.binary.elf import Binary, load_bytes
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import ProblemKind

BOARD = Board("bench", "arm7tdmi", 1_000_000)
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
