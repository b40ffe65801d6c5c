"""The linear program: the same optimum by PuLP, proven bounds from any multipliers, totals, and its text."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.wcet.ipet.model import solve_ilp
from mauve.wcet.ipet.problem import PathProblem
from mauve.wcet.ipet.program import dual_bound, format_program, rows, violated
from mauve.wcet.ipet.solve import Method, solve
from mauve.wcet.ipet.structural import solve_structural
from tests.wcet.ipet.graphs import Structured, longest_by_search, nested, random_problem


def sample(seed: int) -> PathProblem:
    random = Random(seed)
    problem = random_problem(random, random.randint(2, 9), random.randint(0, 9)) if seed % 2 else None
    return problem or Structured(random).problem(depth=3)


def with_random_totals(problem: PathProblem, random: Random) -> PathProblem:
    """Totals that some path keeps: executions of one solution with other costs."""
    other = solve_structural(replace(problem, costs=tuple(random.randrange(5) for _ in problem.costs)))
    assert other is not None
    totals = {}
    for index, loop in enumerate(problem.nest.loops):
        passed = zip(other.counts, problem.edges, strict=True)
        into = sum(count for count, (_, target) in passed if target == loop.header)
        if random.random() < 0.6:
            totals[index] = max(1, into + int(loop.header == problem.entry))
    return replace(problem, totals=totals)


@pytest.mark.parametrize("seed", range(120))
def test_structural_equals_pulp(seed: int) -> None:
    problem = sample(seed)
    structural = solve_structural(problem)
    assert structural is not None
    ilp = solve_ilp(problem)
    assert ilp is not None
    assert ilp.value == structural.cycles
    certified = solve(problem, Method.ILP)
    assert certified is not None and certified.cycles == structural.cycles and certified.attained


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 2**32), multipliers=st.lists(st.fractions(-100, 100, max_denominator=9), min_size=60))
def test_any_multipliers_prove_a_bound(seed: int, multipliers: list[Fraction]) -> None:
    problem = with_random_totals(sample(seed), Random(seed))
    structural = solve_structural(replace(problem, totals={}))
    cut = solve(problem)
    assert structural is not None and cut is not None
    given_rows = (multipliers * 4)[: len(rows(problem))]
    if cut.attained:
        assert dual_bound(problem, given_rows) >= cut.cycles
    free = replace(problem, totals={})
    assert dual_bound(free, given_rows[: len(rows(free))]) >= structural.cycles


@pytest.mark.parametrize("seed", range(60))
def test_totals_are_never_below_the_longest_path_and_rarely_above(seed: int) -> None:
    random = Random(seed)
    problem = with_random_totals(Structured(random).problem(depth=3, largest_bound=3), random)
    solution = solve(problem)
    assert solution is not None
    structural = solve_structural(problem)
    assert structural is not None and solution.cycles <= structural.cycles
    longest = longest_by_search(problem, limit=30_000)
    if longest is not None:
        assert solution.cycles >= longest
    if solution.attained:
        assert violated(problem, solution.counts) == ()
        assert sum(n * c for n, c in zip(solution.counts, problem.costs, strict=True)) == solution.cycles
    ilp = solve(problem, Method.ILP)
    assert ilp is not None
    if ilp.attained and solution.attained:
        assert ilp.cycles == solution.cycles


def test_a_triangular_nest_costs_its_total() -> None:
    """for i in 0..9, for j in 0..i: the inner header runs 11 times per entry at most, 65 times in all."""
    problem = nested(depth=2, bound=11, cost=1)
    square = solve(problem)
    triangle = solve(replace(problem, totals={1: 65}))
    assert square is not None and triangle is not None
    assert square.cycles == 10 * (2 + 10 * 2) + 1
    assert triangle.cycles == 10 * 2 + (65 - 10) * 2 + 1
    assert triangle.attained
    assert sum(triangle.counts) == triangle.cycles


def test_a_total_below_what_every_path_needs_is_not_used() -> None:
    problem = nested(depth=1, bound=5, cost=1)
    solution = solve(replace(problem, totals={0: 0}))
    plain = solve(problem)
    assert solution is not None and plain is not None
    assert solution.cycles == plain.cycles


def test_a_float_solver_never_lowers_the_bound() -> None:
    """Counts near 1e10: the optimum of a float solver can lie below the true one, the certified bound must not."""
    problem = nested(depth=6, bound=50, cost=7)
    exact = solve(problem, Method.STRUCTURAL)
    certified = solve(problem, Method.ILP)
    assert exact is not None and certified is not None
    assert certified.cycles == exact.cycles


def test_program_prints_as_an_lp_file() -> None:
    assert format_program(replace(nested(depth=1, bound=4, cost=2), totals={0: 9})) == (
        "Maximize\n"
        " cycles: 2 x_b0_b1 + 2 x_b1_b0 + 2 x_b0_exit\n"
        "Subject To\n"
        " block_0: - x_b0_b1 + x_b1_b0 - x_b0_exit = -1\n"
        " block_1: x_b0_b1 - x_b1_b0 = 0\n"
        " loop_0: x_b1_b0 <= 3\n"
        " total_0: x_b1_b0 <= 8\n"
        "General\n"
        " x_b0_b1 x_b1_b0 x_b0_exit\n"
        "End\n"
    )


def test_one_total_that_matters_needs_no_linear_program(monkeypatch: pytest.MonkeyPatch) -> None:
    """The outer total says nothing new; only the inner one cuts the structural solution."""
    monkeypatch.setattr("mauve.wcet.ipet.model.solve_ilp", lambda problem: pytest.fail("PuLP was asked"))
    problem = replace(nested(depth=2, bound=11, cost=1), costs=(10, 1, 1, 10, 10), totals={0: 11, 1: 65})
    triangle = solve(problem)
    assert triangle is not None and triangle.attained
    assert triangle.cycles == 10 * 20 + (65 - 10) * 2 + 10
    assert violated(problem, triangle.counts) == ()
