"""The exact solver: longest paths over the loop nest, in integers.

Loops are collapsed from the inside out. A loop entered once and left by the edge x costs

    run(x) = (N - 1) * C + P(x)

with N the bound of its header, C the cost of its dearest cycle (header to header, inner loops collapsed), and P(x) the
longest path from the header to x. That is the maximum of the integer linear program with one constraint per loop, since
a flow splits into cycles, each charged to the innermost loop that holds it, and one path. Every exit edge keeps its own
value: what follows differs. Totals and other global facts are not used here: without them the bound is greater, never
smaller.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from mauve.wcet.binary.graph import EXIT
from mauve.wcet.ipet.problem import PathProblem, PathSolution

ROOT = -1
"""The level outside all loops."""


class Irreducible(Exception):
    """The graph has a cycle that is no loop of the nest: an error of the caller, who must not ask for such a
    function."""


@dataclass(frozen=True, slots=True)
class Skeleton:
    """What depends on the graph but not on costs: the order of blocks, their loops, and the items of every level.

    `items[level]` lists the blocks and inner loops (by their headers) directly in a loop, in topological order.
    """

    problem: PathProblem
    out: tuple[tuple[int, ...], ...]
    innermost: tuple[int, ...]
    parent: tuple[int, ...]
    loop_of_header: dict[int, int]
    items: dict[int, tuple[int, ...]]


def solve_structural(problem: PathProblem) -> PathSolution | None:
    """The maximum over all paths from the entry to EXIT, with executions of every edge on one such path.

    None when no path reaches EXIT. `Irreducible` for a cycle outside the nest; KeyError for a loop without a bound.
    """
    return solve_skeleton(skeleton(problem), problem.costs)


def skeleton(problem: PathProblem) -> Skeleton:
    """Prepare a problem, so that several cost vectors can be solved on it."""
    out: list[list[int]] = [[] for _ in range(problem.blocks)]
    for index, (source, _) in enumerate(problem.edges):
        if index not in problem.infeasible:
            out[source].append(index)
    loops = problem.nest.loops
    innermost = [ROOT] * problem.blocks
    for index, here in enumerate(loops):
        for block in here.blocks:
            innermost[block] = index
    parent = tuple(ROOT if loop.parent is None else loop.parent for loop in loops)
    loop_of_header = {loop.header: index for index, loop in enumerate(loops)}
    items: dict[int, list[int]] = {}
    for block in _topological(problem, out):
        loop = innermost[block]
        items.setdefault(loop, []).append(block)
        if loop_of_header.get(block) == loop:
            items.setdefault(parent[loop], []).append(block)
    return Skeleton(
        problem,
        tuple(tuple(edges) for edges in out),
        tuple(innermost),
        parent,
        loop_of_header,
        {level: tuple(blocks) for level, blocks in items.items()},
    )


def _topological(problem: PathProblem, out: Sequence[Sequence[int]]) -> list[int]:
    """Blocks reachable from the entry, each after all its predecessors along edges that are not back edges."""
    back = {edge for loop in problem.nest.loops for edge in loop.back_edges}
    edges = problem.edges
    order: list[int] = []
    state = bytearray(problem.blocks)  # 0 new, 1 open, 2 done
    stack = [(problem.entry, iter(out[problem.entry]))]
    state[problem.entry] = 1
    while stack:
        block, remaining = stack[-1]
        for edge in remaining:
            target = edges[edge][1]
            if target == EXIT or edge in back or state[target] == 2:
                continue
            if state[target] == 1:
                raise Irreducible(f"block {target} lies on a cycle that is no loop")
            state[target] = 1
            stack.append((target, iter(out[target])))
            break
        else:
            state[block] = 2
            order.append(block)
            stack.pop()
    order.reverse()
    return order


@dataclass(slots=True)
class _Longest:
    """The state of one solution: longest distances and how they are reached. None: not reached."""

    arrive: list[int | None]
    via: list[int]
    """the edge by which a block is reached at the level where it is an item"""
    run: dict[int, int]
    """for an edge that leaves a loop: the value at the level processed last"""
    exits: dict[int, list[int]]
    cycle_edge: dict[int, int]
    final: int | None = None
    final_value: int = 0


def solve_skeleton(shape: Skeleton, costs: Sequence[int]) -> PathSolution | None:
    """`solve_structural` for a prepared problem and any costs; a negative cycle is not repeated."""
    problem = shape.problem
    found = _Longest([None] * problem.blocks, [-1] * problem.blocks, {}, {}, {})
    for level in range(len(problem.nest.loops) - 1, ROOT - 1, -1):
        if level in shape.items:
            _collapse(shape, costs, level, found)
    if found.final is None:
        return None
    return PathSolution(found.final_value, _counts(shape, found), True, "structural")


def _collapse(shape: Skeleton, costs: Sequence[int], level: int, found: _Longest) -> None:
    """Longest paths inside one loop (or the whole): fills `run` for its exits, or `final` for the whole."""
    problem, edges, arrive = shape.problem, shape.problem.edges, found.arrive
    loop = None if level == ROOT else problem.nest.loops[level]
    inside = None if loop is None else loop.blocks
    start = problem.entry if loop is None else loop.header
    if loop is None:
        arrive[start] = 0
    cycle, exits = 0, found.exits.setdefault(level, [])
    for item in shape.items[level]:
        inner = shape.loop_of_header.get(item, level)
        if inner == level:
            distance = 0 if loop is not None and item == start else arrive[item]
            leaving = [] if distance is None else [(edge, distance + costs[edge]) for edge in shape.out[item]]
        else:
            distance = arrive[item]
            leaving = [] if distance is None else [(e, distance + found.run[e]) for e in found.exits.get(inner, ())]
        for edge, value in leaving:
            target = edges[edge][1]
            if inside is not None and target not in inside:
                found.run[edge] = value
                exits.append(edge)
            elif loop is not None and target == start:
                if value > cycle:
                    cycle = value
                    found.cycle_edge[level] = edge
            elif target == EXIT:
                if found.final is None or value > found.final_value:
                    found.final, found.final_value = edge, value
            else:
                known = arrive[target]
                if known is None or value > known:
                    arrive[target] = value
                    found.via[target] = edge
    if loop is not None:
        again = (problem.bounds[level] - 1) * cycle
        for edge in exits:
            found.run[edge] += again


def _counts(shape: Skeleton, found: _Longest) -> tuple[int, ...]:
    """Executions of every edge on the worst path, from the whole inwards."""
    problem = shape.problem
    counts = [0] * len(problem.edges)
    assert found.final is not None
    demands: dict[int, list[tuple[int, int]]] = {ROOT: [(found.final, 1)]}
    for level in range(ROOT, len(problem.nest.loops)):
        wanted = demands.pop(level, None)
        if wanted is None:
            continue
        if level != ROOT and level in found.cycle_edge:
            again = (problem.bounds[level] - 1) * sum(count for _, count in wanted)
            if again:
                wanted.append((found.cycle_edge[level], again))
        start = problem.entry if level == ROOT else problem.nest.loops[level].header
        leaving: dict[int, list[tuple[int, int]]] = {}
        for edge, count in wanted:
            leaving.setdefault(_item(shape, level, problem.edges[edge][0]), []).append((edge, count))
        for item in reversed(shape.items[level]):
            here = leaving.pop(item, None)
            if here is None:
                continue
            inner = shape.loop_of_header.get(item, level)
            if inner == level:
                for edge, count in here:
                    counts[edge] += count
            else:
                demands.setdefault(inner, []).extend(here)
            if item != start:
                edge = found.via[item]
                source = _item(shape, level, problem.edges[edge][0])
                leaving.setdefault(source, []).append((edge, sum(count for _, count in here)))
    return tuple(counts)


def _item(shape: Skeleton, level: int, block: int) -> int:
    """The item of a level that a block belongs to: itself, or the header of the inner loop around it."""
    loop = shape.innermost[block]
    if loop == level:
        return block
    while shape.parent[loop] != level:
        loop = shape.parent[loop]
    return shape.problem.nest.loops[loop].header
