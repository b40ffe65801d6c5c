"""The integer linear program of implicit path enumeration (IPET), as plain rows of integers.

Variables are the executions x_e of the feasible edges. Maximise sum c_e x_e subject to

    in(b) - out(b) = 0          every block is left as often as it is entered (the entry block once more)
    back(l) <= (N - 1) entry(l) the header of loop l runs N times per entry
    back(l) + entry(l) <= T     its header runs T times in all, where a total is known
    sum x_i / M_i <= 1          of edges that exclude each other one is passed, M_i times at most; of those that do so
                                in an iteration of loop l, <= back(l) + entry(l). Written with the M_i multiplied out
    x_e <= L                    an edge is passed L times in all, where a limit is known (a bound of the variable)

The same rows are solved by PuLP, checked by the certificate and printed for people.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import lcm

from mauve.wcet.binary.graph import EXIT
from mauve.wcet.ipet.problem import PathProblem, feasible_out, greatest_counts, header_edges, repeats

NEVER = "never_"
"""How the names of rows of edges that exclude each other begin; the number of the group follows."""


@dataclass(frozen=True, slots=True)
class Row:
    """sum coefficient * x_edge = right (`equal`) or <= right."""

    name: str
    terms: tuple[tuple[int, int], ...]
    equal: bool
    right: int


def rows(problem: PathProblem) -> tuple[Row, ...]:
    """All constraints: flow of every block that edges touch, then loops, then totals."""
    flow: dict[int, dict[int, int]] = {problem.entry: {}}
    for index, (source, target) in enumerate(problem.edges):
        if index in problem.infeasible:
            continue
        if target != EXIT:
            flow.setdefault(target, {})[index] = flow.setdefault(target, {}).get(index, 0) + 1
        flow.setdefault(source, {})[index] = flow.setdefault(source, {}).get(index, 0) - 1
    found = [
        Row(f"block_{block}", _terms(flow[block]), True, -int(block == problem.entry)) for block in sorted(flow)
    ]
    for index, loop in enumerate(problem.nest.loops):
        back, entries, starts = header_edges(problem, index)
        again = problem.bounds[index] - 1
        terms = dict.fromkeys(back, 1) | dict.fromkeys(entries, -again)
        found.append(Row(f"loop_{loop.header}", _terms(terms), False, again * starts))
    return (*found, *side_rows(problem))


def side_rows(problem: PathProblem) -> tuple[Row, ...]:
    """The constraints that join distant parts of the graph: totals, and groups of edges that exclude each other
    (`never_3` for the group 3; those of which less than two edges are feasible have no row)."""
    found = []
    for index, total in sorted(problem.totals.items()):
        back, entries, starts = header_edges(problem, index)
        terms = dict.fromkeys((*back, *entries), 1)
        header = problem.nest.loops[index].header
        found.append(Row(f"total_{header}", _terms(terms), False, total - starts))
    out = feasible_out(problem) if problem.exclusive else {}
    for index, (edges, scope) in enumerate(problem.exclusive):
        times = {edge: repeats(problem, edge, scope, out) for edge in edges if edge not in problem.infeasible}
        if len(times) > 1:
            found.append(_never(problem, f"{NEVER}{index}", times, scope))
    return tuple(found)


def _never(problem: PathProblem, name: str, times: Mapping[int, int], scope: int | None) -> Row:
    """The row of edges of which each is passed so many times and then none of the others."""
    whole = lcm(*times.values())
    terms = {edge: whole // most for edge, most in times.items()}
    if scope is None:
        return Row(name, _terms(terms), False, whole)
    back, entries, starts = header_edges(problem, scope)
    for edge in (*back, *entries):
        terms[edge] = terms.get(edge, 0) - whole
    return Row(name, _terms(terms), False, whole * starts)


def limit_rows(problem: PathProblem) -> tuple[Row, ...]:
    """The limits of edges as rows, where the loops around do not imply them."""
    free = greatest_counts(replace(problem, limits={}))
    return tuple(
        Row(f"limit_{edge}", ((edge, 1),), False, limit)
        for edge, limit in sorted(problem.limits.items())
        if limit < free[edge]
    )


def passes(row: Row, counts: Sequence[int]) -> int:
    """The left side of a row when the edges are passed `counts` times."""
    return sum(factor * counts[edge] for edge, factor in row.terms)


def _terms(coefficients: Mapping[int, int]) -> tuple[tuple[int, int], ...]:
    return tuple((edge, value) for edge, value in sorted(coefficients.items()) if value != 0)


def violated(problem: PathProblem, counts: Sequence[int]) -> tuple[str, ...]:
    """The names of the rows that integer edge counts break (`limit_0`, `negative`, `infeasible` for the bounds of
    variables)."""
    wrong = [
        row.name
        for row in rows(problem)
        for value in (passes(row, counts),)
        if (value != row.right if row.equal else value > row.right)
    ]
    wrong += [f"limit_{edge}" for edge, limit in problem.limits.items() if counts[edge] > limit]
    if any(count < 0 for count in counts):
        wrong.append("negative")
    if any(counts[edge] for edge in problem.infeasible):
        wrong.append("infeasible")
    return tuple(wrong)


def dual_bound(problem: PathProblem, multipliers: Sequence[Fraction]) -> int:
    """An upper bound of the maximum from any multipliers y of the rows, in exact arithmetic:

        b.y + sum_j max(0, c_j - (A^T y)_j) u_j

    with u_j the greatest count of edge j: its limit, or what the loops around it allow. Multipliers of inequalities
    below 0 are taken as 0. Rounded down, as the maximum over integers is an integer.
    """
    bound, reduced = reduced_costs(problem, multipliers)
    greatest = greatest_counts(problem)
    bound += sum((value * count for value, count in zip(reduced, greatest, strict=True) if value > 0), Fraction(0))
    return bound.numerator // bound.denominator


def reduced_costs(problem: PathProblem, multipliers: Sequence[Fraction]) -> tuple[Fraction, list[Fraction]]:
    """b.y and c - A^T y of `dual_bound`: what the rows are worth, and what each edge costs beyond them."""
    worth = Fraction(0)
    reduced = [Fraction(cost) for cost in problem.costs]
    for row, given in zip(rows(problem), multipliers, strict=True):
        y = given if row.equal else max(Fraction(0), given)
        if y:
            worth += y * row.right
            for edge, factor in row.terms:
                reduced[edge] -= y * factor
    return worth, reduced


def format_program(problem: PathProblem) -> str:
    """The program as text in the LP file format."""
    names = [f"x_{'b' + str(s)}_{'exit' if t == EXIT else 'b' + str(t)}" for s, t in problem.edges]
    names = [name if names.count(name) == 1 else f"{name}_e{index}" for index, name in enumerate(names)]
    used = [index for index in range(len(names)) if index not in problem.infeasible]
    lines = ["Maximize", " cycles: " + _sum([(index, problem.costs[index]) for index in used], names), "Subject To"]
    for row in rows(problem):
        lines.append(f" {row.name}: {_sum(row.terms, names)} {'=' if row.equal else '<='} {row.right}")
    limited = sorted(edge for edge in problem.limits if edge not in problem.infeasible)
    if limited:
        lines += ["Bounds", *(f" {names[edge]} <= {problem.limits[edge]}" for edge in limited)]
    lines += ["General", " " + " ".join(names[index] for index in used), "End"]
    return "\n".join(lines) + "\n"


def _sum(terms: Sequence[tuple[int, int]], names: Sequence[str]) -> str:
    text = ""
    for edge, factor in terms:
        sign = "- " if factor < 0 else "+ " if text else ""
        text += f"{' ' if text else ''}{sign}{'' if abs(factor) == 1 else f'{abs(factor)} '}{names[edge]}"
    return text or (f"0 {names[0]}" if names else "0")
