"""The WCETs of a deployment's codels from its binaries, and what went wrong told as diagnostics."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.lower.codels import CodelPlan, derivable, has_fallback
from mauve.lower.platform import flow_facts, wcet_board
from mauve.model.model import Binary, CodelId, Deployment, Interrupt
from mauve.records import changed
from mauve.verdict.binaries import BINARY_WIDE, note_diagnostics, problem_diagnostic, unreadable
from mauve.verdict.derivation import Derivation, declared_handlers
from mauve.verdict.facts import read_facts
from mauve.verdict.stale import check_stale
from mauve.wcet.result import Problem, ProblemKind, WcetResult

if TYPE_CHECKING:
    from mauve.wcet.batch import Progress
    from mauve.wcet.flow.facts import Fact


def derive(
    deployment: Deployment,
    plans: tuple[CodelPlan, ...],
    use_cache: bool,
    report: Report,
    workers: int = 1,
    progress: Progress | None = None,
) -> Derivation:
    """Analyse every codel in the binaries of the deployment, and the interrupt handlers named by symbol, in up to
    `workers` processes."""
    from mauve.wcet.batch import Settings, analyse_batch
    from mauve.wcet.cache import Cache

    found: dict[CodelId, tuple[WcetResult, Binary]] = {}
    handlers: dict[str, int] = {}
    complete = True
    _report_ideal_memory(deployment, report)
    for node, binary in derivable(deployment):
        wanted = [plan for plan in plans if node.name in plan.nodes and _belongs(plan, binary, found)]
        if (missing := _missing(binary)) is not None:
            complete = False
            report.add(unreadable(binary, missing))
            problem = Problem(ProblemKind.BINARY, missing)
            found |= {p.id: (WcetResult(p.symbol, None, None, None, problems=(problem,)), binary) for p in wanted}
            continue
        named = [i for i in node.interrupts if i.wcet is None and i.symbol is not None and i.name not in handlers]
        symbols = [plan.symbol for plan in wanted] + [i.symbol for i in named if i.symbol is not None]
        facts = _facts(binary, report)
        settings = Settings(wcet_board(node.board), facts, cache=use_cache)
        results = analyse_batch(binary.path, symbols, settings, workers, progress)
        for diagnostic in note_diagnostics(results, binary):
            report.add(diagnostic)
        check_stale(binary, Cache() if use_cache else None, report)
        for plan, result in zip(wanted, results, strict=False):
            found[plan.id] = (result, binary)
        for interrupt, result in zip(named, results[len(wanted) :], strict=True):
            if result.time is not None:
                handlers[interrupt.name] = result.time
            else:
                complete = False
                _report_handler(interrupt, result, binary, report)
    handlers |= declared_handlers(deployment)
    _report_problems(deployment, plans, found, report)
    kept = {plan.id: found[plan.id] for plan in plans if plan.id in found and not _silent(plan, found, deployment)}
    return Derivation(kept, handlers, complete)


def _report_ideal_memory(deployment: Deployment, report: Report) -> None:
    """MV519 for each board without a memory that programs are timed on: every access then takes one cycle."""
    boards = {node.board.name: node for node in deployment.nodes if node.binaries and not node.board.memories}
    for name, node in boards.items():
        message = f"the board `{name}` lists no memory, so no access waits: times are those of an ideal memory"
        help_ = Fix("describe it: `memory NAME at ADDRESS size SIZE wait WAIT`, `wait 0cycles` where it has none")
        labels = (Label(node.span, f"`{deployment.name}` times a binary on it"),)
        report.add(Diagnostic("MV519", message, Label(node.board.span), Severity.NOTE, labels, help=help_))


def _missing(binary: Binary) -> str | None:
    """Why there is no file to read; what is wrong inside it is for the analysis to say."""
    path = Path(binary.path)
    if path.is_file():
        return None
    return f"the binary `{binary.path}` {'is a directory' if path.is_dir() else 'does not exist'}"


def _belongs(plan: CodelPlan, binary: Binary, found: Mapping[CodelId, tuple[WcetResult, Binary]]) -> bool:
    """Whether to look for a codel in a binary: where it is bound to a symbol, or not found in an earlier one."""
    if any(codel == plan.id for codel, _, _ in binary.symbols):
        return True
    earlier = found.get(plan.id)
    return earlier is None or _only_missing(earlier[0])


def _only_missing(result: WcetResult) -> bool:
    """Whether the binary just does not have the function."""
    return bool(result.problems) and all(p.kind is ProblemKind.SYMBOL for p in result.problems)


def _silent(plan: CodelPlan, found: Mapping[CodelId, tuple[WcetResult, Binary]], deployment: Deployment) -> bool:
    """Whether a codel just is in no binary, by the name of convention, and has its time from elsewhere."""
    return plan.symbol_span is None and _only_missing(found[plan.id][0]) and has_fallback(plan, deployment)


def _facts(binary: Binary, report: Report) -> tuple[Fact, ...]:
    """The flow facts of a binary: those in the model and those of the files that it names."""
    written = (fact for path, span in binary.fact_files for fact in read_facts(path, span, report))
    return (*flow_facts(binary.facts), *written)


def _report_handler(interrupt: Interrupt, result: WcetResult, binary: Binary, report: Report) -> None:
    for problem in result.problems:
        message = f"the handler of the interrupt `{interrupt.name}` has no WCET: {problem.message}"
        report.add(Diagnostic("MV520", message, Label(interrupt.span), labels=(Label(binary.span, "the binary"),)))


def _report_problems(
    deployment: Deployment,
    plans: tuple[CodelPlan, ...],
    found: Mapping[CodelId, tuple[WcetResult, Binary]],
    report: Report,
) -> None:
    """A diagnostic for each problem, once for all codels that meet it. A function that is missing matters only where
    nothing else gives a time, or where its symbol was written."""
    boards = {binary.path: node.board for node, binary in derivable(deployment)}
    causes: dict[tuple[str, Problem], list[CodelPlan]] = {}
    for plan in plans:
        if plan.id in found and not _silent(plan, found, deployment):
            result, binary = found[plan.id]
            for problem in result.problems:
                causes.setdefault((binary.path, _cause(problem)), []).append(plan)
    places = Counter(_remedy(path, cause, affected) for (path, cause), affected in causes.items())
    for (path, cause), affected in causes.items():
        more = places.pop(_remedy(path, cause, affected), 0) - 1
        if more < 0:
            continue
        plan = affected[0]
        result, binary = found[plan.id]
        problem = next(p for p in result.problems if _cause(p) == cause)
        fallback = all(has_fallback(one, deployment) for one in affected)
        diagnostic = problem_diagnostic(problem, plan, binary, boards[path], deployment, fallback)
        report.add(_with_others(_with_places(diagnostic, more), affected[1:]))


def _remedy(path: str, cause: Problem, affected: list[CodelPlan]) -> tuple[object, ...]:
    """What is the same for problems that one change removes: only the first of them is told. The wrong processor, or a
    board without the memory of the code, shows at many places."""
    if cause.kind in (ProblemKind.HARDWARE, ProblemKind.OUTSIDE) and cause.address is not None:
        return (path, cause.kind, *(plan.id for plan in affected))
    return (path, cause)


def _with_places(diagnostic: Diagnostic, more: int) -> Diagnostic:
    if more == 0:
        return diagnostic
    text = f"the same holds for {more} more place{'s' if more > 1 else ''}"
    return changed(diagnostic, notes=(*diagnostic.notes, text))


def _cause(problem: Problem) -> Problem:
    """The problem without the way on which one codel comes to it."""
    return changed(problem, call_path=()) if problem.address is not None else problem


def _with_others(diagnostic: Diagnostic, others: list[CodelPlan]) -> Diagnostic:
    if not others or diagnostic.code in BINARY_WIDE:
        return diagnostic
    named = ", ".join(f"`{plan.id}`" for plan in others)
    return changed(diagnostic, notes=(*diagnostic.notes, f"the same keeps {named} from having a WCET"))
