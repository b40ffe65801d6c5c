"""Problems of a codel's WCET analysis as diagnostics: located in the source and the binary, with the fact that is
missing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Fix, Label, Severity
from mauve.lower.codels import CodelPlan
from mauve.model.model import Binary, Board, Deployment
from mauve.wcet.result import Problem, ProblemKind, WcetResult

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
    severity = Severity.WARNING if fallback else Severity.ERROR
    code = CODES[problem.kind]
    notes = ("the assumed or declared time is used instead",) if fallback else ()
    if problem.kind in (ProblemKind.SYMBOL, ProblemKind.NOT_A_FUNCTION):
        return _symbol(problem, code, plan, binary, severity, notes)
    primary = Label(plan.codel.span, "this codel")
    help_: Fix | None = None
    message = f"`{plan.id}` has no WCET: {problem.message}"
    if problem.kind is ProblemKind.LOOP:
        message = f"a loop of `{plan.id}` has no bound, so it has no WCET"
        at = f'"{problem.source}"' if problem.source else f"{problem.address or 0:#x}"
        text = f"add `loop {at} max N` to the binary of deployment `{deployment.name}`"
        help_ = Fix(text, (), Applicability.PLACEHOLDERS)
    elif problem.kind is ProblemKind.HARDWARE and problem.address is None:
        primary = Label(board.span, "this board")
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
    if problem.suggestions:
        near = " and ".join(f"`{other}`" for other in problem.suggestions[:3])
        notes = (f"it has {near}", *notes)
    if plan.symbol_span is not None:
        primary = Label(plan.symbol_span)
        help_ = Fix("name a function of the binary")
    else:
        primary = Label(binary.span, f"looked for `{plan.id}` by convention")
        help_ = Fix(f'bind it in the binary: `{plan.id} = "SYMBOL"`, or `assume {plan.id} wcet ...`')
    labels = (Label(plan.codel.span, "the codel"),)
    return Diagnostic(code, message, primary, severity, labels, "", notes, help_)


def unreadable(binary: Binary, message: str) -> Diagnostic:
    """MV502: there is no binary to analyse."""
    help_ = Fix("build it, or correct its path: it is relative to the model's file")
    return Diagnostic("MV502", message, Label(binary.span), help=help_)


def note_diagnostics(results: Sequence[WcetResult], binary: Binary) -> Iterator[Diagnostic]:
    """What the analysis noticed about flow facts: each fact once, at the place where it is written."""
    for result in results:
        for problem in result.notes:
            code, severity = NOTES.get(problem.kind, ("MV518", Severity.NOTE))
            fact = next((f for f in binary.loops if str(f.span) == problem.written), None)
            primary = Label(fact.span) if fact is not None else Label(binary.span, problem.written)
            yield Diagnostic(code, problem.message, primary, severity)
