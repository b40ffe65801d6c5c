"""The integer linear program of one function as text, for people and for other solvers."""

from __future__ import annotations

from pathlib import Path

from mauve.wcet.batch import Settings


def linear_program(path: str | Path, function: str, settings: Settings) -> str | None:
    """The program of the function in the LP file format; the bounds of its callees are in the costs of the calls.

    None where the function has no bound; `analysis.analyse` says why.
    """
    from mauve.wcet.binary.elf import ElfProblem, load
    from mauve.wcet.flow.program import analyse_program
    from mauve.wcet.hardware.core import load_core
    from mauve.wcet.hardware.cost import return_waits
    from mauve.wcet.ipet.bottom_up import bound_program, function_problem
    from mauve.wcet.ipet.program import format_program

    board = settings.board
    binary, core = load(path), load_core(board.core)
    if isinstance(binary, ElfProblem) or core is None:
        return None
    symbol = binary.function(function)
    if isinstance(symbol, ElfProblem):
        return None
    program = analyse_program(
        binary, symbol.key, board, settings.facts, initial_data=settings.initial_data, timeout=settings.timeout
    )
    bounds = bound_program(program, core, board)
    bound = bounds.get(program.entry)
    if bound is None or bound.cycles is None:
        return None
    flow = program.functions[program.entry]
    costs = list(bound.own)
    for edge, callee in (bound.chosen or {}).items():
        costs[edge] += bounds[callee].cycles or 0
    problem = function_problem(flow, tuple(costs))
    waits = return_waits(core, board)
    head = [f"\\ {symbol.name} on {board.name} ({board.core}), bounds of callees in the costs of calls"]
    head += [f"\\ WCET: the maximum and {waits} cycles of the return"] if waits else ["\\ WCET: the maximum"]
    return "\n".join(head) + "\n" + format_program(problem)
