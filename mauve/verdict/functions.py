"""Problems of functions that are analysed without a model, told as messages."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Severity
from mauve.records import changed
from mauve.verdict.binaries import CODES, NOTES, place
from mauve.verdict.fact_notes import collected_notes
from mauve.wcet.result import Problem, ProblemKind, WcetResult
from mauve.wcet.routines import is_told

NAMED = 3
"""How many functions a message names before it counts the others."""


def function_diagnostics(
    path: str, results: Iterable[WcetResult], near: Mapping[str, tuple[str, ...]]
) -> Iterator[Diagnostic]:
    """Each problem once, with the functions that have no bound because of it; then what was noticed about facts.

    `path` names the executable for problems without a place of their own; `near` gives the functions that a name may
    stand for.
    """
    problems: dict[tuple[object, ...], tuple[Problem, list[str]]] = {}
    results = tuple(results)
    for result in results:
        for problem in result.problems:
            key = (problem.kind, problem.address, problem.message)
            problems.setdefault(key, (problem, []))[1].append(result.name)
    for problem, names in problems.values():
        yield _problem(path, problem, names, near.get(names[0], ()))
    for note in collected_notes(results):
        code, severity = NOTES.get(note.kind, ("MV518", Severity.NOTE))
        yield Diagnostic(code, note.message, severity=severity, place=note.written or path)


def problem_diagnostic(path: str, problem: Problem, near: tuple[str, ...]) -> Diagnostic:
    """What is wrong with an executable or one function; `near` are functions that its name may stand for."""
    return _problem(path, problem, [""], near)


def _problem(path: str, problem: Problem, names: list[str], near: tuple[str, ...]) -> Diagnostic:
    if len(names) > 1:
        problem = changed(problem, call_path=())
    message = problem.message
    if problem.kind is ProblemKind.SYMBOL and near:
        message += f"; it has {' and '.join(f'`{name}`' for name in near)}"
    if len(names) > 1:
        shown = ", ".join(names[:NAMED]) + (f" and {len(names) - NAMED} more" if len(names) > NAMED else "")
        message += f": no WCET of {shown}"
    known = problem.address is not None and f"{problem.address:#x}" in message and not problem.call_path[1:]
    where = problem.source if known and problem.source else place(problem)
    return Diagnostic(CODES[problem.kind], message, place=where or path, help=_help(problem))


def _help(problem: Problem) -> Fix | None:
    """The fact that is missing, as it stands in a file of flow facts."""
    if problem.kind in (ProblemKind.CALL, ProblemKind.BRANCH) and problem.suggestions:
        fact = problem.suggestions[0]
        return Fix(f"state those of them that it goes to, in a model's `binary` or with `--facts`: `{fact}`")
    if problem.kind is not ProblemKind.LOOP:
        return None
    if problem.suggestions:
        return Fix(f"give it in a model's `binary`, or with `--facts` in a file of facts: `{problem.suggestions[0]}`")
    if is_told(problem):
        return None
    file, _, line = problem.source.rpartition(":")
    where = f'"{file}":{line}' if file else f"{problem.address or 0:#x}"
    return Fix(f"give a bound in a file of flow facts: `loop {where} max N;`")
