"""Recursions: bounded where known arguments lead to their end, or by a fact; else an error that names the way round."""

from __future__ import annotations

from pathlib import Path

import pytest

from mauve.wcet.analysis import analyse
from mauve.wcet.flow.facts import Argument, AssumeFact, AtLine, AtSymbol, Counting, Fact, LoopFact, RecursionFact
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import ProblemKind, WcetResult
from tests.wcet.reference import Tracer, bus_cycles

IMAGE = Path(__file__).parent / "recursion" / "arm7tdmi.elf"
BOARD = Board("bench", "arm7tdmi", 100_000_000)
IN_LINE = next(
    n for n, text in enumerate((IMAGE.parent / "recursion.c").read_text().splitlines(), 1) if "for (int" in text
)
SORTING: tuple[Fact, ...] = (
    LoopFact(AtLine("recursion.c", IN_LINE), 15, Counting.BODY),
    RecursionFact(AtSymbol("quicksort"), 16),
)


def bound(function: str, *facts: Fact) -> WcetResult:
    return analyse(IMAGE, [function], BOARD, facts)[0]


def executed(function: str, *arguments: int) -> int:
    tracer = Tracer(IMAGE, "arm7tdmi")
    return bus_cycles(tracer.run(function, arguments), BOARD)


@pytest.mark.parametrize(
    ("function", "exact"),
    [("factorial_of_9", False), ("fibonacci_of_8", True), ("even_of_11", True), ("whole_tree", True)],
)
def test_known_arguments_lead_to_the_end_of_a_recursion(function: str, exact: bool) -> None:
    result, longest = bound(function), executed(function)
    assert result.cycles is not None
    # A multiplication takes its longest time.
    assert longest <= result.cycles <= longest * (1 if exact else 2)
    assert result.stack is not None and result.stack > 0


@pytest.mark.parametrize(("function", "most"), [("factorial", 12), ("fibonacci", 9)])
def test_arguments_in_a_range_lead_to_the_end_of_a_recursion(function: str, most: int) -> None:
    """Each call has fewer numbers left than the one that made it."""
    result = bound(function, AssumeFact(Argument(function, 1), 0, most))
    assert result.cycles is not None and result.stack is not None
    assert max(executed(function, number) for number in (0, 1, 2, most)) <= result.cycles


@pytest.mark.parametrize(("function", "arguments", "depth"), [("factorial", (6,), 6), ("fibonacci", (7,), 7)])
def test_a_fact_bounds_the_activations_under_way(function: str, arguments: tuple[int, ...], depth: int) -> None:
    result = bound(function, RecursionFact(AtSymbol(function), depth))
    assert result.cycles is not None
    assert executed(function, *arguments) <= result.cycles
    deeper = bound(function, RecursionFact(AtSymbol(function), depth + 1))
    assert deeper.cycles is not None and deeper.cycles > result.cycles
    assert result.stack is not None and deeper.stack is not None and deeper.stack > result.stack


def test_a_fact_on_one_function_bounds_the_way_round_two() -> None:
    result = bound("even", RecursionFact(AtSymbol("odd"), 4))
    assert result.cycles is not None and executed("even", 8) <= result.cycles


def test_a_sort_needs_a_fact_for_its_loop_and_one_for_its_depth() -> None:
    result = bound("sorted", *SORTING)
    assert result.cycles is not None and executed("sorted") <= result.cycles
    assert [(loop.bound, loop.context) for loop in result.loops] == [(16, "")] or len(result.loops) == 1


@pytest.mark.parametrize("function", ["factorial", "sorted"])
def test_a_recursion_without_an_end_in_sight_is_named(function: str) -> None:
    result = bound(function)
    assert not result.bounded
    (problem,) = [p for p in result.problems if p.kind is ProblemKind.RECURSION]
    name = "quicksort" if function == "sorted" else function
    assert problem.message == f"recursion: {name} -> {name}"


def test_a_way_round_is_told_in_the_order_of_its_calls() -> None:
    (problem,) = bound("even").problems
    assert problem.message in ("recursion: even -> odd -> even", "recursion: odd -> even -> odd")


def test_a_fact_about_no_function_is_told() -> None:
    result = bound("whole_tree", RecursionFact(AtSymbol("nowhere"), 4))
    assert [note.message for note in result.notes] == ["there is no function at `nowhere`"]


def test_more_contexts_than_can_be_kept_are_a_limit() -> None:
    result = bound("factorial", RecursionFact(AtSymbol("factorial"), 10**9))
    assert [problem.kind for problem in result.problems] == [ProblemKind.LIMIT]
