"""The integer linear program solved by PuLP. The only module that knows PuLP.

A float solver's value is never a bound: its integer solution is evaluated again in integers, which gives a value that
is attained, and its dual values give a bound that `program.dual_bound` proves in fractions.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

from mauve.wcet.ipet.problem import PathProblem
from mauve.wcet.ipet.program import Row, rows, violated

DENOMINATOR = 1 << 20
"""Dual values are rounded to fractions with at most this denominator; any rounding is safe, a good one is tight."""


@dataclass(frozen=True, slots=True)
class IlpSolution:
    """`counts` satisfy all rows exactly and cost `value`; `multipliers` are dual values of the rows, rounded."""

    value: int
    counts: tuple[int, ...]
    multipliers: tuple[Fraction, ...]


def solve_ilp(problem: PathProblem, timeout: float | None = None) -> IlpSolution | None:
    """The program by CBC, which PuLP brings along.

    None when the solver reports no optimum, or one that breaks a row when it is checked in integers.
    """
    constraints = rows(problem)
    relaxed = _solve(problem, constraints, timeout, integer=False)
    if relaxed is None:
        return None
    counts = _rounded(relaxed[0])
    if violated(problem, counts) or not _integral(relaxed[0]):
        exact = _solve(problem, constraints, timeout, integer=True)
        if exact is None:
            return None
        counts = _rounded(exact[0])
        if violated(problem, counts):
            return None
    value = sum(count * cost for count, cost in zip(counts, problem.costs, strict=True))
    return IlpSolution(value, counts, tuple(_fraction(dual) for dual in relaxed[1]))


def _solve(
    problem: PathProblem, constraints: Sequence[Row], timeout: float | None, integer: bool
) -> tuple[list[float], list[float]] | None:
    """Values of all edges and dual values of all rows, None without an optimum."""
    with warnings.catch_warnings():
        # PuLP 3 announces the names of PuLP 4; the package's requirement keeps to 3.
        warnings.simplefilter("ignore", DeprecationWarning)
        return _optimum(problem, constraints, timeout, integer)


def _optimum(
    problem: PathProblem, constraints: Sequence[Row], timeout: float | None, integer: bool
) -> tuple[list[float], list[float]] | None:
    import pulp

    category = pulp.LpInteger if integer else pulp.LpContinuous
    variables: dict[int, Any] = {
        index: pulp.LpVariable(f"x{index}", lowBound=0, upBound=problem.limits.get(index), cat=category)
        for index in range(len(problem.edges))
        if index not in problem.infeasible
    }
    model = pulp.LpProblem("wcet", pulp.LpMaximize)
    model.setObjective(pulp.LpAffineExpression([(x, problem.costs[index]) for index, x in variables.items()]))
    made = []
    for row in constraints:
        left = pulp.LpAffineExpression([(variables[edge], factor) for edge, factor in row.terms])
        sense = pulp.LpConstraintEQ if row.equal else pulp.LpConstraintLE
        made.append(pulp.LpConstraint(left, sense, row.name, row.right))
        model.addConstraint(made[-1])
    options: dict[str, Any] = {"msg": False, "timeLimit": timeout}
    if integer:
        options["gapRel"] = 0.0
    status = model.solve(pulp.PULP_CBC_CMD(mip=integer, **options))
    if status != pulp.LpStatusOptimal:
        return None
    values = [0.0] * len(problem.edges)
    for index, x in variables.items():
        values[index] = x.value() or 0.0
    return values, [row.pi or 0.0 for row in made]


def _rounded(values: Sequence[float]) -> tuple[int, ...]:
    return tuple(round(value) for value in values)


def _integral(values: Sequence[float]) -> bool:
    return all(abs(value - round(value)) <= 1e-6 * max(1.0, abs(value)) for value in values)


def _fraction(value: float) -> Fraction:
    nearest = round(value)
    close = abs(value - nearest) <= 1e-6 * max(1.0, abs(value))
    return Fraction(nearest) if close else Fraction(value).limit_denominator(DENOMINATOR)
