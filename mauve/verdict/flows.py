"""The verdict on flows: reaction time and data age of each, and MV606 with the bill where one is late or unbounded."""

from __future__ import annotations

from collections.abc import Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.lower.flows import flow_hops
from mauve.lower.placed import NodeTasks
from mauve.model.model import Deployment, Flow, Latency
from mauve.records import record
from mauve.timing import chains
from mauve.timing.response import Analysis
from mauve.units import format_time


@record
class FlowResult:
    """A flow in a deployment: both latencies with the share of each task, or None and the `reason`. `holds` says that
    what is asked of it is proven (always, where nothing is)."""

    flow: Flow
    tasks: tuple[str, ...]
    latencies: chains.ChainResult | None
    reason: str
    holds: bool


def check_flows(deployment: Deployment, nodes: Sequence[tuple[NodeTasks, Analysis | None]]) -> tuple[FlowResult, ...]:
    """The flows of a deployment whose tasks are all there."""
    return tuple(_check(flow, deployment, nodes) for flow in deployment.architecture.flows)


def report_flows(deployment: Deployment, flows: Sequence[FlowResult], report: Report) -> None:
    """Append MV606 for each flow that is late; notes where the deployment is expected to be unschedulable."""
    for flow in flows:
        if not flow.holds:
            report.add(_late(flow, deployment))


def _check(flow: Flow, deployment: Deployment, nodes: Sequence[tuple[NodeTasks, Analysis | None]]) -> FlowResult:
    passages = flow_hops(flow, deployment, nodes)
    tasks = tuple(passage.task for passage in passages)
    hops = [passage.hop for passage in passages if passage.hop is not None]
    if len(hops) < len(passages) or not hops:
        lost = next((passage.task for passage in passages if passage.hop is None), "")
        reason = f"the response of `{lost}` has no bound" if lost else "it passes no task of this deployment"
        return FlowResult(flow, tasks, None, reason, flow.within is None)
    latencies = chains.chain_latencies(hops)
    asked = _asked(flow, latencies)
    reason = next((one.unbounded for _, one in asked if one.total is None), "")
    within = flow.within.value if flow.within is not None else None
    late = within is not None and any(one.total is None or one.total > within for _, one in asked)
    return FlowResult(flow, tasks, latencies, reason, not late)


def _asked(flow: Flow, latencies: chains.ChainResult) -> list[tuple[str, chains.Latency]]:
    """The latencies that the bound of a flow is for."""
    every = [(Latency.REACTION, "reaction", latencies.reaction), (Latency.AGE, "data age", latencies.age)]
    return [(words, one) for kind, words, one in every if flow.latency in (kind, Latency.BOTH)]


def _late(found: FlowResult, deployment: Deployment) -> Diagnostic:
    flow = found.flow
    assert flow.within is not None
    severity = Severity.ERROR if deployment.expect_unschedulable is None else Severity.NOTE
    limit, where = format_time(flow.within.value), f"(deployment `{deployment.name}`)"
    labels = (Label(flow.within.span, "the bound"),) if flow.within.span else ()
    asked = _asked(flow, found.latencies) if found.latencies is not None else []
    late = [(words, one) for words, one in asked if one.total is None or one.total > flow.within.value]
    if found.latencies is None or any(one.total is None for _, one in late):
        words = next((words for words, one in late if one.total is None), "latency")
        message = f"the {words} of the flow `{flow.name}` has no bound {where}"
        return Diagnostic("MV606", message, Label(flow.span), severity, labels, notes=(found.reason,))
    words, worst = max(late, key=lambda one: one[1].total or 0)
    message = f"the {words} of the flow `{flow.name}` is up to {format_time(worst.total or 0)}, not {limit} {where}"
    notes = (share_text(words, worst),)
    dear = max(worst.shares, key=lambda share: share.wait)
    help_ = None
    if dear.wait:
        help_ = Fix(f"run `{dear.hop}` more often, or let the data wake it (`event port` and `sporadic`)")
    data: tuple[tuple[str, object], ...] = (("flow", flow.name), ("within_ps", flow.within.value), ("ps", worst.total))
    return Diagnostic("MV606", message, Label(flow.span), severity, labels, "", notes, help_, data)


def share_text(words: str, latency: chains.Latency) -> str:
    """The shares of a latency as lines that add up to it."""
    wait = "until it looks at the data" if words == "reaction" else "until the next output replaces its own"
    rows = [(format_time(share.total), share.hop, _share(share, wait)) for share in latency.shares]
    rows.append((format_time(latency.total or 0), "in all", ""))
    widths = [max(len(row[column]) for row in rows) for column in range(2)]
    lines = [f"{row[0]:>{widths[0]}}  {row[1]:<{widths[1]}}  {row[2]}".rstrip() for row in rows]
    return "\n".join([f"{words}, task by task:", *lines])


def _share(share: chains.Share, wait: str) -> str:
    parts = [f"{format_time(share.wait)} {wait}"] if share.wait else []
    if share.work:
        parts.append(f"{format_time(share.work)} response")
    return ", ".join(parts)
