"""Event-driven activation: the arrivals of a woken task jitter by the responses of the tasks that wake it.

With one producer of period T_p >= s, the declared separation, eta(d) = ceil((d + R_p) / T_p) <= ceil((d + J) / s) for
J = R_p. With several, each at most 1 / T_p often, J = s * sum(R_p / T_p + 1) covers the sum of their arrivals as
long as s * sum(1 / T_p) <= 1, which the model checks. The best case is 0 (semantics of record, section 4).

Responses depend on jitters and jitters on responses: they are iterated from 0 upwards to their least fixed point.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil

from mauve.lower.tasks import NodeTasks, PlacedTask
from mauve.model.model import Deployment
from mauve.model.wakeups import waking
from mauve.timing.response import Analysis, Method, Reason, analyse
from mauve.timing.task import Platform, on_platform

ROUNDS = 1000
"""Iterations after which a jitter that still grows is called unbounded."""


@dataclass(frozen=True, slots=True)
class Settled:
    """The task sets with their final jitters, and the responses; None for a node without tasks."""

    nodes: tuple[NodeTasks, ...]
    results: tuple[Analysis | None, ...]


Producers = Mapping[str, tuple[PlacedTask, ...]]
"""Per woken task the tasks that wake it."""


def settle(
    deployment: Deployment, nodes: Sequence[NodeTasks], platforms: Sequence[Platform], method: Method
) -> Settled:
    """The responses of all nodes together, with event jitters at their fixed point.

    A task whose producers have no bound, and those it delays, get no response time (`Reason.ARRIVALS`).
    """
    producers = _producers(deployment, nodes)
    current = tuple(nodes)
    results: tuple[Analysis | None, ...] = ()
    for _ in range(ROUNDS):
        results = tuple(_analyse(node, platform, method) for node, platform in zip(current, platforms, strict=True))
        responses = {r.task: r.wcrt for analysis in results if analysis for r in analysis.results}
        unknown = {name for name, ps in producers.items() if any(responses.get(p.task.name) is None for p in ps)}
        updated = tuple(
            replace(node, tasks=tuple(_with_jitter(one, producers, responses) for one in node.tasks))
            for node in current
        )
        if updated == current:
            break
        current = updated
    else:
        unknown = set(producers)
    withdrawn = tuple(_withdraw(analysis, unknown) if analysis else None for analysis in results)
    return Settled(current, withdrawn)


def _analyse(node: NodeTasks, platform: Platform, method: Method) -> Analysis | None:
    if not node.tasks:
        return None
    return analyse(on_platform([placed.task for placed in node.tasks], platform), method)


def _producers(deployment: Deployment, nodes: Sequence[NodeTasks]) -> Producers:
    holder = {i.name: placed for node in nodes for placed in node.tasks for i in placed.instances}
    connections = deployment.architecture.data
    found: dict[str, tuple[PlacedTask, ...]] = {}
    for placed in dict.fromkeys(one.task.name for one in holder.values()):
        instances = [i for one in holder.values() if one.task.name == placed for i in one.instances]
        names = [c.source.instance for i in dict.fromkeys(instances) for c in waking(i, connections)]
        wakers = [holder[name] for name in dict.fromkeys(names) if name in holder]
        if wakers:
            found[placed] = tuple(wakers)
    return found


def _with_jitter(placed: PlacedTask, producers: Producers, responses: Mapping[str, int | None]) -> PlacedTask:
    """The task with its own jitter or that of its arrivals, whichever is more."""
    wakers = [(p.task.period, r) for p in producers.get(placed.task.name, ()) if (r := responses.get(p.task.name))]
    if not wakers:
        return placed
    jitter = wakers[0][1]
    if len(wakers) > 1:
        jitter = ceil(placed.task.period * sum((Fraction(r, period) + 1 for period, r in wakers), Fraction(0)))
    if jitter <= placed.task.jitter:
        return placed
    return replace(placed, task=replace(placed.task, jitter=jitter))


def _withdraw(analysis: Analysis, unknown: set[str]) -> Analysis:
    """The analysis without the responses that rest on arrivals of unknown number."""
    priorities = [task.priority for task in analysis.tasks if task.name in unknown]
    if not priorities:
        return analysis
    results = tuple(
        replace(r, wcrt=None, reason=r.reason or Reason.ARRIVALS)
        if analysis.task(r.task).priority <= max(priorities)
        else r
        for r in analysis.results
    )
    return replace(analysis, results=results)
