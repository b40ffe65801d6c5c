"""Bounds of all functions of a program, callees first: costs of edges, bounds of callees added at calls, path problems.

A call costs the most expensive of its callees. A path that ends in a trap or in a call that never comes back counts up
to there: no execution that returns goes on. A function whose code, loops or callees leave something unknown has no
bound; its problems say why, and the other functions still get theirs.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from mauve.wcet.binary.graph import EXIT, EdgeKind
from mauve.wcet.clock import Deadline
from mauve.wcet.flow.result import ContextKey, FunctionFlow, ProgramFlow
from mauve.wcet.hardware.board import Board
from mauve.wcet.hardware.core import Core
from mauve.wcet.hardware.cost import edge_costs
from mauve.wcet.ipet.problem import PathProblem, problem_of
from mauve.wcet.ipet.program import NEVER
from mauve.wcet.ipet.solve import Method, solve
from mauve.wcet.result import Problem, ProblemKind

_RETURNS = (EdgeKind.RETURN, EdgeKind.TAIL_CALL)


@dataclass(frozen=True, slots=True)
class FunctionBound:
    """One function in one context.

    `cycles` is its bound, callees included, None when it has none. `own` are the cycles of each edge without callees,
    `counts` the executions of each edge on the worst path, `chosen` the callee that counts on each call edge.
    `problems` are its own, not those of its callees. `stack` is the greatest depth in bytes, callees included, None
    when unknown.
    """

    cycles: int | None
    own: tuple[int, ...] = ()
    counts: tuple[int, ...] = ()
    chosen: Mapping[int, ContextKey] | None = None
    problems: tuple[Problem, ...] = ()
    stack: int | None = None
    method: str = ""
    never: tuple[int, ...] = ()
    """the groups in `FunctionFlow.exclusive` that the bound rests on"""


def bound_program(
    program: ProgramFlow, core: Core, board: Board, method: Method = Method.AUTO
) -> dict[ContextKey, FunctionBound]:
    """The bounds of all functions of a program, in its order (callees before callers)."""
    bounds: dict[ContextKey, FunctionBound] = {}
    for key, flow in program.functions.items():
        bounds[key] = bound_function(flow, core, board, bounds, method)
    return bounds


def bound_function(
    flow: FunctionFlow,
    core: Core,
    board: Board,
    callees: Mapping[ContextKey, FunctionBound],
    method: Method = Method.AUTO,
    deadline: Deadline = None,
) -> FunctionBound:
    """The bound of one function from those of its callees; a callee that is missing has no bound. Raises OutOfTime;
    where only side constraints are left to be looked at by then, the bound is the one without them."""
    live = reachable_edges(flow)
    stack = _stack(flow, callees, live)
    costs = edge_costs(flow.cfg, core, board, flow.accesses, flow.infeasible, deadline)
    problems = (*flow.problems, *costs.problems, *unresolved(flow))
    if problems or flow.nest.irreducible:
        return FunctionBound(None, problems=problems, stack=stack)
    chosen: dict[int, ContextKey] = {}
    total = list(costs.cycles)
    for index in live:
        if flow.cfg.edges[index].kind is EdgeKind.STOP:
            continue
        contexts = flow.calls.get(index, ())
        if not contexts and flow.cfg.edges[index].callees:
            return FunctionBound(None, stack=stack)
        if contexts:
            known = [(bound.cycles, key) for key in contexts if (bound := callees.get(key)) is not None]
            if len(known) < len(contexts) or any(cycles is None for cycles, _ in known):
                return FunctionBound(None, stack=stack)
            cycles, chosen[index] = max((cycles or 0, key) for cycles, key in known)
            total[index] += cycles
    missing = _unbounded(flow, live)
    if missing:
        return FunctionBound(None, problems=missing, stack=stack)
    solution = solve(function_problem(flow, tuple(total)), method, deadline)
    returns = any(flow.cfg.edges[index].kind in _RETURNS for index in live)
    if solution is None or not returns:
        message = f"{flow.cfg.name} does not return: no path leads out of it"
        problem = Problem(ProblemKind.NO_RETURN, message, flow.cfg.address, flow.cfg.name)
        return FunctionBound(None, problems=(problem,), stack=stack)
    never = tuple(sorted(int(name.removeprefix(NEVER)) for name in solution.binding if name.startswith(NEVER)))
    return FunctionBound(solution.cycles, costs.cycles, solution.counts, chosen, (), stack, solution.method, never)


def function_problem(flow: FunctionFlow, costs: tuple[int, ...]) -> PathProblem:
    """The path problem of a function whose edges cost `costs`, callees included."""
    return problem_of(
        flow.cfg,
        flow.nest,
        costs,
        {loop: flow.bounds[loop].bound if loop in flow.bounds else 1 for loop in range(len(flow.nest.loops))},
        {loop: bound.total for loop, bound in flow.bounds.items() if bound.total is not None},
        flow.infeasible,
        flow.edge_limits,
        tuple((group.edges, group.loop) for group in flow.exclusive),
    )


def reachable_edges(flow: FunctionFlow) -> tuple[int, ...]:
    """The indices of the edges on feasible paths from the entry, in order."""
    out: dict[int, list[int]] = {}
    for index, edge in enumerate(flow.cfg.edges):
        if index not in flow.infeasible:
            out.setdefault(edge.source, []).append(index)
    seen, waiting = {flow.cfg.entry}, [flow.cfg.entry]
    live = []
    while waiting:
        for index in out.get(waiting.pop(), ()):
            live.append(index)
            target = flow.cfg.edges[index].target
            if target != EXIT and target not in seen:
                seen.add(target)
                waiting.append(target)
    return tuple(sorted(live))


def calls_of(flow: FunctionFlow) -> Iterator[tuple[int, ContextKey]]:
    """Every feasible call that comes back, or may do so: its edge and the callee's context."""
    for index in reachable_edges(flow):
        edge = flow.cfg.edges[index]
        if edge.kind is EdgeKind.STOP and edge.callees:
            continue
        for key in flow.calls.get(index, ()):
            yield index, key


def _stack(flow: FunctionFlow, callees: Mapping[ContextKey, FunctionBound], live: tuple[int, ...]) -> int | None:
    """The function's frame and the deepest callee on top of it; a tail call has given the frame back. None where what
    is called, or done, is not known."""
    if flow.stack is None or flow.cfg.unresolved:
        return None
    deepest = flow.stack
    for index in live:
        frame = 0 if flow.cfg.edges[index].kind is EdgeKind.TAIL_CALL else flow.stack
        contexts = flow.calls.get(index, ())
        if not contexts and flow.cfg.edges[index].callees:
            return None
        for key in contexts:
            depth = callees[key].stack if key in callees else None
            if depth is None:
                return None
            deepest = max(deepest, frame + depth)
    return deepest


_KINDS = {
    "branch": ProblemKind.BRANCH,
    "call": ProblemKind.CALL,
    "decode": ProblemKind.DECODE,
    "outside": ProblemKind.OUTSIDE,
    "supervisor": ProblemKind.SUPERVISOR,
    "limit": ProblemKind.LIMIT,
}


def unresolved(flow: FunctionFlow) -> Iterator[Problem]:
    """Holes of the graph and regions with several entries that flow analysis has not reported itself."""
    reported = {problem.address for problem in flow.problems}
    for hole in flow.cfg.unresolved:
        if hole.address not in reported:
            yield Problem(_KINDS[hole.kind.value], hole.message, hole.address, flow.cfg.name)
    if flow.nest.irreducible and not any(problem.kind is ProblemKind.IRREDUCIBLE for problem in flow.problems):
        for region in flow.nest.irreducible:
            first = min(flow.cfg.blocks[block].address for block in region)
            yield Problem(
                ProblemKind.IRREDUCIBLE, "a cycle that is entered in more than one place", first, flow.cfg.name
            )


def _unbounded(flow: FunctionFlow, live: tuple[int, ...]) -> tuple[Problem, ...]:
    """Loops that run (a back edge is feasible) and have no bound, where flow analysis did not say why."""
    return tuple(
        Problem(
            ProblemKind.LOOP,
            "the loop has no bound",
            flow.cfg.blocks[loop.header].address,
            flow.cfg.name,
        )
        for index, loop in enumerate(flow.nest.loops)
        if index not in flow.bounds and any(edge in live for edge in loop.back_edges)
    )
