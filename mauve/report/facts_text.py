"""The flow facts that are missing, as a template to fill in: of a model, or in OTAWA's words."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from pathlib import PurePath

from mauve.wcet.flow.facts import AtAddress, AtLine, AtSymbol, Place
from mauve.wcet.missing import MissingIn, MissingLoop
from mauve.wcet.result import Problem, ProblemKind

POINTERS = (ProblemKind.BRANCH, ProblemKind.CALL)


_CANDIDATES = "all whose address is taken"


_PLACEHOLDER = re.compile(r"N(?=B?$)")
"""Where a suggestion waits for a number."""

HEAD = (
    "// What bounds still need: a number for each `?`. At a source line it is how often the loop's body runs each time",
    "// the loop is entered, at a symbol how often the block there runs. It must hold in every run: nobody checks it.",
)


def format_model(elf: str, missing: Sequence[MissingIn]) -> str:
    """The facts as a `binary` of a model: loops nested as they are, a `?` for each number."""
    lines = ["mauve 1", *HEAD, f'binary "{elf}" {{']
    for one in missing:
        lines += [f"  // {_where(one)}", *_model_lines(one)]
    return "\n".join([*lines, "}", ""])


def format_ff(elf: str, missing: Sequence[MissingIn]) -> str:
    """The facts as OTAWA's .ff file. Its numbers count passes along back edges: times that the loop goes on."""
    lines = [f"// What the bounds of {PurePath(elf).name} still need: for each `?` how often the loop goes on at most"]
    for one in missing:
        lines += ["", f"// {_where(one)}"]
        for loop, depth in _flat(one.loops):
            indent, about = "  " * depth, _about(loop)
            if loop.bound is None:
                lines.append(f"{indent}loop {_ff_place(loop.place)} max ?;  // {about}")
        for problem in one.others:
            word = "multicall" if problem.kind is ProblemKind.CALL else "multibranch"
            if problem.kind in POINTERS and problem.address is not None:
                lines.append(f"{word} {problem.address:#x} to ?;  // {problem.message}")
                lines += [f"// {_CANDIDATES}: {_named(fact)}" for fact in problem.suggestions]
            else:
                lines.append(f"// no fact helps: {problem.message}")
    return "\n".join([*lines, ""])


def _where(one: MissingIn) -> str:
    callers = one.callers[:-1]
    return f"in {one.function}" + (f", called by {' -> '.join(callers)}" if callers else "")


def _model_lines(one: MissingIn) -> Iterator[str]:
    for loop, depth in _flat(one.loops):
        indent = "  " * (depth + 1)
        if loop.bound is None:
            yield f"{indent}loop {_model_place(loop.place)} max ?  // {_about(loop)}"
        else:
            yield f"{indent}// {_about(loop)}: {loop.bound} executions of its header"
    for problem in one.others:
        if problem.suggestions and problem.kind is ProblemKind.LOOP:
            templates = (_PLACEHOLDER.sub("?", suggested) for suggested in problem.suggestions)
            yield from (f"  {template}  // {_told(problem)}" for template in templates)
        elif problem.kind in POINTERS and problem.address is not None:
            yield f"  targets {problem.address:#x} to ?  // {_told(problem)}"
            yield from (f"  // {_CANDIDATES}: {_named(fact)}" for fact in problem.suggestions)
        elif problem.kind is ProblemKind.RECURSION:
            yield f'  recursion "{problem.function}" max ?  // {_told(problem)}'
        else:
            yield f"  // no fact helps: {_told(problem)}"


def _named(fact: str) -> str:
    """The targets of a suggested fact."""
    return fact.partition(" to ")[2]


def _flat(loops: Sequence[MissingLoop], depth: int = 0) -> Iterator[tuple[MissingLoop, int]]:
    for loop in loops:
        yield loop, depth
        yield from _flat(loop.inner, depth + 1)


def _about(loop: MissingLoop) -> str:
    parts = [f"the loop at {loop.address:#x}"]
    if not isinstance(loop.place, AtLine) and loop.source:
        parts.append(loop.source)
    if loop.copies > 1:
        parts.append(f"{loop.copies} copies of it")
    return ", ".join(parts)


def _told(problem: Problem) -> str:
    return f"{problem.source}: {problem.message}" if problem.source else problem.message


def _model_place(place: Place) -> str:
    match place:
        case AtLine(file, line):
            return f'"{file}:{line}"'
        case AtSymbol(symbol, offset):
            return f'"{symbol}"' + (f"+{offset:#x}" if offset else "")
        case AtAddress(address):
            return f"{address:#x}"


def _ff_place(place: Place) -> str:
    return f'"{place.file}":{place.line}' if isinstance(place, AtLine) else _model_place(place)
