"""What the modes of a mission say to its author: MV724, with the events that lead there and the bill."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report, Severity
from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.model.model import Deployment
from mauve.timing.bill import deadline_bill
from mauve.timing.response import Analysis
from mauve.units import format_time
from mauve.verdict.deadlines import bill_text
from mauve.verdict.mission_messages import run_text
from mauve.verdict.modes import Failing, ModesResult


def report_modes(result: ModesResult, deployment: Deployment, report: Report) -> None:
    """MV724 once for each task that misses a deadline in some mode or switch, at the shortest way there."""
    told: set[str] = set()
    for failing in result.failing:
        for node, analysis in failing.nodes:
            if analysis is None:
                continue
            for placed in node.tasks:
                name = placed.task.name
                if not analysis.result(name).schedulable and name not in told:
                    told.add(name)
                    report.add(_missed(result, failing, deployment, node, placed, analysis))


def _missed(
    result: ModesResult,
    failing: Failing,
    deployment: Deployment,
    node: NodeTasks,
    placed: PlacedTask,
    analysis: Analysis,
) -> Diagnostic:
    name, response = placed.task.name, analysis.result(placed.task.name)
    deadline = format_time(placed.task.deadline)
    where = "a switch" if failing.switch else "a mode"
    told = f"responds within {format_time(response.wcrt)}" if response.wcrt is not None else "has no bounded response"
    message = (
        f"in {where} of the mission `{result.mission.name}`, `{name}` {told}, its deadline is {deadline} "
        f"(deployment `{deployment.name}`)"
    )
    when = f"during the switch after {run_text(failing.events)}" if failing.switch else f"after {_run(failing)}"
    running = ", ".join(failing.instances) or "none"
    notes = [f"{when}; active of the mission's instances: {running}"]
    bill = deadline_bill(analysis, name) if response.wcrt is not None else None
    if bill is not None:
        notes.append(bill_text(bill, placed))
    elif response.reason is not None:
        notes.append(response.reason.value)
    severity = Severity.NOTE if deployment.expect_unschedulable is not None else Severity.ERROR
    labels = (Label(result.mission.span, "the mission"),)
    return Diagnostic("MV724", message, Label(placed.span), severity, labels, notes=tuple(notes))


def _run(failing: Failing) -> str:
    return run_text(failing.events) if failing.events else "no event: before the start"
