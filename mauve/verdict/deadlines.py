"""The verdict on deadlines: each one missed as a diagnostic with its bill, overloads, and expectations that failed."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.lower.activation import is_settled
from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.model.model import Deployment
from mauve.timing.response import UNSOUND, Analysis, Reason, ResponseResult
from mauve.timing.task import Kind
from mauve.units import format_time

if TYPE_CHECKING:
    from mauve.timing.bill import Bill, BillLine
    from mauve.timing.shrink import Shrink


MOST_ORDERED = 50
"""Tasks of a node up to which a missed deadline makes one look for better priorities."""


def report_node(deployment: Deployment, node: NodeTasks, analysis: Analysis, report: Report) -> None:
    """Append MV601 for each missed deadline, MV602 for an overload, MV603 where the chosen method is not sound.

    In a deployment that is expected to be unschedulable they are notes.
    """
    expected = deployment.expect_unschedulable is not None
    severity = Severity.NOTE if expected else Severity.ERROR
    overloaded = [r for r in analysis.results if r.reason is Reason.OVERLOAD]
    if overloaded:
        report.add(_overload(deployment, node, analysis, overloaded[0], severity))
    order = _better_order(deployment, node, analysis) if not overloaded else ()
    for placed in node.tasks:
        result = analysis.result(placed.task.name)
        if result.reason in (Reason.FULL_LOAD, Reason.LIMIT, Reason.ARRIVALS, Reason.WAITS):
            report.add(_unbounded(deployment, placed, result, severity))
        elif not result.schedulable:
            report.add(_missed(deployment, placed, analysis, result, severity, order))
        for caveat in (c for c in result.caveats if c in UNSOUND):
            message = f"the response of `{placed.task.name}` by the paper's method may be too small: {caveat.value}"
            help_ = Fix("use `--method trace`, which covers this")
            report.add(Diagnostic("MV603", message, Label(placed.span), Severity.WARNING, help=help_))


def _better_order(deployment: Deployment, node: NodeTasks, analysis: Analysis) -> tuple[str, ...]:
    """The tasks in an order of priorities in which all deadlines hold; empty where none is found, or not looked for."""
    if analysis.schedulable or len(node.tasks) > MOST_ORDERED or not is_settled(deployment, (node,)):
        return ()
    from mauve.verdict.sensitivity import optimal_order

    return optimal_order(node, analysis)


def report_expectation(deployment: Deployment, holds: bool, complete: bool, report: Report) -> None:
    """MV604 when a deployment expected to miss a deadline holds them all."""
    span = deployment.expect_unschedulable
    if span is not None and holds and complete:
        message = f"the deployment `{deployment.name}` is expected to miss a deadline, but all of them hold"
        report.add(Diagnostic("MV604", message, Label(span), help=Fix("remove `expect unschedulable`")))


def _overload(
    deployment: Deployment, node: NodeTasks, analysis: Analysis, result: ResponseResult, severity: Severity
) -> Diagnostic:
    total = sum(float(task.interferer.load) for task in analysis.tasks)
    lines = [
        f"{100 * float(task.interferer.load):6.1f} %  {task.name}"
        for name in result.responsible
        for task in analysis.tasks
        if task.name == name
    ]
    message = f"the processor of node `{node.node.name}` is overloaded: {100 * total:.1f} % of its time is asked for"
    notes = ("in the long run:\n" + "\n".join(lines),)
    help_ = Fix("lengthen a period, shorten a codel, or move a component to another node")
    labels = (Label(deployment.span, "in this deployment"),)
    return Diagnostic("MV602", message, Label(node.node.span), severity, labels, "", notes, help_)


_BOUNDED_BY = {
    Reason.FULL_LOAD: "leave some slack: lengthen a period or shorten a codel",
    Reason.ARRIVALS: "let what wakes it run less often or respond sooner, or give the instance a period",
    Reason.WAITS: "run the owner of the operation more often, call it less often, or let it run in its caller",
}
"""What would bound a response, by why it has no bound."""


def _unbounded(deployment: Deployment, placed: PlacedTask, result: ResponseResult, severity: Severity) -> Diagnostic:
    reason = result.reason.value if result.reason else ""
    message = f"the response of `{placed.task.name}` has no bound (deployment `{deployment.name}`)"
    help_ = Fix(_BOUNDED_BY[result.reason]) if result.reason in _BOUNDED_BY else None
    return Diagnostic("MV605", message, Label(placed.span), severity, notes=(reason,), help=help_)


def _missed(
    deployment: Deployment,
    placed: PlacedTask,
    analysis: Analysis,
    result: ResponseResult,
    severity: Severity,
    order: tuple[str, ...],
) -> Diagnostic:
    from mauve.timing.bill import deadline_bill
    from mauve.timing.shrink import shrink_to_fit

    deadline = format_time(placed.task.deadline)
    where = f"(deployment `{deployment.name}`)"
    if result.wcrt is None:
        message = f"`{placed.task.name}` has no bound on its response, its deadline is {deadline} {where}"
    else:
        message = f"`{placed.task.name}` responds within {format_time(result.wcrt)}, its deadline is {deadline} {where}"
    labels = (Label(placed.deadline.span, "the deadline"),) if placed.deadline.span else ()
    bill = deadline_bill(analysis, placed.task.name)
    notes: tuple[str, ...] = (bill_text(bill, placed),) if bill is not None else ()
    if placed.deadline.default:
        notes += (f"no deadline is written, so it is {placed.deadline.default}",)
    if order:
        names = ", ".join(order)
        notes += (f"with other priorities all deadlines hold: {names}, most urgent first (see `--priorities optimal`)",)
    shrinks = shrink_to_fit(analysis, placed.task.name)
    data: tuple[tuple[str, object], ...] = (
        ("task", placed.task.name),
        ("response_ps", result.wcrt),
        ("deadline_ps", placed.task.deadline),
        ("due_ps", bill.due if bill else None),
    )
    return Diagnostic("MV601", message, Label(placed.span), severity, labels, "", notes, _shrink_help(shrinks), data)


def bill_text(bill: Bill, placed: PlacedTask, head: str = "") -> str:
    """The bill as lines: what is due by the deadline, dearest interferer first, the task's own work last."""
    which = "" if bill.job == 1 else f" of its job {bill.job}"
    head = head or f"by {format_time(bill.window)}{which}, {format_time(bill.due)} of work is due:"
    rows = [_row(line) for line in bill.others]
    if bill.blocking:
        blocker = placed.blocker
        who = f"`{blocker.holder}` once in {blocker.what}" if blocker else ""
        rows.append((format_time(bill.blocking), "blocking", who, ""))
    rows.append((format_time(bill.own.cost), "of its own", _own(bill.own), ""))
    widths = [max(len(row[column]) for row in rows) for column in range(2)]
    widths.append(max((len(row[2]) for row in rows if row[3]), default=0))
    lines = [f"{row[0]:>{widths[0]}}  {row[1]:<{widths[1]}}  {row[2]:<{widths[2]}}  {row[3]}".rstrip() for row in rows]
    return "\n".join([head, *lines])


def _row(line: BillLine) -> tuple[str, str, str, str]:
    each = format_time(-(-line.cost // line.jobs)) if line.jobs else "0ms"
    even = line.cost == line.jobs * (line.cost // line.jobs) if line.jobs else True
    count = f"{line.jobs} x {each}" if even else f"{line.jobs} jobs, up to {format_time(_dearest(line))} each"
    kind = f"(priority {line.priority})" if line.kind is Kind.TASK else f"({line.kind.value})"
    return format_time(line.cost), line.task, count, kind


def _dearest(line: BillLine) -> int:
    overhead = line.overhead // line.jobs if line.jobs else 0
    return overhead + sum(max(work.trace, default=work.cost) for work in line.work)


def _own(line: BillLine) -> str:
    """The transition that costs it, with its parts."""
    runs = [work.run[0] for work in line.work if work.run]
    words = []
    for transition in runs:
        parts = ", ".join(dict.fromkeys(str(part) for part in transition.parts if part.cost))
        words.append(f"{transition.source} -> {transition.target}: {parts}" if parts else "")
    if line.overhead:
        words.append(f"{format_time(line.overhead)} context switches")
    text = "; ".join(filter(None, words))
    return f"({text})" if text else ""


def _shrink_help(shrinks: tuple[Shrink, ...]) -> Fix | None:
    """The change of one contributor, the least in proportion, that makes the deadline hold."""
    from mauve.timing.shrink import What

    possible = [s for s in shrinks if s.at_most and s.what in (What.WORK, What.CODEL)]
    if not possible:
        return (
            Fix("no single component or codel can make it fit: lengthen the deadline or a period") if shrinks else None
        )
    best = sorted(possible, key=lambda s: (Fraction(s.now - (s.at_most or 0), s.now or 1), s.what is not What.CODEL))
    codel = next((s for s in best if s.what is What.CODEL), None)
    work = next((s for s in best if s.what is What.WORK), None)
    words = [
        f"`{s.name}` takes at most {format_time(s.at_most or 0, down=True)} (now {format_time(s.now)})"
        for s in (work, codel)
        if s is not None
    ]
    return Fix("it fits if " + ", or if ".join(words))
