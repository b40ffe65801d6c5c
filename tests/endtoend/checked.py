"""What the analysis says of a model, and what a simulation finds against it."""

from __future__ import annotations

from dataclasses import dataclass

from endtoend.interpreter import Observation, Simulation

from mauve.diagnostics.diagnostic import Report, Severity
from mauve.lower.activation import Settled, settle
from mauve.lower.codels import choose_times, plan_codels
from mauve.lower.machines import build_machines
from mauve.lower.placed import NodeTasks
from mauve.lower.platform import timing_platform
from mauve.lower.tasks import task_sets
from mauve.model.model import Deployment
from mauve.model.resolve import resolve
from mauve.source import SourceFile
from mauve.syntax.load import standard_module
from mauve.syntax.parse import parse
from mauve.timing.response import Analysis, Caveat, Method
from mauve.timing.traces import PsmCurve

UNSOUND = {Caveat.LATER_JOBS, Caveat.JITTER, Caveat.BLOCKING}
"""What the paper's method warns of."""

LENGTHS = 12
"""Consecutive activations whose total costs are compared with E(l)."""


@dataclass(frozen=True, slots=True)
class Checked:
    """A deployment of one node with its tasks and, per method, its responses."""

    deployment: Deployment
    times: dict[tuple[str, str], int]
    node: NodeTasks
    settled: dict[Method, Settled]

    def analysis(self, method: Method) -> Analysis:
        """The responses by a method."""
        found = self.settled[method].results[0]
        assert found is not None
        return found


def checked(text: str) -> tuple[Checked | None, list[str]]:
    """The analysis of the first deployment of a text; None with the messages of its errors."""
    report = Report()
    module = parse(SourceFile("random.mauve", text), report)
    lifecycle, boards = standard_module("lifecycle", report), standard_module("boards", report)
    assert lifecycle is not None and boards is not None
    model = None if report.has_errors else resolve((module, lifecycle), (boards,), report)
    if model is None or report.has_errors:
        return None, _errors(report)
    deployment = model.deployments[0]
    chosen = choose_times(plan_codels(deployment), deployment, {}, report)
    times = {codel.plan.id: codel.time for codel in chosen if codel.time is not None}
    placed = task_sets(deployment, build_machines(deployment, times), times, report)
    if report.has_errors or not all(node.complete for node in placed):
        return None, _errors(report)
    handlers = {one.name: one.wcet or 0 for one in placed[0].node.interrupts}
    platforms = [timing_platform(node.node, handlers) for node in placed]
    settled = {method: settle(deployment, placed, platforms, method) for method in Method}
    plain = {(id_.component, id_.codel): time for id_, time in times.items()}
    return Checked(deployment, plain, placed[0], settled), []


def _errors(report: Report) -> list[str]:
    return [
        f"{d.code} {d.primary.span if d.primary else ''}: {d.message}" for d in report if d.severity is Severity.ERROR
    ]


def observed(found: Checked, seed: int, horizon: int = 40, most: int = 400) -> Observation:
    """What one simulation sees; `horizon` is in longest periods, `most` in jobs."""
    simulation = Simulation(found.deployment, found.times, seed)
    simulation.set_priorities({one.task.name: one.task.priority for one in found.node.tasks})
    return simulation.run(horizon * max(one.task.period for one in found.node.tasks), most)


def violations(found: Checked, seed: int, most: int = 400) -> list[str]:
    """What one simulation observes above what was reported; empty as it must be.

    What may wait in a queue follows from the deadlines of its writers: where one is missed, no number is promised.
    """
    queues = any(connection.size is not None for connection in found.deployment.architecture.data)
    if queues and not found.analysis(Method.TRACE).schedulable:
        return []
    seen = observed(found, seed, most=most)
    faults: list[str] = []
    sure = found.analysis(Method.TRACE).schedulable
    for method in Method:
        analysis = found.analysis(method)
        for result in analysis.results:
            response = seen.responses.get(result.task, 0)
            if result.wcrt is None or UNSOUND & set(result.caveats):
                continue
            if response > result.wcrt:
                word = "schedulable" if sure else "not schedulable"
                faults.append(f"{method.value}: {result.task} responds in {response}, reported {result.wcrt} ({word})")
            if analysis.schedulable and response > result.deadline and method is not Method.PAPER:
                faults.append(f"{method.value}: {result.task} misses {result.deadline} with {response}")
    for one in found.node.tasks:
        for machine in one.machines:
            faults += _costs(str(machine.region), PsmCurve(machine.psm), seen.costs.get(str(machine.region), []))
    return faults


def _costs(name: str, curve: PsmCurve, costs: list[int]) -> list[str]:
    sums = [0]
    for cost in costs:
        sums.append(sums[-1] + cost)
    for length in range(1, min(LENGTHS, len(costs)) + 1):
        most = max(sums[at + length] - sums[at] for at in range(len(costs) - length + 1))
        if most > curve.total(length):
            return [f"E: {length} activations of {name} cost {most}, at most {curve.total(length)} expected"]
    return []
