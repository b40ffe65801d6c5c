"""The problem of implicit path enumeration: the most expensive path through a graph whose loops are bounded.

Blocks and edges are numbers; everything about instructions stays outside. Invariants (`verify`): edges name existing
blocks or EXIT, costs are not negative, loops are entered at their headers only, every loop has a bound.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import prod

from mauve.wcet.binary.graph import EXIT, Cfg
from mauve.wcet.binary.loops import LoopNest


@dataclass(frozen=True, slots=True)
class PathProblem:
    """`edges[i]` is (source, target) and costs `costs[i]` cycles each time it is passed. `bounds` maps the index of a
    loop to the executions of its header per entry (at least 1), `totals` to its executions per execution of the
    whole; `limits` maps an edge to how often one execution of the whole passes it at most. Of the edges of each group
    in `exclusive` at most one is passed in one execution of the whole, or in one iteration of the group's loop."""

    blocks: int
    entry: int
    edges: tuple[tuple[int, int], ...]
    costs: tuple[int, ...]
    nest: LoopNest
    bounds: Mapping[int, int]
    totals: Mapping[int, int] = field(default_factory=dict)
    infeasible: frozenset[int] = frozenset()
    limits: Mapping[int, int] = field(default_factory=dict)
    exclusive: tuple[tuple[tuple[int, ...], int | None], ...] = ()

    @property
    def has_sides(self) -> bool:
        """Whether there are constraints besides those of the graph and of its loops."""
        return bool(self.totals or self.limits or self.exclusive)

    def __str__(self) -> str:
        lines = [f"{self.blocks} blocks, entry b{self.entry}"]
        for index, ((source, target), cost) in enumerate(zip(self.edges, self.costs, strict=True)):
            mark = f" at most {self.limits[index]} times" if index in self.limits else ""
            mark = " infeasible" if index in self.infeasible else mark
            lines.append(f"e{index}: b{source} -> {'exit' if target == EXIT else f'b{target}'} costs {cost}{mark}")
        for index, loop in enumerate(self.nest.loops):
            total = f", at most {self.totals[index]} in all" if index in self.totals else ""
            lines.append(f"loop b{loop.header}: at most {self.bounds.get(index)} per entry{total}")
        for edges, inside in self.exclusive:
            where = "" if inside is None else f" in one iteration of loop b{self.nest.loops[inside].header}"
            lines.append(f"at most one of {', '.join(f'e{edge}' for edge in edges)}{where}")
        return "\n".join(lines)


@dataclass(frozen=True, slots=True)
class PathSolution:
    """A bound in cycles and a worst path as executions of every edge.

    `attained` says that the counts are a solution whose cost is the bound: no greater one exists and none smaller would
    be a bound. Otherwise the counts belong to the most expensive path found, and the bound may lie above its cost.
    """

    cycles: int
    counts: tuple[int, ...]
    attained: bool
    method: str
    binding: frozenset[str] = frozenset()
    """the names of side rows without which the bound would, or might, be greater"""


def problem_of(
    cfg: Cfg,
    nest: LoopNest,
    costs: tuple[int, ...],
    bounds: Mapping[int, int],
    totals: Mapping[int, int] | None = None,
    infeasible: frozenset[int] = frozenset(),
    limits: Mapping[int, int] | None = None,
    exclusive: tuple[tuple[tuple[int, ...], int | None], ...] = (),
) -> PathProblem:
    """The path problem of a function. A bound below 1 is taken as 1: a loop that is entered runs its header. An edge
    with the limit 0 is infeasible."""
    never = frozenset(edge for edge, limit in (limits or {}).items() if limit <= 0)
    return PathProblem(
        blocks=len(cfg.blocks),
        entry=cfg.entry,
        edges=tuple((edge.source, edge.target) for edge in cfg.edges),
        costs=costs,
        nest=nest,
        bounds={loop: max(1, bound) for loop, bound in bounds.items()},
        totals=dict(totals or {}),
        infeasible=infeasible | never,
        limits={edge: limit for edge, limit in (limits or {}).items() if edge not in infeasible | never},
        exclusive=exclusive,
    )


def verify(problem: PathProblem) -> tuple[str, ...]:
    """What is wrong with a problem, in sentences; empty when its invariants hold."""
    wrong = []
    if len(problem.edges) != len(problem.costs):
        wrong.append("not every edge has a cost")
    wrong += [f"edge {i} costs {cost}" for i, cost in enumerate(problem.costs) if cost < 0]
    wrong += [f"edge {i} has the limit {limit}" for i, limit in problem.limits.items() if limit < 0]
    for index, (source, target) in enumerate(problem.edges):
        if not 0 <= source < problem.blocks or not (target == EXIT or 0 <= target < problem.blocks):
            wrong.append(f"edge {index} goes from {source} to {target}")
    for index, loop in enumerate(problem.nest.loops):
        if problem.bounds.get(index, 1) < 1:
            wrong.append(f"the loop at block {loop.header} has the bound {problem.bounds[index]}")
        for number, (source, target) in enumerate(problem.edges):
            if target in loop.blocks and source not in loop.blocks and target != loop.header:
                wrong.append(f"edge {number} enters the loop at block {loop.header} in the middle")
    if problem.nest.irreducible:
        wrong.append("a region has more than one entry")
    return tuple(wrong)


def greatest_counts(problem: PathProblem) -> tuple[int, ...]:
    """The most often each edge can be passed: its limit, and the product of the bounds of the loops around its
    source."""
    loops = [prod(loop_bounds(problem, block)) for block in range(problem.blocks)]
    return tuple(
        0 if i in problem.infeasible else min(loops[source], problem.limits.get(i, loops[source]))
        for i, (source, _) in enumerate(problem.edges)
    )


def feasible_out(problem: PathProblem) -> dict[int, list[int]]:
    """The targets of the feasible edges of each block."""
    out: dict[int, list[int]] = {}
    for index, (source, target) in enumerate(problem.edges):
        if index not in problem.infeasible:
            out.setdefault(source, []).append(target)
    return out


def repeats(problem: PathProblem, edge: int, scope: int | None, out: Mapping[int, Sequence[int]]) -> int:
    """How often an edge can be passed in one iteration of the loop `scope` (None: one execution of the whole): the
    product of that for the loops inside it that hold both ends of the edge. An edge that leads out of a loop is passed
    once per entry of it; one that leads back to the header whatever follows, once less than the header is executed.
    `out` are the targets of `feasible_out`."""
    source, target = problem.edges[edge]
    outer = None if scope is None else problem.nest.loops[scope].blocks
    times = 1
    for index, loop in enumerate(problem.nest.loops):
        inside = index != scope and (outer is None or loop.blocks < outer)
        if inside and source in loop.blocks and target in loop.blocks:
            last = _leads_out(target, loop.header, loop.blocks, out)
            times *= problem.bounds[index] if last else max(1, problem.bounds[index] - 1)
    return times


def _leads_out(start: int, header: int, blocks: frozenset[int], out: Mapping[int, Sequence[int]]) -> bool:
    """Whether a way from a block leaves the loop before it comes to the header."""
    seen, waiting = {header, start}, [start] if start != header else []
    while waiting:
        for target in out.get(waiting.pop(), ()):
            if target not in blocks:
                return True
            if target not in seen:
                seen.add(target)
                waiting.append(target)
    return False


def loop_bounds(problem: PathProblem, block: int) -> tuple[int, ...]:
    """The bounds of all loops that hold a block."""
    return tuple(problem.bounds[i] for i, loop in enumerate(problem.nest.loops) if block in loop.blocks)


def header_edges(problem: PathProblem, loop: int) -> tuple[tuple[int, ...], tuple[int, ...], int]:
    """Back edges and entry edges of a loop (feasible ones), and 1 when the whole starts at its header, else 0.

    The header is executed once per back edge, entry edge and start.
    """
    here = problem.nest.loops[loop]
    back = tuple(edge for edge in here.back_edges if edge not in problem.infeasible)
    entries = tuple(edge for edge in here.entry_edges if edge not in problem.infeasible)
    return back, entries, int(here.header == problem.entry)


def executions(problem: PathProblem, loop: int, counts: Sequence[int]) -> int:
    """How often a loop's header runs when the edges are passed `counts` times."""
    back, entries, starts = header_edges(problem, loop)
    return sum(counts[edge] for edge in (*back, *entries)) + starts
