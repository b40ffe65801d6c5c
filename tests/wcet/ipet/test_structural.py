"""The structural solver is exact: it equals exhaustive search, its counts are a flow that costs what it says."""

from __future__ import annotations

from dataclasses import replace
from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.wcet.binary.graph import EXIT
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.ipet.problem import PathProblem, verify
from mauve.wcet.ipet.program import violated
from mauve.wcet.ipet.structural import Irreducible, solve_structural
from tests.wcet.ipet.graphs import Structured, longest_by_search, nest_of, nested, random_problem


def check_counts(problem: PathProblem) -> int:
    """The solution's counts keep every row and cost exactly the bound."""
    solution = solve_structural(problem)
    assert solution is not None
    assert violated(problem, solution.counts) == ()
    assert sum(n * c for n, c in zip(solution.counts, problem.costs, strict=True)) == solution.cycles
    return solution.cycles


@settings(max_examples=300, deadline=None)
@given(seed=st.integers(0, 2**32), blocks=st.integers(1, 7), extra=st.integers(0, 7))
def test_equals_exhaustive_search_on_random_graphs(seed: int, blocks: int, extra: int) -> None:
    problem = random_problem(Random(seed), blocks, extra, largest_bound=3)
    if problem is None:
        return
    assert verify(problem) == ()
    longest = longest_by_search(problem, limit=20_000)
    cycles = check_counts(problem)
    if longest is not None:
        assert cycles == longest


@settings(max_examples=150, deadline=None)
@given(seed=st.integers(0, 2**32))
def test_equals_exhaustive_search_on_structured_programs(seed: int) -> None:
    problem = Structured(Random(seed)).problem(depth=3, largest_bound=3)
    assert verify(problem) == ()
    longest = longest_by_search(problem, limit=20_000)
    cycles = check_counts(problem)
    if longest is not None:
        assert cycles == longest


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 2**32), raised=st.integers(0, 1000))
def test_never_falls_when_a_cost_or_a_bound_rises(seed: int, raised: int) -> None:
    problem = Structured(Random(seed)).problem(depth=4)
    before = check_counts(problem)
    dearer = list(problem.costs)
    dearer[raised % len(dearer)] += 7
    assert check_counts(replace(problem, costs=tuple(dearer))) >= before
    if problem.bounds:
        loop = raised % len(problem.bounds)
        assert check_counts(replace(problem, bounds={**problem.bounds, loop: problem.bounds[loop] + 3})) >= before


@settings(max_examples=100, deadline=None)
@given(seed=st.integers(0, 2**32), removed=st.integers(0, 1000))
def test_infeasible_edges_are_never_passed_and_never_raise_the_bound(seed: int, removed: int) -> None:
    problem = Structured(Random(seed)).problem(depth=3)
    before = check_counts(problem)
    without = replace(problem, infeasible=frozenset({removed % len(problem.edges)}))
    solution = solve_structural(without)
    if solution is not None:
        assert check_counts(without) <= before


def test_deep_nest_is_exact_beyond_floating_point() -> None:
    problem = nested(depth=6, bound=50, cost=7)
    # Each inner header runs 50 times for each of the 49 bodies of the loop around it.
    headers = [50 * 49**level for level in range(6)]
    bodies = [count * 49 // 50 for count in headers]
    forward = sum(bodies)
    assert check_counts(problem) == 7 * (2 * forward + 1)
    assert headers[-1] > 10**10


def test_bound_of_one_means_that_the_back_edge_is_never_taken() -> None:
    problem = nested(depth=1, bound=1, cost=10)
    assert check_counts(problem) == 10


def test_exits_keep_their_own_continuation() -> None:
    # Leaving the loop early (0 -> 2) is cheap inside and dear afterwards.
    edges = [(0, 1), (1, 0), (0, 2), (1, 3), (2, EXIT), (3, EXIT)]
    nest = nest_of(4, 0, edges)
    assert nest is not None
    problem = PathProblem(4, 0, tuple(edges), (1, 1, 1, 1, 1000, 5), nest, {0: 10})
    assert check_counts(problem) == 9 * 2 + 1 + 1000


def test_inner_break_to_the_outer_header_is_a_back_edge_of_the_outer_loop() -> None:
    edges = [(0, 1), (1, 2), (2, 1), (2, 0), (0, EXIT)]
    nest = nest_of(3, 0, edges)
    assert nest is not None
    problem = PathProblem(3, 0, tuple(edges), (1, 10, 100, 1000, 10000), nest, {0: 3, 1: 4})
    inner_run = 3 * (10 + 100) + 10 + 1000
    assert check_counts(problem) == 2 * (1 + inner_run) + 10000


def test_no_way_out_has_no_solution() -> None:
    nest = nest_of(1, 0, [(0, 0)])
    assert nest is not None
    assert solve_structural(PathProblem(1, 0, ((0, 0),), (1,), nest, {0: 5})) is None


def test_a_cycle_outside_the_nest_is_refused() -> None:
    edges = ((0, 1), (0, 2), (1, 2), (2, 1), (1, EXIT))
    with pytest.raises(Irreducible):
        solve_structural(PathProblem(3, 0, edges, (1,) * 5, LoopNest(()), {}))


def test_a_loop_without_a_bound_is_refused() -> None:
    problem = nested(depth=2, bound=3, cost=1)
    with pytest.raises(KeyError):
        solve_structural(replace(problem, bounds={0: 3}))


def test_problem_prints_its_edges_and_loops() -> None:
    assert str(replace(nested(depth=1, bound=4, cost=2), totals={0: 9}, infeasible=frozenset({2}))) == (
        "2 blocks, entry b0\n"
        "e0: b0 -> b1 costs 2\n"
        "e1: b1 -> b0 costs 2\n"
        "e2: b0 -> exit costs 2 infeasible\n"
        "loop b0: at most 4 per entry, at most 9 in all"
    )
