"""Totals of loops, exactly: a price per execution of a header instead of a constraint (Lagrangian relaxation).

For any prices p >= 0 the maximum under the totals T is at most

    f(p) = sum_l p_l T_l + max over paths of (cost - sum_l p_l executions of header l)

and the inner maximum is the structural solver's, in exact arithmetic. f is convex and piecewise linear; with one total
its minimum, the value of the linear relaxation, is found by intersecting the lines of the solutions met so far. Several
totals are priced in turn, from any start, for example the dual values of a linear program.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from math import lcm

from mauve.wcet.ipet.problem import executions, header_edges
from mauve.wcet.ipet.structural import Skeleton, solve_skeleton

ROUNDS = 8
"""How often each price is improved while the others stay: f only falls."""

Prices = dict[int, Fraction]


@dataclass(frozen=True, slots=True)
class Priced:
    """f at its least point found, rounded down. `counts` keep all totals and cost `bound`, where such were found."""

    bound: int
    counts: tuple[int, ...] | None


@dataclass(frozen=True, slots=True)
class _Line:
    """f along the price of one total, at `price`: its value, its slope there, and the path that gives both."""

    price: Fraction
    value: Fraction
    slope: int
    counts: tuple[int, ...]

    def at(self, price: Fraction) -> Fraction:
        return self.value + self.slope * (price - self.price)


def bound_with_totals(shape: Skeleton, start: Mapping[int, Fraction] | None = None) -> Priced | None:
    """The least f found from the prices in `start`. None when no path reaches the exit."""
    problem = shape.problem
    prices: Prices = {loop: max(Fraction(0), (start or {}).get(loop, Fraction(0))) for loop in problem.totals}
    if _line(shape, prices, None) is None:
        return None
    value: Fraction | None = None
    counts: tuple[int, ...] | None = None
    for _ in range(ROUNDS):
        before = value
        for loop in problem.totals:
            value, prices[loop], counts = _best_price(shape, prices, loop)
        if value == before or len(problem.totals) == 1:
            break
    assert value is not None
    return Priced(value.numerator // value.denominator, counts if len(problem.totals) == 1 else None)


def _best_price(shape: Skeleton, prices: Prices, loop: int) -> tuple[Fraction, Fraction, tuple[int, ...] | None]:
    """The least f over the price of one total, that price, and edge counts that attain f, if they are integers."""

    def line(price: Fraction) -> _Line:
        found = _line(shape, {**prices, loop: price}, loop)
        assert found is not None
        return found

    low = line(Fraction(0))
    if low.slope >= 0:
        return low.value, low.price, low.counts
    # Above this price one execution of the header less outweighs everything else.
    high = line(low.value + 1)
    if high.slope < 0:
        # The total is below what every path needs: it contradicts the graph, and is not used.
        return low.value, low.price, None
    while high.slope > 0:
        price = (low.value - high.value + high.slope * high.price - low.slope * low.price) / (high.slope - low.slope)
        between = line(price)
        if between.slope == 0:
            return between.value, price, between.counts
        if between.value == low.at(price):
            return between.value, price, _mixed(low, high)
        if between.slope < 0:
            low = between
        else:
            high = between
    return high.value, high.price, high.counts


def _mixed(low: _Line, high: _Line) -> tuple[int, ...] | None:
    """The mixture of two flows that uses the total up exactly (rows are linear, so it keeps all of them); None when it
    is no flow of integers."""
    weight = Fraction(high.slope, high.slope - low.slope)
    mixed = [h + (l - h) * weight for l, h in zip(low.counts, high.counts, strict=True)]  # noqa: E741
    return tuple(int(x) for x in mixed) if all(x.denominator == 1 for x in mixed) else None


def _line(shape: Skeleton, prices: Mapping[int, Fraction], loop: int | None) -> _Line | None:
    """f at the prices; its slope along the price of `loop`."""
    problem = shape.problem
    scale = lcm(*(price.denominator for price in prices.values()))
    costs = [cost * scale for cost in problem.costs]
    constant = 0
    for priced, price in prices.items():
        scaled = int(price * scale)
        back, entries, starts = header_edges(problem, priced)
        constant += scaled * (problem.totals[priced] - starts)
        for edge in (*back, *entries):
            costs[edge] -= scaled
    solution = solve_skeleton(shape, costs)
    if solution is None:
        return None
    slope = 0 if loop is None else problem.totals[loop] - executions(problem, loop, solution.counts)
    price = Fraction(0) if loop is None else prices[loop]
    return _Line(price, Fraction(solution.cycles + constant, scale), slope, solution.counts)
