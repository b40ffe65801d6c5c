"""Problems of functions that are analysed without a model, told as messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Severity
from mauve.verdict.binaries import CODES, NOTES, place
from mauve.wcet.result import Problem, ProblemKind, WcetResult

NAMED = 3
"""How many functions a message names before it counts the others."""


def function_diagnostics(path: str, results: Iterable[WcetResult]) -> Iterator[Diagnostic]:
    """Each problem once, with the functions that have no bound because of it; then what was noticed about facts.

    `path` names the executable for problems without a place of their own.
    """
    problems: dict[tuple[object, ...], tuple[Problem, list[str]]] = {}
    notes: dict[tuple[object, ...], Problem] = {}
    for result in results:
        for problem in result.problems:
            key = (problem.kind, problem.address, problem.message)
            problems.setdefault(key, (problem, []))[1].append(result.name)
        for note in result.notes:
            notes.setdefault((note.kind, note.written, note.message), note)
    for problem, names in problems.values():
        yield _problem(path, problem, names)
    for note in notes.values():
        code, severity = NOTES.get(note.kind, ("MV518", Severity.NOTE))
        yield Diagnostic(code, note.message, severity=severity, place=note.written or path)


def _problem(path: str, problem: Problem, names: list[str]) -> Diagnostic:
    if len(names) > 1:
        problem = replace(problem, call_path=())
    shown = ", ".join(f"`{name}`" for name in names[:NAMED])
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    located = problem.address is not None or problem.source
    notes = (f"so these have no WCET: {shown}{more}",) if located or len(names) > 1 else ()
    return Diagnostic(
        CODES[problem.kind], problem.message, place=place(problem) or path, notes=notes, help=_help(problem)
    )


def _help(problem: Problem) -> Fix | None:
    match problem.kind:
        case ProblemKind.LOOP:
            where = f'"{problem.source}"' if problem.source else f"{problem.address or 0:#x}"
            file, _, line = problem.source.rpartition(":")
            at = f'"{file}":{line}' if problem.source else where
            return Fix(f"give a bound in a file of flow facts: `loop {at} max N;`")
        case ProblemKind.SYMBOL if problem.suggestions:
            near = " or ".join(f"`{name}`" for name in problem.suggestions)
            return Fix(f"there is {near}")
        case _:
            return None
