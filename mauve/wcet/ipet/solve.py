"""The bound of one function from the costs of its edges: which solver, and why its answer can be trusted.

Without totals the structural solver is exact. With them, each header's executions get a price (`totals`), and PuLP
finds the prices to start from when there are several, and a worst path. Whatever a float solver says only chooses
multipliers: the bound is computed from them in exact arithmetic, and is never above the structural bound.
"""

from __future__ import annotations

from dataclasses import replace
from enum import Enum
from fractions import Fraction

from mauve.wcet.ipet.problem import PathProblem, PathSolution, executions
from mauve.wcet.ipet.program import dual_bound, rows, violated
from mauve.wcet.ipet.structural import Skeleton, skeleton, solve_skeleton
from mauve.wcet.ipet.totals import bound_with_totals


class Method(Enum):
    """How a path problem is solved."""

    AUTO = "auto"
    STRUCTURAL = "structural"
    """totals are not used"""
    ILP = "ilp"
    """the whole linear program by PuLP, certified by its dual values"""


def solve(problem: PathProblem, method: Method = Method.AUTO) -> PathSolution | None:
    """The bound of a path problem and a worst path; None when no path reaches the exit.

    The result is never below the maximum of the integer linear program. `Irreducible` for a cycle outside the nest.
    """
    shape = skeleton(problem)
    structural = solve_skeleton(shape, problem.costs)
    if structural is None or method is Method.STRUCTURAL:
        return structural
    if method is Method.ILP:
        return _by_ilp(problem, structural)
    if not problem.totals or not violated(problem, structural.counts):
        return structural
    return _with_totals(shape, structural)


def _with_totals(shape: Skeleton, structural: PathSolution) -> PathSolution:
    """The bound where totals cut off the structural solution."""
    problem = shape.problem
    method = "structural with totals"
    broken = [loop for loop in problem.totals if executions(problem, loop, structural.counts) > problem.totals[loop]]
    if len(broken) == 1:
        # With this total alone the optimum is exact; it is that of all totals if it keeps the others as well.
        alone = replace(problem, totals={broken[0]: problem.totals[broken[0]]})
        priced = bound_with_totals(replace(shape, problem=alone))
        if priced is not None and priced.counts is not None and not violated(problem, priced.counts):
            return PathSolution(priced.bound, priced.counts, True, method)
    ilp = _ilp(problem)
    priced = bound_with_totals(shape, _prices(problem, ilp[2]) if ilp else None)
    assert priced is not None, "the structural solver found a path"
    bound = min(structural.cycles, priced.bound)
    if ilp is None:
        return PathSolution(bound, structural.counts, False, method)
    return PathSolution(bound, ilp[1], ilp[0] == bound, method)


def _by_ilp(problem: PathProblem, structural: PathSolution) -> PathSolution:
    """The bound by PuLP alone, proven by its dual values and capped by the structural bound."""
    ilp = _ilp(problem)
    if ilp is None:
        return replace(structural, method="structural (no answer of the ILP solver)", attained=not problem.totals)
    value, counts, multipliers = ilp
    proven = min(dual_bound(problem, multipliers), dual_bound(problem, tuple(-y for y in multipliers)))
    bound = min(structural.cycles, proven)
    return PathSolution(bound, counts, value == bound, "ilp, certified")


def _ilp(problem: PathProblem) -> tuple[int, tuple[int, ...], tuple[Fraction, ...]] | None:
    """Value, edge counts and multipliers of PuLP's solution."""
    from mauve.wcet.ipet.model import solve_ilp

    solution = solve_ilp(problem)
    return None if solution is None else (solution.value, solution.counts, solution.multipliers)


def _prices(problem: PathProblem, multipliers: tuple[Fraction, ...]) -> dict[int, Fraction]:
    """The multipliers of the totals' rows, whichever sign the solver gives a maximisation."""
    headers = {f"total_{problem.nest.loops[loop].header}": loop for loop in problem.totals}
    found = zip(rows(problem), multipliers, strict=True)
    return {headers[row.name]: abs(y) for row, y in found if row.name in headers}
