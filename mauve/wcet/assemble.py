"""From the bounds of all functions of a program to the result of the analysed one: counts along the worst path, loops,
problems with the way to them, assumptions.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping

from mauve.records import changed
from mauve.units import cycles_to_time
from mauve.wcet.assumptions import ALWAYS, board_assumptions
from mauve.wcet.flow.result import ContextKey, FunctionFlow, ProgramFlow
from mauve.wcet.hardware.board import Board
from mauve.wcet.hardware.core import Core
from mauve.wcet.hardware.cost import return_waits
from mauve.wcet.ipet.bottom_up import FunctionBound, calls_of
from mauve.wcet.result import (
    BlockResult,
    BranchResult,
    CallResult,
    ExclusiveResult,
    LoopResult,
    Problem,
    ProblemKind,
    WcetResult,
)
from mauve.wcet.routines import told_as_one

Lines = Callable[[int], str]
"""The source line of an address as `file.c:41`, empty where there is none."""

Bounds = Mapping[ContextKey, FunctionBound]


def assemble(
    name: str,
    program: ProgramFlow,
    bounds: Bounds,
    core: Core,
    board: Board,
    board_problems: tuple[Problem, ...],
    lines: Lines,
) -> WcetResult:
    """The result for `program.entry`; `board_problems` are those that concern the board and not the code."""
    entry = bounds.get(program.entry)
    problems = _problems(program, bounds, board_problems, lines)
    cycles = None if entry is None or entry.cycles is None else entry.cycles + return_waits(core, board)
    if cycles is None and not problems:
        problems = (Problem(ProblemKind.LIMIT, f"the analysis of {name} is incomplete", program.entry[0] & ~1, name),)
    if problems:
        cycles = None
    executions = _executions(program, bounds) if cycles is not None else {}
    return WcetResult(
        name=name,
        address=program.entry[0] & ~1,
        cycles=cycles,
        time=None if cycles is None else cycles_to_time(cycles, board.hertz),
        blocks=_blocks(program, bounds, executions, lines),
        loops=_loops(program, lines),
        calls=_calls(program, bounds, executions),
        problems=problems,
        notes=tuple(_located(note, lines) for note in program.notes),
        assumptions=tuple(dict.fromkeys((*ALWAYS, *board_assumptions(core, board), *program.assumptions))),
        stack=None if entry is None else entry.stack,
        exclusive=_exclusive(program, bounds, executions, lines),
    )


def _executions(program: ProgramFlow, bounds: Bounds) -> dict[ContextKey, int]:
    """How often the worst path of the entry executes every function: callers before callees."""
    executions = dict.fromkeys(program.functions, 0)
    executions[program.entry] = 1
    for key in reversed(tuple(program.functions)):
        bound = bounds[key]
        for edge, callee in (bound.chosen or {}).items():
            executions[callee] += executions[key] * bound.counts[edge]
    return executions


def _blocks(
    program: ProgramFlow, bounds: Bounds, executions: Mapping[ContextKey, int], lines: Lines
) -> tuple[BlockResult, ...]:
    """The blocks on the worst path by address; contexts of one function are added up."""
    found: dict[tuple[int, str, int], list[int]] = {}
    for key, times in executions.items():
        cfg, bound = program.functions[key].cfg, bounds[key]
        for index, count in enumerate(bound.counts):
            if count and times:
                block = cfg.blocks[cfg.edges[index].source]
                entry = found.setdefault((block.address, cfg.name, block.size), [0, 0, 0])
                entry[0] += count * times
                entry[1] = max(entry[1], bound.own[index])
                entry[2] += count * times * bound.own[index]
    return tuple(
        BlockResult(address, size, name, count, cycles, lines(address), total)
        for (address, name, size), (count, cycles, total) in sorted(found.items())
    )


def _loops(program: ProgramFlow, lines: Lines) -> tuple[LoopResult, ...]:
    """All loops of all functions and contexts reached, by address; equal ones once."""
    found: dict[LoopResult, None] = {}
    for key, flow in program.functions.items():
        for index, loop in enumerate(flow.nest.loops):
            header = flow.cfg.blocks[loop.header].address
            bound = flow.bounds.get(index)
            found[
                LoopResult(
                    header=header,
                    function=flow.cfg.name,
                    source=lines(header),
                    bound=None if bound is None else bound.bound,
                    total=None if bound is None else bound.total,
                    origin=None if bound is None else bound.origin,
                    method="" if bound is None else bound.method,
                    context=program.words.get(key, key[1]),
                )
            ] = None
    return tuple(sorted(found, key=lambda loop: (loop.header, loop.function, loop.context)))


def _exclusive(
    program: ProgramFlow, bounds: Bounds, executions: Mapping[ContextKey, int], lines: Lines
) -> tuple[ExclusiveResult, ...]:
    """The groups of branches that bound the functions on the worst path, equal ones once."""
    found: dict[ExclusiveResult, None] = {}
    for key, times in executions.items():
        flow = program.functions[key]
        for number in bounds[key].never if times else ():
            group = flow.exclusive[number]
            branches: dict[BranchResult, None] = {}
            for edge, condition in zip(group.edges, group.conditions, strict=True):
                if edge not in flow.infeasible:
                    address = flow.cfg.blocks[flow.cfg.edges[edge].source].instructions[-1].address
                    branches[BranchResult(address, lines(address), condition)] = None
            loop = None if group.loop is None else flow.cfg.blocks[flow.nest.loops[group.loop].header].address
            found[ExclusiveResult(flow.cfg.name, loop, tuple(branches))] = None
    return tuple(sorted(found, key=lambda group: group.branches[0].address))


def _calls(
    program: ProgramFlow, bounds: Bounds, executions: Mapping[ContextKey, int]
) -> tuple[CallResult, ...]:
    """The functions that the worst path calls, directly or not: the greatest bound of a call, and how many calls."""
    found: dict[tuple[str, int], list[int]] = {}
    for key, times in executions.items():
        if key != program.entry and times:
            cfg = program.functions[key].cfg
            entry = found.setdefault((cfg.name, cfg.address), [0, 0])
            entry[0] += times
            entry[1] = max(entry[1], bounds[key].cycles or 0)
    return tuple(
        CallResult(name, address, count, cycles)
        for (name, address), (count, cycles) in sorted(found.items(), key=lambda item: item[0][1])
    )


def _problems(
    program: ProgramFlow, bounds: Bounds, board_problems: tuple[Problem, ...], lines: Lines
) -> tuple[Problem, ...]:
    """Every reason once, with its source line and a shortest call path from the entry."""
    found: dict[tuple[object, ...], Problem] = {}
    paths = call_paths(program)
    inside = (
        changed(problem, call_path=problem.call_path or paths[key])
        for key, bound in bounds.items()
        if key in paths
        for problem in bound.problems
    )
    for problem in (*board_problems, *program.problems, *told_as_one(inside, program, lines)):
        located = _located(problem, lines)
        identity = (located.kind, located.address, located.message)
        known = found.get(identity)
        if known is None or len(located.call_path) < len(known.call_path):
            found[identity] = located
    return tuple(found.values())


def call_paths(program: ProgramFlow) -> dict[ContextKey, tuple[str, ...]]:
    """For every function that feasible calls reach: the names of the functions on a shortest way to it."""
    functions = program.functions
    if program.entry not in functions:
        return {}
    paths: dict[ContextKey, tuple[str, ...]] = {program.entry: (functions[program.entry].cfg.name,)}
    waiting = [program.entry]
    for key in waiting:
        for callee in _callees(functions[key]):
            if callee in functions and callee not in paths:
                paths[callee] = (*paths[key], functions[callee].cfg.name)
                waiting.append(callee)
    return paths


def _callees(flow: FunctionFlow) -> Iterator[ContextKey]:
    return (callee for _, callee in calls_of(flow))


def _located(problem: Problem, lines: Lines) -> Problem:
    if problem.source or problem.address is None:
        return problem
    return changed(problem, source=lines(problem.address))
