"""Large problems: no recursion limit, near-linear time, exact values beyond what floating point holds."""

from __future__ import annotations

import time

import pytest

from mauve.wcet.binary.graph import EXIT
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.ipet.problem import PathProblem, verify
from mauve.wcet.ipet.program import violated
from mauve.wcet.ipet.solve import Method, solve
from mauve.wcet.ipet.structural import solve_structural
from tests.wcet.ipet.graphs import large


def seconds(problem: PathProblem) -> float:
    started = time.process_time()
    solution = solve_structural(problem)
    spent = time.process_time() - started
    assert solution is not None
    assert violated(problem, solution.counts) == ()
    assert sum(n * c for n, c in zip(solution.counts, problem.costs, strict=True)) == solution.cycles
    return spent


def test_the_generator_makes_sound_problems() -> None:
    problem = large(300)
    assert verify(problem) == ()
    structural, ilp = solve(problem), solve(problem, Method.ILP)
    assert structural is not None and ilp is not None
    assert structural.cycles <= ilp.cycles


def test_a_straight_line_of_many_blocks() -> None:
    blocks = 50_000
    edges = tuple((block, block + 1 if block + 1 < blocks else EXIT) for block in range(blocks))
    solution = solve_structural(PathProblem(blocks, 0, edges, (3,) * blocks, LoopNest(()), {}))
    assert solution is not None and solution.cycles == 3 * blocks


@pytest.mark.slow
def test_time_grows_with_size_and_not_faster() -> None:
    small, big = large(10_000), large(100_000)
    assert seconds(big) < 40 * seconds(small) + 1
