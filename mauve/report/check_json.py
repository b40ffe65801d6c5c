"""The result of a check as JSON, schema mauve.check/1 (docs/schema/check-1.schema.json). Times in picoseconds."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Severity
from mauve.diagnostics.render_json import to_plain
from mauve.lower.codels import CodelTime
from mauve.lower.placed import PlacedTask
from mauve.records import changed
from mauve.report.details import bill_plain, details_plain
from mauve.report.flows import flow_plain
from mauve.timing.bill import deadline_bill, worst_bill
from mauve.timing.response import Analysis, ResponseResult
from mauve.timing.task import Kind, Task, trace_length
from mauve.verdict.result import CheckResult, DeploymentResult, NodeResult, executed
from mauve.verdict.stack import stack_use
from mauve.wcet import serialize
from mauve.wcet.result import WcetResult

SCHEMA = "mauve.check/1"

TRACE_LENGTH = 64
"""At most so many elements of a trace are listed."""

ANALYSIS = ("address", "loops", "calls", "unresolved", "notes", "assumptions", "stack_bytes")
"""What a codel's analysis shares with a function of mauve.wcet/1."""


def check_document(result: CheckResult, diagnostics: Sequence[Diagnostic], version: str) -> dict[str, object]:
    """The document: verdicts, codels with the origin of their times, components with their bills, and diagnostics.

    `holds` is true exactly when `mauvec check` exits with 0.
    """
    errors = any(d.severity is Severity.ERROR for d in diagnostics)
    missions = result.missions
    document: dict[str, object] = {
        "schema": SCHEMA,
        "tool": {"name": "mauvec", "version": version},
        "file": result.path,
        "holds": not errors and all(d.as_expected for d in result.deployments) and all(m.holds for m in missions),
        "deployments": [_deployment(deployment) for deployment in result.deployments],
        "diagnostics": [to_plain(diagnostic) for diagnostic in diagnostics],
    }
    if missions:
        from mauve.report.mission_json import mission_document

        document["missions"] = mission_document(missions)["missions"]
    return document


def _deployment(result: DeploymentResult) -> dict[str, object]:
    """A deployment; where the modes of a mission count, responses are the worst of any mode, and have no bill."""
    deployment = result.deployment
    worst: Mapping[str, ResponseResult] | None = None
    modes: dict[str, object] = {}
    if result.modes:
        from mauve.report.modes_json import modes_document
        from mauve.verdict.modes import worst_responses

        worst = worst_responses(result.modes)
        modes = {"mission_modes": [modes_document(one) for one in result.modes]}
    return {
        "name": deployment.name,
        "architecture": deployment.architecture.name,
        "complete": result.complete,
        "schedulable": result.schedulable if result.complete else None,
        "holds": result.holds if result.complete else None,
        "expected_unschedulable": deployment.expect_unschedulable is not None,
        "codels": [_codel(codel) for codel in result.codels],
        "flows": [flow_plain(flow) for flow in result.flows],
        "nodes": [_node(node, result, worst) for node in result.nodes],
        **modes,
        **_varied(result),
    }


def _varied(result: DeploymentResult) -> dict[str, object]:
    """What is there where it was asked for only."""
    if not result.sensitivity and not result.proposals:
        return {}
    from mauve.report.sensitivity import proposals_plain, sensitivity_plain

    found: dict[str, object] = {}
    if result.sensitivity:
        found["sensitivity"] = sensitivity_plain(result.sensitivity)
    if result.proposals:
        found["priorities"] = proposals_plain(result.proposals)
    return found


# ---------------------------------------------------------------------------------------------------------- codels
def _codel(codel: CodelTime) -> dict[str, object]:
    """A codel's time and where it comes from; `analysis` is what the binary says, whichever time counts."""
    result = codel.result
    return {
        "codel": str(codel.plan.id),
        "symbol": codel.plan.symbol,
        "binary": codel.binary or None,
        "wcet_ps": codel.time,
        "wcet_cycles": result.cycles if result else None,
        "origin": codel.source.value if codel.source else None,
        "analysis": _analysis(result) if result else None,
    }


def _analysis(result: WcetResult) -> dict[str, object]:
    whole = serialize.function(result)
    return {name: whole[name] for name in ANALYSIS}


# ------------------------------------------------------------------------------------------------------ components
def _node(
    node: NodeResult, result: DeploymentResult, worst: Mapping[str, ResponseResult] | None
) -> dict[str, object]:
    board = node.tasks.node.board
    analysis = node.analysis
    return {
        "name": node.tasks.node.name,
        "board": board.name,
        "core": board.core,
        "frequency_hz": board.hertz,
        "context_switch_ps": board.context_switch,
        "load": sum(float(task.interferer.load) for task in analysis.tasks) if analysis else None,
        "method": analysis.method.value if analysis else None,
        "components": [_component(p, analysis, result, worst) for p in node.tasks.tasks] if analysis else [],
        "overheads": [_overhead(task) for task in analysis.tasks if task.kind is not Kind.TASK] if analysis else [],
    }


def _overhead(task: Task) -> dict[str, object]:
    return {
        "name": task.name,
        "kind": task.kind.value,
        "period_ps": task.period,
        "cost_ps": task.demand(1),
        "load": float(task.load),
    }


def _component(
    placed: PlacedTask,
    analysis: Analysis,
    deployment: DeploymentResult,
    worst: Mapping[str, ResponseResult] | None,
) -> dict[str, object]:
    task = placed.task
    result = analysis.result(task.name)
    if worst is not None:
        result = worst.get(task.name, changed(result, wcrt=0, reason=None))
    stack = stack_use(placed, deployment.codels)
    analysed = executed(placed, analysis)
    length = min(TRACE_LENGTH, trace_length(task, [t for t in analysis.tasks if t.kind is Kind.TASK]))
    return {
        "name": task.name,
        "instances": [instance.name for instance in placed.instances],
        "period_ps": task.period,
        "priority": task.priority,
        "priority_default": bool(placed.priority.default),
        "deadline_ps": task.deadline,
        "deadline_default": bool(placed.deadline.default),
        "jitter_ps": task.jitter,
        "blocking_ps": analysed.blocking,
        "waits": [{"operation": wait.operation, "wait_ps": wait.time} for wait in placed.waits],
        "load": float(analysed.load),
        "trace_ps": list(analysed.trace(length)),
        "stack_bytes": stack.size if stack is not None else None,
        "stack_codel": stack.codel if stack is not None else None,
        **_response(result, deployment.complete),
        "bill": bill_plain(worst_bill(analysis, task.name), placed) if worst is None else None,
        "miss": bill_plain(deadline_bill(analysis, task.name), placed) if worst is None else None,
        **details_plain(placed, analysis),
    }


def _response(result: ResponseResult, complete: bool) -> dict[str, object]:
    """In an incomplete deployment a response is only what it is at least, and only a miss is certain."""
    certain = complete or not result.schedulable
    reason = result.reason.value if result.reason else None
    return {
        "wcrt_ps": result.wcrt if complete else None,
        "wcrt_at_least_ps": result.wcrt,
        "slack_ps": result.slack if complete else None,
        "schedulable": result.schedulable if certain else None,
        "reason": reason if certain else "incomplete",
        "caveats": [caveat.value for caveat in result.caveats],
    }
