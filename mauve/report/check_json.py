"""The result of a check as JSON, schema mauve.check/1 (docs/schema/check-1.schema.json). Times in picoseconds."""

from __future__ import annotations

from collections.abc import Sequence

from mauve.diagnostics.diagnostic import Diagnostic
from mauve.diagnostics.render_json import to_plain
from mauve.lower.codels import CodelTime
from mauve.lower.tasks import PlacedTask
from mauve.pipeline import CheckResult, DeploymentResult, NodeResult
from mauve.timing.bill import Bill, BillLine, worst_bill
from mauve.timing.task import Kind, trace_length

SCHEMA = "mauve.check/1"
TRACE_LENGTH = 64


def check_document(result: CheckResult, diagnostics: Sequence[Diagnostic], version: str) -> dict[str, object]:
    """The document: verdicts, codels, components and diagnostics."""
    errors = any(d.severity.value == "error" for d in diagnostics)
    return {
        "schema": SCHEMA,
        "tool": {"name": "mauvec", "version": version},
        "file": result.path,
        "holds": not errors and all(d.as_expected for d in result.deployments),
        "deployments": [_deployment(deployment) for deployment in result.deployments],
        "diagnostics": [to_plain(diagnostic) for diagnostic in diagnostics],
    }


def _deployment(result: DeploymentResult) -> dict[str, object]:
    deployment = result.deployment
    return {
        "name": deployment.name,
        "architecture": deployment.architecture.name,
        "complete": result.complete,
        "schedulable": result.holds,
        "expected_unschedulable": deployment.expect_unschedulable is not None,
        "codels": [_codel(codel) for codel in result.codels],
        "nodes": [_node(node) for node in result.nodes],
    }


def _codel(codel: CodelTime) -> dict[str, object]:
    result = codel.result
    return {
        "codel": str(codel.plan.id),
        "symbol": codel.plan.symbol,
        "binary": codel.binary or None,
        "wcet_ps": codel.time,
        "wcet_cycles": result.cycles if result else None,
        "origin": codel.source.value if codel.source else None,
        "flow_facts": sum(loop.origin is not None and loop.origin.value == "annotation" for loop in result.loops)
        if result
        else 0,
        "assumptions": list(result.assumptions) if result else [],
    }


def _node(node: NodeResult) -> dict[str, object]:
    board = node.tasks.node.board
    analysis = node.analysis
    total = sum(float(task.load) for task in analysis.tasks) if analysis else None
    return {
        "name": node.tasks.node.name,
        "board": board.name,
        "core": board.core,
        "frequency_hz": board.hertz,
        "load": total,
        "method": analysis.method.value if analysis else None,
        "components": [_task(placed, node) for placed in node.tasks.tasks],
    }


def _task(placed: PlacedTask, node: NodeResult) -> dict[str, object]:
    task = placed.task
    plain: dict[str, object] = {
        "name": task.name,
        "instances": [instance.name for instance in placed.instances],
        "period_ps": task.period,
        "priority": task.priority,
        "priority_default": bool(placed.priority.default),
        "deadline_ps": task.deadline,
        "deadline_default": bool(placed.deadline.default),
        "jitter_ps": task.jitter,
        "blocking_ps": task.blocking,
    }
    if node.analysis is None:
        return plain | {"wcrt_ps": None, "schedulable": False, "reason": "incomplete", "load": None, "trace_ps": []}
    result = node.analysis.result(task.name)
    analysed = node.analysis.task(task.name)
    length = min(TRACE_LENGTH, trace_length(task, [t for t in node.analysis.tasks if t.kind is Kind.TASK]))
    bill = worst_bill(node.analysis, task.name)
    return plain | {
        "wcrt_ps": result.wcrt,
        "slack_ps": result.slack,
        "schedulable": result.schedulable,
        "reason": result.reason.value if result.reason else None,
        "caveats": [caveat.value for caveat in result.caveats],
        "load": float(analysed.load),
        "trace_ps": list(analysed.trace(length)),
        "bill": _bill(bill) if bill else None,
    }


def _bill(bill: Bill) -> dict[str, object]:
    return {
        "job": bill.job,
        "window_ps": bill.window,
        "blocking_ps": bill.blocking,
        "own": _line(bill.own),
        "interference": [_line(line) for line in bill.others],
    }


def _line(line: BillLine) -> dict[str, object]:
    return {
        "task": line.task,
        "kind": line.kind.value,
        "jobs": line.jobs,
        "cost_ps": line.cost,
        "overhead_ps": line.overhead,
    }
