"""Event-driven activation: the arrivals of a woken task jitter by the responses of the tasks that wake it.

With one writer of period T_p >= s, the declared separation, eta(d) = ceil((d + R_p) / T_p) <= ceil((d + J) / s) for
J = R_p. With several, each at most 1 / T_p often, J = s * sum(R_p / T_p + 1) covers the sum of their arrivals as
long as s * sum(1 / T_p) <= 1, which the model checks. The best case is 0 (semantics of record, section 4). A writer
outside the model has its declared jitter for a response.

A task that waits for an operation of another depends on the response of that one, and on its own: it delays others as
long as its jobs last (`suspension.py`).

Responses depend on jitters and waits, and those on responses: all are iterated from 0 upwards to their least fixed
point.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from fractions import Fraction
from math import ceil

from mauve.lower.placed import NodeTasks, PlacedTask, Wait
from mauve.lower.suspension import suspended, wait_times
from mauve.model.model import Deployment, Instance
from mauve.model.periods import instance_period
from mauve.model.wakeups import waking
from mauve.records import changed, record
from mauve.timing.blocking import with_blocking
from mauve.timing.response import Analysis, Method, Reason, analyse
from mauve.timing.task import Interrupt, Kind, Platform, Task, on_platform

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
    """The responses of all nodes together, with event jitters and waits at their fixed point.

    A task whose writers have no bound, and those it delays, get no response time (`Reason.ARRIVALS`), nor does one that
    waits for a response without a bound (`Reason.WAITS`).
    """
    wakers = _wakers(deployment, nodes)
    waiting = any(placed.waits for node in nodes for placed in node.tasks)
    state = _State(tuple(nodes), {}, frozenset(), frozenset(), frozenset(), frozenset())
    results: tuple[Analysis | None, ...] = ()
    for _ in range(ROUNDS):
        analyses = [_analyse(*pair, method, state.known) for pair in zip(state.nodes, platforms, strict=True)]
        results = tuple(_withdraw(analysis, state) if analysis else None for analysis in analyses)
        then = _next(state, nodes, wakers, results, waiting)
        if then.settled == state.settled:
            return Settled(_told(state), results)
        state = then
    everything = changed(state, unknown=frozenset(wakers), stuck=state.stuck | _waiting(nodes))
    return Settled(state.nodes, tuple(_withdraw(analysis, everything) if analysis else None for analysis in results))


@record
class _State:
    """What the next analysis takes: the tasks with their jitters, and `known` responses. `lost` tasks have no bound on
    their response, `endless` ones none on their jitter; `unknown` are woken, and `stuck` wait, for something lost."""

    nodes: tuple[NodeTasks, ...]
    known: Mapping[str, int | None]
    lost: frozenset[str]
    endless: frozenset[str]
    unknown: frozenset[str]
    stuck: frozenset[str]

    @property
    def settled(self) -> tuple[object, ...]:
        """What does not change any more at the fixed point."""
        return self.nodes, self.known, self.unknown, self.stuck


def _next(
    state: _State,
    nodes: Sequence[NodeTasks],
    wakers: Wakers,
    results: Sequence[Analysis | None],
    waiting: bool,
) -> _State:
    """Jitters and waits only rise, so a response once without a bound stays so, whatever is left out for it later."""
    responses = {r.task: r.wcrt for analysis in results if analysis for r in analysis.results}
    tasks = [placed for node in nodes for placed in node.tasks]
    forever = {one.task.name for one in tasks if one.waits and _waits_forever(one, responses.get(one.task.name))}
    lost = state.lost | {name for name, response in responses.items() if response is None} | forever
    known = {name: response for name, response in responses.items() if name not in lost}
    updated = tuple(
        changed(node, tasks=tuple(_with_jitter(one, wakers, known) for one in node.tasks)) for node in nodes
    )
    endless = state.endless | {one.task.name for node in updated for one in node.tasks if _endless(one, wakers)}
    woken = {name for name, ws in wakers.items() if name in endless or any(w.response(known) is None for w in ws)}
    there = {one.task.name for one in tasks} - lost
    stuck = {
        one.task.name
        for one in tasks
        if one.waits and (one.task.name in lost or any(not _answered(wait, there) for wait in one.waits))
    }
    return _State(updated, known if waiting else {}, lost, endless, frozenset(woken), frozenset(stuck))


def _answered(wait: Wait, there: Set[str]) -> bool:
    """Whether all tasks that may carry out an operation are there and have a bound on their response."""
    return bool(wait.servers) and all(task in there for task, _ in wait.servers)


def _waits_forever(placed: PlacedTask, response: int | None) -> bool:
    """Whether a task that waits responds so late that it surely will not settle."""
    periods = [placed.task.period, *(period for wait in placed.waits for _, period in wait.servers)]
    return response is not None and response > PENDING * max(periods)


def _waiting(nodes: Sequence[NodeTasks]) -> frozenset[str]:
    return frozenset(placed.task.name for node in nodes for placed in node.tasks if placed.waits)


def _told(state: _State) -> tuple[NodeTasks, ...]:
    """The tasks with how long each of their waits lasts at most."""
    if not _waiting(state.nodes):
        return state.nodes
    jitters = _jitters(state.nodes)
    return tuple(
        changed(node, tasks=tuple(_with_times(one, wait_times(one, jitters, state.known)) for one in node.tasks))
        for node in state.nodes
    )


def _with_times(placed: PlacedTask, times: Mapping[str, int]) -> PlacedTask:
    return changed(placed, waits=tuple(changed(wait, time=times[wait.label]) for wait in placed.waits))


def _jitters(nodes: Sequence[NodeTasks]) -> dict[str, int]:
    return {placed.task.name: placed.task.jitter for node in nodes for placed in node.tasks}


def _analyse(node: NodeTasks, platform: Platform, method: Method, known: Mapping[str, int | None]) -> Analysis | None:
    if not node.tasks:
        return None
    tasks = on_platform([placed.task for placed in node.tasks], platform)
    waiting = {placed.task.name: placed for placed in node.tasks if placed.waits}
    if waiting:
        jitters = _jitters((node,))
        blocking = {task.name: task.blocking for task in with_blocking(tasks)}
        tasks = tuple(
            suspended(task, wait_times(placed, jitters, known), blocking[task.name], known.get(task.name) or 0)
            if (placed := waiting.get(task.name)) is not None
            else task
            for task in tasks
        )
    return analyse(tasks, method)


def is_settled(deployment: Deployment, nodes: Sequence[NodeTasks]) -> bool:
    """Whether no task is woken by, or waits for, another: responses are those of the tasks as they are."""
    return not _waiting(nodes) and not _wakers(deployment, nodes)


def settled_again(
    deployment: Deployment, nodes: Sequence[NodeTasks], platforms: Sequence[Platform], place: int
) -> Callable[[Sequence[Task]], Sequence[Task] | None]:
    """What gives other tasks of node `place` (costs, sections or priorities of the same tasks changed, interrupts
    included) the jitters and waits that follow from their responses. None where a response has no bound, or a task of
    another node becomes late by it."""

    def again(tasks: Sequence[Task]) -> Sequence[Task] | None:
        mine = {task.name: task for task in tasks if task.kind is Kind.TASK}
        handlers = [task for task in tasks if task.kind is not Kind.TASK]
        placed = tuple(changed(one, task=mine[one.task.name]) for one in nodes[place].tasks)
        others = [changed(node, tasks=placed) if at == place else node for at, node in enumerate(nodes)]
        interrupts = tuple(Interrupt(one.name, one.period, one.demand(1), one.kind) for one in handlers)
        platform = changed(platforms[place], context_switch=0, interrupts=interrupts)
        seats = [platform if at == place else each for at, each in enumerate(platforms)]
        results = settle(deployment, others, seats, Method.TRACE).results
        far = [result for at, result in enumerate(results) if at != place]
        here = results[place]
        if here is None or any(r.wcrt is None for r in here.results) or any(r and not r.schedulable for r in far):
            return None
        return here.tasks

    return again


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


def _withdraw(analysis: Analysis, state: _State) -> Analysis:
    """The analysis without the responses that rest on arrivals of unknown number, or on waits without a bound."""
    results = analysis.results
    for names, reason in ((state.unknown, Reason.ARRIVALS), (state.stuck, Reason.WAITS)):
        priorities = [task.priority for task in analysis.tasks if task.name in names]
        if priorities:
            results = tuple(
                changed(r, wcrt=None, reason=r.reason or reason)
                if analysis.task(r.task).priority <= max(priorities)
                else r
                for r in results
            )
    return analysis if results == analysis.results else changed(analysis, results=results)
