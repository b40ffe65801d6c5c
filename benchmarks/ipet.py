"""The path solver on a structured program of 100 000 blocks: seconds to prepare and to solve."""

from __future__ import annotations

import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from mauve.wcet.ipet.structural import skeleton, solve_skeleton
from tests.wcet.ipet.graphs import large

BUDGET = 3.0
"""Seconds for 100 000 blocks, dominators and loop nest included."""


def measure(blocks: int = 100_000) -> tuple[float, float, int]:
    """Seconds to prepare, seconds to solve, the bound."""
    problem = large(blocks)
    start = time.perf_counter()
    shape = skeleton(problem)
    prepared = time.perf_counter()
    solution = solve_skeleton(shape, problem.costs)
    solved = time.perf_counter()
    assert solution is not None
    return prepared - start, solved - prepared, solution.cycles


if __name__ == "__main__":
    prepare, solve, cycles = measure()
    print(f"ipet, 100 000 blocks: prepare {prepare:.2f} s, solve {solve:.2f} s (budget {BUDGET:.1f} s), bound {cycles}")
