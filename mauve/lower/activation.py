"""Event-driven activation: the arrivals of a woken task jitter by the responses of the tasks that wake it.

With one writer of period T_p >= s, the declared separation, eta(d) = ceil((d + R_p) / T_p) <= ceil((d + J) / s) for
J = R_p. With several, each at most 1 / T_p often, J = s * sum(R_p / T_p + 1) covers the sum of their arrivals as
long as s * sum(1 / T_p) <= 1, which the model checks. The best case is 0 (semantics of record, section 4). A writer
outside the model has its declared jitter for a response.

Responses depend on jitters and jitters on responses: they are iterated from 0 upwards to their least fixed point.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import ceil

from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.model.model import Deployment, Instance
from mauve.model.periods import instance_period
from mauve.model.wakeups import waking
from mauve.records import changed, record
from mauve.timing.response import Analysis, Method, Reason, analyse
from mauve.timing.task import Platform, on_platform

ROUNDS = 1000
"""Iterations after which a jitter that still grows is called unbounded."""

PENDING = 100
"""Periods, of its own or of its slowest waker, beyond which a jitter is called unbounded."""


@record
class Settled:
    """The task sets with their final jitters, and the responses; None for a node without tasks."""

    nodes: tuple[NodeTasks, ...]
    results: tuple[Analysis | None, ...]


@record
class _Waker:
    """An instance that writes an event port: how often at most, in which tasks, and the delay of one without tasks."""

    period: int | None
    tasks: tuple[str, ...]
    jitter: int

    def response(self, responses: Mapping[str, int | None]) -> int | None:
        """How late it may write; None where that is not bounded."""
        known = [responses.get(task) for task in self.tasks]
        return None if None in known else max([self.jitter, *(r for r in known if r is not None)])


Wakers = Mapping[str, tuple[_Waker, ...]]
"""Per woken task the instances that wake it."""


def settle(
    deployment: Deployment, nodes: Sequence[NodeTasks], platforms: Sequence[Platform], method: Method
) -> Settled:
    """The responses of all nodes together, with event jitters at their fixed point.

    A task whose writers have no bound, and those it delays, get no response time (`Reason.ARRIVALS`).
    """
    wakers = _wakers(deployment, nodes)
    current = tuple(nodes)
    results: tuple[Analysis | None, ...] = ()
    lost: set[str] = set()
    endless: set[str] = set()
    unknown: set[str] = set()
    for _ in range(ROUNDS):
        analyses = [_analyse(node, platform, method) for node, platform in zip(current, platforms, strict=True)]
        results = tuple(_withdraw(analysis, unknown) if analysis else None for analysis in analyses)
        responses = {r.task: r.wcrt for analysis in results if analysis for r in analysis.results}
        # Jitters only rise, so a response once without a bound stays so, whatever is left out for it later.
        lost |= {name for name, response in responses.items() if response is None}
        known = {name: response for name, response in responses.items() if name not in lost}
        updated = tuple(
            changed(node, tasks=tuple(_with_jitter(one, wakers, known) for one in node.tasks)) for node in nodes
        )
        endless |= {one.task.name for node in updated for one in node.tasks if _endless(one, wakers)}
        woken = {name for name, ws in wakers.items() if name in endless or any(w.response(known) is None for w in ws)}
        if updated == current and woken == unknown:
            return Settled(current, results)
        current, unknown = updated, woken
    withdrawn = tuple(_withdraw(analysis, set(wakers)) if analysis else None for analysis in results)
    return Settled(current, withdrawn)


def _analyse(node: NodeTasks, platform: Platform, method: Method) -> Analysis | None:
    if not node.tasks:
        return None
    return analyse(on_platform([placed.task for placed in node.tasks], platform), method)


def _wakers(deployment: Deployment, nodes: Sequence[NodeTasks]) -> Wakers:
    tasks: dict[str, tuple[str, ...]] = {}
    for node in nodes:
        for placed in node.tasks:
            for instance in placed.instances:
                tasks[instance.name] = (*tasks.get(instance.name, ()), placed.task.name)
    instances = {instance.name: instance for instance in deployment.architecture.instances}
    found: dict[str, tuple[_Waker, ...]] = {}
    for node in nodes:
        for placed in node.tasks:
            sources = dict.fromkeys(
                connection.source.instance
                for instance in placed.instances
                if instance.sporadic
                for connection in waking(instance, deployment.architecture.data)
            )
            if sources:
                found[placed.task.name] = tuple(w for name in sources for w in _publishers(instances[name], tasks))
    return found


def _publishers(instance: Instance, tasks: Mapping[str, tuple[str, ...]]) -> tuple[_Waker, ...]:
    """A waker for each task that executes a part of the instance: each of them publishes the ports when its job
    ends.
    """
    period = instance_period(instance)
    holders = tasks.get(instance.name, ())
    return tuple(_Waker(period, (name,), 0) for name in holders) or (_Waker(period, (), instance.jitter),)


def _with_jitter(placed: PlacedTask, wakers: Wakers, responses: Mapping[str, int | None]) -> PlacedTask:
    """The task with the jitter of its arrivals on top of its own."""
    known = [(w.period, r) for w in wakers.get(placed.task.name, ()) if (r := w.response(responses)) is not None]
    if not known:
        return placed
    jitter = known[0][1]
    if len(known) > 1:
        late = (Fraction(r, period) + 1 for period, r in known if period is not None)
        jitter = ceil(placed.task.period * sum(late, Fraction(0)))
    return changed(placed, task=changed(placed.task, jitter=placed.task.jitter + jitter))


def _endless(placed: PlacedTask, wakers: Wakers) -> bool:
    """Whether a task is woken more often than its separation says, or so many of its activations would wait at
    once that its jitter surely grows without end."""
    known = [waker.period or 0 for waker in wakers.get(placed.task.name, ())]
    if sum((Fraction(placed.task.period, period) for period in known if period), Fraction(0)) > 1:
        return True
    return bool(known) and placed.task.jitter > PENDING * max(placed.task.period, *known)


def _withdraw(analysis: Analysis, unknown: set[str]) -> Analysis:
    """The analysis without the responses that rest on arrivals of unknown number."""
    priorities = [task.priority for task in analysis.tasks if task.name in unknown]
    if not priorities:
        return analysis
    results = tuple(
        changed(r, wcrt=None, reason=r.reason or Reason.ARRIVALS)
        if analysis.task(r.task).priority <= max(priorities)
        else r
        for r in analysis.results
    )
    return changed(analysis, results=results)
