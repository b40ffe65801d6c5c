"""Problems of a codel's WCET analysis as diagnostics: located in the source and the binary, with the fact that is
missing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Fix, Label, Severity
from mauve.lower.codels import CodelPlan
from mauve.model.model import Binary, Board, Deployment
from mauve.model.names import unknown
from mauve.records import changed
from mauve.verdict.fact_notes import collected_notes
from mauve.wcet.result import Problem, ProblemKind, WcetResult
from mauve.wcet.routines import is_told

CODES = {
    ProblemKind.LOOP: "MV511",
    ProblemKind.IRREDUCIBLE: "MV512",
    ProblemKind.BRANCH: "MV507",
    ProblemKind.CALL: "MV507",
    ProblemKind.SUPERVISOR: "MV507",
    ProblemKind.RECURSION: "MV508",
    ProblemKind.DECODE: "MV506",
    ProblemKind.OUTSIDE: "MV509",
    ProblemKind.SYMBOL: "MV501",
    ProblemKind.BINARY: "MV502",
    ProblemKind.NOT_ARM: "MV503",
    ProblemKind.NOT_A_FUNCTION: "MV505",
    ProblemKind.LIMIT: "MV517",
    ProblemKind.HARDWARE: "MV510",
    ProblemKind.NO_RETURN: "MV508",
    ProblemKind.FACT_NOWHERE: "MV514",
    ProblemKind.FACT_CONTRADICTED: "MV515",
}

BINARY_WIDE = frozenset({"MV502", "MV503", "MV510", "MV513"})
"""Codes of problems that do not depend on the codel."""

NOTES = {
    ProblemKind.FACT_NOWHERE: ("MV514", Severity.ERROR),
    ProblemKind.FACT_CONTRADICTED: ("MV515", Severity.ERROR),
    ProblemKind.FACT_SEVERAL: ("MV518", Severity.NOTE),
    ProblemKind.FACT_LOOSE: ("MV518", Severity.NOTE),
}
"""The code and severity of what the analysis notices about flow facts."""


def problem_diagnostic(
    problem: Problem, plan: CodelPlan, binary: Binary, board: Board, deployment: Deployment, fallback: bool
) -> Diagnostic:
    """One reason why a codel has no bound. A warning where an assumed or declared time stands in (`fallback`)."""
    if problem.kind in (ProblemKind.BINARY, ProblemKind.NOT_ARM):
        return unreadable(binary, problem.message, CODES[problem.kind])
    severity = Severity.WARNING if fallback else Severity.ERROR
    code = CODES[problem.kind]
    if problem.kind is ProblemKind.HARDWARE and problem.address is None:
        return _hardware(problem, board, severity)
    notes = ("the assumed or declared time is used instead",) if fallback else ()
    if problem.kind in (ProblemKind.SYMBOL, ProblemKind.NOT_A_FUNCTION):
        return _symbol(problem, code, plan, binary, severity, notes)
    primary = Label(plan.codel.span, "this codel")
    help_: Fix | None = None
    message = f"`{plan.id}` has no WCET: {problem.message}"
    if problem.kind is ProblemKind.HARDWARE:
        help_ = Fix(f"compile it for the board's processor, as by `-mcpu={board.core}`, or `assume {plan.id} wcet ...`")
    if problem.kind in (ProblemKind.CALL, ProblemKind.BRANCH) and problem.suggestions:
        fact = problem.suggestions[0]
        text = f"state those of them that it goes to in the binary of deployment `{deployment.name}`: `{fact}`"
        help_ = Fix(text, (), Applicability.PLACEHOLDERS)
    if problem.kind is ProblemKind.LOOP and problem.suggestions:
        text = f"add `{problem.suggestions[0]}` to the binary of deployment `{deployment.name}`"
        help_ = Fix(text, (), Applicability.PLACEHOLDERS)
    elif problem.kind is ProblemKind.LOOP and not is_told(problem):
        message = f"a loop of `{plan.id}` has no bound, so it has no WCET"
        at = f'"{problem.source}"' if problem.source else f"{problem.address or 0:#x}"
        text = f"add `loop {at} max N` to the binary of deployment `{deployment.name}`"
        help_ = Fix(text, (), Applicability.PLACEHOLDERS)
    labels = (Label(binary.span, "the binary"),)
    return Diagnostic(code, message, primary, severity, labels, place(problem), notes, help_)


def place(problem: Problem) -> str:
    """Where in the source and the binary: `fusion.c:41 (0x8a34, in mat_invert, called from statefusion_update)`."""
    inside = [f"{problem.address:#x}"] if problem.address is not None else []
    if problem.function:
        inside.append(f"in {problem.function}")
    callers = [name for name in problem.call_path if name != problem.function]
    if callers:
        inside.append("called from " + ", ".join(reversed(callers)))
    details = ", ".join(inside)
    if problem.source:
        return f"{problem.source} ({details})" if details else problem.source
    return details


def _symbol(
    problem: Problem, code: str, plan: CodelPlan, binary: Binary, severity: Severity, notes: tuple[str, ...]
) -> Diagnostic:
    name = binary.span.text.strip('"')
    what = "function" if code == "MV501" else "code at"
    message = f"`{name}` has no {what} `{plan.symbol}`"
    if problem.kind is ProblemKind.SYMBOL:
        from mauve.wcet.batch import near_names

        near = near_names(binary.path, plan.symbol)[:3]
        reason = problem.message.partition(": ")[2]
        if reason:
            notes = (reason, *notes)
        if near:
            notes = ("it has " + " and ".join(f"`{other}`" for other in near), *notes)
    if plan.symbol_span is not None:
        primary = Label(plan.symbol_span)
        help_ = Fix("name a function of the binary")
    else:
        primary = Label(binary.span, f"looked for `{plan.id}` by convention")
        help_ = Fix(f'bind it in the binary: `{plan.id} = "SYMBOL"`, or `assume {plan.id} wcet ...`')
    labels = (Label(plan.codel.span, "the codel"),)
    return Diagnostic(code, message, primary, severity, labels, "", notes, help_)


def unreadable(binary: Binary, message: str, code: str = "MV502") -> Diagnostic:
    """There is no binary to analyse, whatever the codel."""
    help_ = Fix("build it for the board's processor, or correct its path: it is relative to the model's file")
    return Diagnostic(code, message, Label(binary.span), help=help_)


def _hardware(problem: Problem, board: Board, severity: Severity) -> Diagnostic:
    """What the board has and the analysis does not model, whatever the codel."""
    from mauve.wcet.hardware.core import core_names, load_core

    if load_core(board.core) is not None:
        feature = next((f for f in board.features if f.name in problem.message), None)
        primary = Label(feature.span) if feature else Label(board.span, "this board")
        return Diagnostic("MV510", problem.message, primary, severity, place=place(problem))
    found = unknown("MV513", problem.message, "not modelled", board.core_span, core_names(), "a core")
    if found.help is None:
        found = changed(found, notes=("the cores are " + ", ".join(f"`{name}`" for name in core_names()),))
    return changed(found, severity=severity)


def note_diagnostics(results: Sequence[WcetResult], binary: Binary) -> Iterator[Diagnostic]:
    """What the analysis noticed about flow facts: each fact once, at the place where it is written."""
    for problem in collected_notes(results):
        code, severity = NOTES.get(problem.kind, ("MV518", Severity.NOTE))
        fact = next((f for f in binary.facts if str(f.span) == problem.written), None)
        primary = Label(fact.span) if fact is not None else Label(binary.span, problem.written)
        yield Diagnostic(code, problem.message, primary, severity)
