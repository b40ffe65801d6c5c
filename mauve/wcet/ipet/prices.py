"""Side constraints, exactly: a price per unit of a row instead of the row (Lagrangian relaxation).

For rows a_i x <= r_i and any prices p >= 0 the maximum under these rows is at most

    f(p) = sum_i p_i r_i + max over paths of (cost - sum_i p_i a_i x)

and the inner maximum is the structural solver's, in exact arithmetic. f is convex and piecewise linear; with one row
its minimum, the value of the linear relaxation, is found by intersecting the lines of the solutions met so far. Several
rows are priced in turn, from any start, for example the dual values of a linear program.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm

from mauve.wcet.clock import Deadline, is_over
from mauve.wcet.ipet.program import Row, passes
from mauve.wcet.ipet.structural import Skeleton, solve_skeleton

ROUNDS = 8
"""How often each price is improved while the others stay: f only falls."""

WORK = 400_000
"""Edges passed at most by the structural solver while prices are improved."""

Prices = tuple[Fraction, ...]


@dataclass(frozen=True, slots=True)
class Priced:
    """f at its least point found, rounded down, and the edge counts that the last price led to: a flow that keeps the
    flow and loop rows, None where it is none of integers. They need not keep the priced rows. `paid` are the names of
    the rows with a price."""

    bound: int
    counts: tuple[int, ...] | None
    paid: frozenset[str]


@dataclass(frozen=True, slots=True)
class _Line:
    """f along the price of one row, at `price`: its value, its slope there, and the path that gives both."""

    price: Fraction
    value: Fraction
    slope: int
    counts: tuple[int, ...]

    def at(self, price: Fraction) -> Fraction:
        return self.value + self.slope * (price - self.price)


def bound_with_rows(
    shape: Skeleton, rows: Sequence[Row], start: Sequence[Fraction] = (), deadline: Deadline = None
) -> Priced | None:
    """The least f found from the prices in `start` (those below 0, or missing, are 0). None when no path reaches the
    exit. When the deadline is over the prices stay as they are."""
    prices: Prices = tuple(max(Fraction(0), p) for p in (*start, *(Fraction(0) for _ in rows[len(start) :])))
    best = _line(shape, rows, prices, None)
    if best is None:
        return None
    counts: tuple[int, ...] | None = best.counts
    value = best.value
    work = WORK
    for _ in range(ROUNDS):
        before = value
        for index in range(len(rows)):
            if work <= 0 or is_over(deadline):
                break
            found, price, counts, solved = _best_price(shape, rows, prices, index)
            value = min(value, found)
            prices = (*prices[:index], price, *prices[index + 1 :])
            work -= solved * len(shape.problem.edges)
        if value == before or len(rows) == 1:
            break
    paid = frozenset(row.name for row, price in zip(rows, prices, strict=True) if price)
    return Priced(value.numerator // value.denominator, counts, paid)


def _best_price(
    shape: Skeleton, rows: Sequence[Row], prices: Prices, index: int
) -> tuple[Fraction, Fraction, tuple[int, ...] | None, int]:
    """The least f over the price of one row, that price, edge counts that attain f, if they are integers, and how
    many paths were looked for."""
    solved = 0

    def line(price: Fraction) -> _Line:
        nonlocal solved
        solved += 1
        found = _line(shape, rows, (*prices[:index], price, *prices[index + 1 :]), index)
        assert found is not None
        return found

    low = line(Fraction(0))
    if low.slope >= 0:
        return low.value, low.price, low.counts, solved
    # Above this price one unit of the row less outweighs everything else.
    high = line(max(low.value, Fraction(0)) + 1)
    if high.slope < 0:
        # The row is below what every path needs: it contradicts the graph, and is not used.
        return low.value, low.price, None, solved
    while high.slope > 0:
        price = (low.value - high.value + high.slope * high.price - low.slope * low.price) / (high.slope - low.slope)
        between = line(price)
        if between.slope == 0:
            return between.value, price, between.counts, solved
        if between.value == low.at(price):
            return between.value, price, _mixed(low, high), solved
        if between.slope < 0:
            low = between
        else:
            high = between
    return high.value, high.price, high.counts, solved


def _mixed(low: _Line, high: _Line) -> tuple[int, ...] | None:
    """The mixture of two flows that uses the row up exactly (rows are linear, so it keeps all of them); None when it
    is no flow of integers."""
    weight = Fraction(high.slope, high.slope - low.slope)
    mixed = [h + (l - h) * weight for l, h in zip(low.counts, high.counts, strict=True)]  # noqa: E741
    return tuple(int(x) for x in mixed) if all(x.denominator == 1 for x in mixed) else None


def _line(shape: Skeleton, rows: Sequence[Row], prices: Prices, index: int | None) -> _Line | None:
    """f at the prices; its slope along the price of the row `index`."""
    scale = lcm(*(price.denominator for price in prices))
    costs = [cost * scale for cost in shape.problem.costs]
    constant = 0
    for row, price in zip(rows, prices, strict=True):
        scaled = int(price * scale)
        if scaled:
            constant += scaled * row.right
            for edge, factor in row.terms:
                costs[edge] -= scaled * factor
    solution = solve_skeleton(shape, costs)
    if solution is None:
        return None
    slope = 0 if index is None else rows[index].right - passes(rows[index], solution.counts)
    price = Fraction(0) if index is None else prices[index]
    return _Line(price, Fraction(solution.cycles + constant, scale), slope, solution.counts)
