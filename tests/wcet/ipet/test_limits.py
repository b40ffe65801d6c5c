"""Limits of edges: how often one execution of the function passes them at most."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest

from mauve.wcet.binary.graph import EXIT
from mauve.wcet.ipet.problem import PathProblem, PathSolution
from mauve.wcet.ipet.program import format_program, violated
from mauve.wcet.ipet.solve import Method, solve
from mauve.wcet.ipet.structural import solve_structural
from tests.wcet.ipet.graphs import Structured, longest_by_search, nest_of


def with_random_limits(problem: PathProblem, random: Random, share: float) -> PathProblem:
    """Limits that some path keeps: the counts of one or two solutions with other costs, the greater of each."""
    found: list[PathSolution] = []
    for _ in range(random.randint(1, 2)):
        other = solve_structural(replace(problem, costs=tuple(random.randrange(5) for _ in problem.costs)))
        assert other is not None
        found.append(other)
    limits = {
        edge: max(solution.counts[edge] for solution in found)
        for edge in range(len(problem.edges))
        if random.random() < share
    }
    return replace(problem, limits=limits)


@pytest.mark.parametrize("seed", range(60))
def test_limits_are_never_below_the_longest_path_and_equal_pulp(seed: int) -> None:
    random = Random(seed)
    problem = Structured(random).problem(depth=3, largest_bound=3)
    problem = with_random_limits(problem, random, random.choice((0.1, 0.5, 1.0)))
    solution, structural = solve(problem), solve(problem, Method.STRUCTURAL)
    assert solution is not None and structural is not None and solution.cycles <= structural.cycles
    longest = longest_by_search(problem, limit=20_000)
    if longest is not None:
        assert solution.cycles >= longest
    if solution.attained:
        assert violated(problem, solution.counts) == ()
        assert sum(n * c for n, c in zip(solution.counts, problem.costs, strict=True)) == solution.cycles
    ilp = solve(problem, Method.ILP)
    assert ilp is not None
    if ilp.attained and solution.attained:
        assert ilp.cycles == solution.cycles
    assert solution.cycles <= ilp.cycles


def test_the_counts_of_one_run_are_its_cost_without_a_linear_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("mauve.wcet.ipet.model.solve_ilp", lambda problem: pytest.fail("PuLP was asked"))
    problem = Structured(Random(5)).problem(depth=4)
    run = solve_structural(replace(problem, costs=tuple(index % 3 for index in range(len(problem.edges)))))
    assert run is not None
    solution = solve(replace(problem, limits=dict(enumerate(run.counts))))
    assert solution is not None and solution.attained and solution.counts == run.counts
    assert solution.cycles == sum(n * c for n, c in zip(run.counts, problem.costs, strict=True))


def test_one_limit_needs_no_linear_program(monkeypatch: pytest.MonkeyPatch) -> None:
    """The dear arm of a loop's body is taken 3 times of 9, the cheap one the other times."""
    monkeypatch.setattr("mauve.wcet.ipet.model.solve_ilp", lambda problem: pytest.fail("PuLP was asked"))
    solution = solve(replace(arms(10, 100, 7), limits={0: 3}))
    assert solution is not None and solution.attained
    assert solution.cycles == 3 * 100 + 6 * 7 + 1
    assert solution.counts[:2] == (3, 6)


def arms(bound: int, dear: int, cheap: int) -> PathProblem:
    """A loop whose body is one of two blocks."""
    edges = [(0, 1), (0, 2), (1, 0), (2, 0), (0, EXIT)]
    nest = nest_of(3, 0, edges)
    assert nest is not None
    return PathProblem(3, 0, tuple(edges), (dear, cheap, 0, 0, 1), nest, {0: bound})


def test_limits_are_bounds_of_the_program_that_is_written() -> None:
    text = format_program(replace(arms(4, 5, 2), limits={0: 3, 1: 2}))
    assert "\nBounds\n x_b0_b1 <= 3\n x_b0_b2 <= 2\nGeneral\n" in text
