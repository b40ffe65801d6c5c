"""What facts assume of arguments and memory bounds the loops that depend on it, and is told in the result."""

from __future__ import annotations

from pathlib import Path

import pytest

from mauve.wcet.analysis import analyse
from mauve.wcet.flow.facts import Argument, AssumeFact, AtAddress, AtSymbol
from mauve.wcet.hardware.board import Board
from mauve.wcet.hardware.memory import Memory
from mauve.wcet.result import ProblemKind, WcetResult

IMAGES = Path(__file__).parent / "assumed"
CORES = pytest.mark.parametrize("core", ["arm7tdmi", "cortex-m3"])


def bound(core: str, function: str, *facts: AssumeFact, initial_data: bool = False) -> WcetResult:
    board = Board("test", core, 100_000_000, (Memory("all", 0, 1 << 32, 0, 0),), ())
    return analyse(IMAGES / f"{core}.elf", [function], board, facts, initial_data=initial_data)[0]


def headers(result: WcetResult) -> list[int | None]:
    return [loop.bound for loop in result.loops]


@CORES
@pytest.mark.parametrize(
    ("function", "fact", "times"),
    [
        ("in_register", AssumeFact(Argument("in_register", 2), 0, 20), 20),
        ("in_register", AssumeFact(Argument("in_register", 2), -7, -1), 0),
        ("on_stack", AssumeFact(Argument("on_stack", 5), -3, 7), 7),
        ("global", AssumeFact(AtSymbol("length"), 0, 9), 9),
        ("element", AssumeFact(AtSymbol("offsets"), -5, 6, 2), 6),
        ("byte", AssumeFact(AtSymbol("levels"), 0, 30, 1), 30),
    ],
)
def test_an_assumed_range_bounds_the_loop_that_counts_to_it(
    core: str, function: str, fact: AssumeFact, times: int
) -> None:
    result = bound(core, function, fact)
    # Loops that test first run their header once more; where no iteration is left the loop is not entered.
    assert result.bounded
    assert headers(result) in ([times], [times + 1], [None])
    assert any(f"is within {fact.low} to {fact.high}" in sentence for sentence in result.assumptions)


@pytest.mark.parametrize("function", ["in_register", "byte"])
def test_without_a_fact_the_loop_has_no_bound_or_that_of_its_type(function: str) -> None:
    without = bound("cortex-m3", function)
    assert not without.bounded or max(h or 0 for h in headers(without)) >= 255


@CORES
def test_initial_data_starts_with_linked_values_except_where_a_fact_speaks(core: str) -> None:
    linked = bound(core, "global", initial_data=True)
    wider = bound(core, "global", AssumeFact(AtSymbol("length"), 0, 11), initial_data=True)
    assert linked.bounded and wider.bounded
    assert max(h or 0 for h in headers(linked)) in (5, 6)
    assert max(h or 0 for h in headers(wider)) in (11, 12)
    unknown = bound(core, "byte", AssumeFact(AtSymbol("levels")), initial_data=True)
    assert max(h or 0 for h in headers(unknown)) in (255, 256)
    assert "`levels` is unknown" in unknown.assumptions


@CORES
def test_a_call_that_breaks_an_assumption_is_a_contradiction(core: str) -> None:
    result = bound(core, "calls_with_nine", AssumeFact(Argument("callee", 1), 0, 8))
    assert not result.bounded
    assert ProblemKind.FACT_CONTRADICTED in {problem.kind for problem in result.problems}


@pytest.mark.parametrize(
    ("fact", "message"),
    [
        (AssumeFact(AtSymbol("nowhere"), 0, 1), "there is no object `nowhere` in the binary"),
        (AssumeFact(Argument("nowhere", 1), 0, 1), "there is no function `nowhere` in the binary"),
        (AssumeFact(AtSymbol("levels"), 0, 1), "say how large its elements are"),
        (AssumeFact(AtSymbol("levels"), 0, 256, 1), "does not fit into 1 byte"),
        (AssumeFact(Argument("callee", 1), 0, 1 << 32), "does not fit into 32 bits"),
        (AssumeFact(AtAddress(0x20000000)), "is not known"),
    ],
)
def test_an_assumption_that_cannot_be_placed_is_told(fact: AssumeFact, message: str) -> None:
    result = bound("arm7tdmi", "global", fact, initial_data=True)
    notes = [note for note in result.notes if note.kind is ProblemKind.FACT_NOWHERE]
    assert len(notes) == 1
    assert message in notes[0].message
