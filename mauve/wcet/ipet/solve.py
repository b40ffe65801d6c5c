"""The bound of one function from the costs of its edges: which solver, and why its answer can be trusted.

Without side constraints (totals of loops, limits of edges, edges that exclude each other) the structural solver is
exact. Where its worst path breaks some, each broken one gets a price (`prices`), and PuLP finds the prices to start
from, and a worst path, where that is not enough. Whatever a float solver says only chooses multipliers: the bound is
computed from them in exact arithmetic, and is never above the structural bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from enum import Enum
from fractions import Fraction

from mauve.wcet.clock import Deadline, is_over, left
from mauve.wcet.ipet.prices import bound_with_rows
from mauve.wcet.ipet.problem import PathProblem, PathSolution
from mauve.wcet.ipet.program import Row, dual_bound, limit_rows, passes, reduced_costs, rows, side_rows, violated
from mauve.wcet.ipet.structural import Skeleton, skeleton, solve_skeleton

FEW = 8
"""Broken rows that are priced before a linear program is solved."""


class Method(Enum):
    """How a path problem is solved."""

    AUTO = "auto"
    STRUCTURAL = "structural"
    """side constraints are not used"""
    ILP = "ilp"
    """the whole linear program by PuLP, certified by its dual values"""


def solve(problem: PathProblem, method: Method = Method.AUTO, deadline: Deadline = None) -> PathSolution | None:
    """The bound of a path problem and a worst path; None when no path reaches the exit.

    The result is never below the maximum of the integer linear program. When the deadline is over, side constraints are
    used as far as they have been looked at: the bound is then greater, not less sure. `Irreducible` for a
    cycle outside the nest.
    """
    shape = skeleton(problem)
    structural = solve_skeleton(shape, problem.costs)
    if structural is None or method is Method.STRUCTURAL:
        return structural
    if method is Method.ILP:
        return _by_ilp(problem, structural)
    if not problem.has_sides or is_over(deadline) or not violated(problem, structural.counts):
        return structural
    return _with_sides(shape, structural, deadline)


def _with_sides(shape: Skeleton, structural: PathSolution, deadline: Deadline) -> PathSolution:
    """The bound where side constraints cut off the structural solution."""
    problem = shape.problem
    method = "structural, with side constraints"
    full = _all_limits(problem)
    if full is not None:
        return PathSolution(full[0], full[1], True, method, frozenset(f"limit_{edge}" for edge in problem.limits))
    candidates = (*side_rows(problem), *limit_rows(problem))
    priced = _few(shape, candidates, structural, method, deadline)
    if priced.attained:
        return priced
    ilp = None if is_over(deadline) else _ilp(problem, deadline)
    if ilp is None:
        return replace(priced, cycles=min(priced.cycles, structural.cycles))
    if ilp[0] == priced.cycles:
        return PathSolution(priced.cycles, ilp[1], True, method, priced.binding)
    proven, multipliers = _proven(problem, ilp[2])
    paid = frozenset(row.name for row, y in zip(rows(problem), multipliers, strict=True) if y and not row.equal)
    binding = paid & {row.name for row in candidates}
    proven = min(proven, priced.cycles)
    if ilp[0] < proven:
        again = bound_with_rows(shape, candidates, _prices(problem, candidates, multipliers), deadline)
        assert again is not None, "the structural solver found a path"
        proven, binding = min((proven, binding), (again.bound, again.paid), key=lambda found: found[0])
    return PathSolution(proven, ilp[1], ilp[0] == proven, method, binding)


def _all_limits(problem: PathProblem) -> tuple[int, tuple[int, ...]] | None:
    """Cost and counts where the limits of all edges are one flow that keeps all rows: then no other costs more."""
    if len(problem.limits) + len(problem.infeasible - problem.limits.keys()) < len(problem.edges):
        return None
    counts = tuple(0 if edge in problem.infeasible else problem.limits[edge] for edge in range(len(problem.edges)))
    if violated(problem, counts):
        return None
    return sum(count * cost for count, cost in zip(counts, problem.costs, strict=True)), counts


def _few(
    shape: Skeleton, candidates: Sequence[Row], structural: PathSolution, method: str, deadline: Deadline
) -> PathSolution:
    """Price the rows that the worst path breaks, then those that the next one breaks, while they are few.

    The result is attained where the last path keeps all rows and costs the bound: the rows not priced then cut
    nothing off.
    """
    problem = shape.problem
    bound, counts = structural.cycles, structural.counts
    paid: frozenset[str] = frozenset()
    used: list[Row] = []
    while len(used) < FEW:
        names = {row.name for row in used}
        broken = [row for row in candidates if row.name not in names and passes(row, counts) > row.right]
        if not broken or len(used) + len(broken) > FEW or is_over(deadline):
            break
        used += broken
        priced = bound_with_rows(shape, used, deadline=deadline)
        assert priced is not None, "the structural solver found a path"
        if priced.bound < bound:
            bound, paid = priced.bound, priced.paid
        if priced.counts is None:
            break
        counts = priced.counts
        cost = sum(count * cost for count, cost in zip(counts, problem.costs, strict=True))
        if cost == bound and not violated(problem, counts):
            return PathSolution(bound, counts, True, method, paid)
    return PathSolution(bound, structural.counts, False, method, paid)


def _by_ilp(problem: PathProblem, structural: PathSolution) -> PathSolution:
    """The bound by PuLP alone, proven by its dual values and capped by the structural bound."""
    ilp = _ilp(problem)
    if ilp is None:
        exact = not problem.has_sides
        return replace(structural, method="structural (no answer of the ILP solver)", attained=exact)
    value, counts, multipliers = ilp
    proven, used = _proven(problem, multipliers)
    bound = min(structural.cycles, proven)
    sides = {row.name for row in side_rows(problem)}
    binding = frozenset(row.name for row, y in zip(rows(problem), used, strict=True) if y and row.name in sides)
    return PathSolution(bound, counts, value == bound, "ilp, certified", binding)


def _ilp(problem: PathProblem, deadline: Deadline = None) -> tuple[int, tuple[int, ...], tuple[Fraction, ...]] | None:
    """Value, edge counts and multipliers of PuLP's solution."""
    from mauve.wcet.ipet.model import solve_ilp

    # The solver runs up to twice: with fractions and with integers.
    solution = solve_ilp(problem, None if deadline is None else left(deadline) / 2)
    return None if solution is None else (solution.value, solution.counts, solution.multipliers)


def _proven(problem: PathProblem, multipliers: tuple[Fraction, ...]) -> tuple[int, tuple[Fraction, ...]]:
    """The bound that the multipliers prove, whichever sign the solver gives a maximisation, and those of that sign."""
    return min((dual_bound(problem, given), given) for given in (multipliers, tuple(-y for y in multipliers)))


def _prices(problem: PathProblem, candidates: Sequence[Row], multipliers: tuple[Fraction, ...]) -> list[Fraction]:
    """The prices of side rows from the multipliers; that of a limit is what the rows leave of its edge's cost."""
    given = {row.name: y for row, y in zip(rows(problem), multipliers, strict=True)}
    left = reduced_costs(problem, multipliers)[1]
    return [given.get(row.name, left[row.terms[0][0]]) for row in candidates]
