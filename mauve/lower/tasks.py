"""From a deployment to the task set of each node: one task per active instance, or per thread where threads are
declared.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.lower.blocking import Section, blocking, sections
from mauve.lower.machines import Machine
from mauve.model.model import CodelId, Deployment, Instance, Node, Setting, Thread
from mauve.model.periods import common_period
from mauve.model.priorities import rate_monotonic
from mauve.model.threads import PORTS, placement
from mauve.source import Span
from mauve.timing.task import Task, Workload, constant, machine
from mauve.units import format_time


@dataclass(frozen=True, slots=True)
class PlacedTask:
    """A task with what it stands for: its instances and the span that its messages point at."""

    task: Task
    machines: tuple[Machine, ...]
    instances: tuple[Instance, ...]
    span: Span
    priority: Setting
    deadline: Setting
    sections: tuple[Section, ...] = ()
    blocker: Section | None = None


@dataclass(frozen=True, slots=True)
class NodeTasks:
    """The tasks that share one processor. `complete` is False when a task is missing because a codel has no time."""

    node: Node
    tasks: tuple[PlacedTask, ...]
    complete: bool


Machines = Mapping[str, tuple[Machine, ...] | None]
"""The machines of each active instance; None where they could not be built."""


def task_sets(
    deployment: Deployment, machines: Machines, times: Mapping[CodelId, int], report: Report
) -> tuple[NodeTasks, ...]:
    """The task set of each node. What cannot be placed is reported (MV407) or left out."""
    threaded = any(node.threads for node in deployment.nodes)
    if not threaded and len(deployment.nodes) > 1:
        message = f"`{deployment.name}` has {len(deployment.nodes)} nodes and does not say what runs on which"
        help_ = Fix("declare threads in each node: `process main { thread t { instance } }`")
        report.add(Diagnostic("MV407", message, Label(deployment.span), help=help_))
        return ()
    result: list[NodeTasks] = []
    for node in deployment.nodes:
        placed, complete = (
            _thread_tasks(node, deployment, machines, report)
            if threaded
            else _instance_tasks(node, deployment, machines)
        )
        result.append(NodeTasks(node, _with_blocking(placed, deployment, times), complete))
    return tuple(result)


def _instance_tasks(node: Node, deployment: Deployment, machines: Machines) -> tuple[list[PlacedTask], bool]:
    placed: list[PlacedTask] = []
    complete = True
    for instance in deployment.architecture.instances:
        if not instance.active or instance.priority is None:
            continue
        built = machines.get(instance.name)
        period = _instance_period(instance, built or ())
        deadline = instance.deadline or (Setting(period, None, "the period") if period else None)
        if built is None or period is None or deadline is None:
            complete = False
            continue
        work = _work(built, period, instance)
        exchange = _exchange_cost(node, instance)
        if exchange:
            work = (*work, constant("port exchange", exchange))
        jitter = instance.jitter
        task = Task(instance.name, instance.priority.value, period, deadline.value, work, jitter)
        placed.append(PlacedTask(task, built, (instance,), instance.span, instance.priority, deadline))
    return placed, complete


def _instance_period(instance: Instance, built: tuple[Machine, ...]) -> int | None:
    """The period of an instance's task: the gcd of those of its regions."""
    own = [machine.period for machine in built if machine.period is not None]
    if instance.period is not None and (not own or len(own) < len(built)):
        own.append(instance.period.value)
    return common_period(own)


def _work(built: tuple[Machine, ...], period: int, instance: Instance) -> tuple[Workload, ...]:
    """A workload for each region; those slower than the task run in some of its jobs only."""
    result = []
    for one in built:
        own = one.period or (instance.period.value if instance.period else period)
        result.append(machine(one.psm, own if own != period else 0))
    return tuple(result)


def _exchange_cost(node: Node, instance: Instance) -> int:
    """What copying the ports costs at each activation: as given for the instance, else for all."""
    own = [cost for name, cost, _ in node.exchanges if name == instance.name]
    return own[-1] if own else max((cost for name, cost, _ in node.exchanges if not name), default=0)


def _thread_tasks(
    node: Node, deployment: Deployment, machines: Machines, report: Report
) -> tuple[list[PlacedTask], bool]:
    where = placement(deployment)
    drafts: list[tuple[Thread, int, tuple[Workload, ...], list[Machine], list[Instance]]] = []
    complete = True
    for thread in node.threads:
        members = [
            (instance, one)
            for instance in deployment.architecture.instances
            for one in machines.get(instance.name) or ()
            if where.get(one.region) is thread
        ]
        touched = {member.instance for member, _ in thread.members}
        if any(machines.get(name, ()) is None for name in touched):
            complete = False
            continue
        periods = {id(one): one.period or (i.period.value if i.period else None) for i, one in members}
        known = [period for period in periods.values() if period]
        period = thread.period.value if thread.period else common_period(known)
        if period is None or any(p is None or p % period for p in periods.values()):
            _report_period(thread, period, report)
            complete = False
            continue
        work = tuple(machine(one.psm, p) for _, one in members if (p := periods[id(one)]) is not None)
        work += _thread_exchange(node, thread, deployment)
        instances = [i for i in deployment.architecture.instances if i.name in touched]
        drafts.append((thread, period, work, [one for _, one in members], instances))
        _check_gcd(thread, period, known, work, report)
    return _prioritised(drafts, report), complete


def _report_period(thread: Thread, period: int | None, report: Report) -> None:
    if period is None:
        report.add(Diagnostic("MV401", f"nothing says when the thread `{thread.name}` runs", Label(thread.span)))
        return
    message = f"the period of the thread `{thread.name}` does not divide those of its regions"
    help_ = Fix("leave it out: the greatest common divisor is taken")
    span = thread.period.span if thread.period and thread.period.span else thread.span
    report.add(Diagnostic("MV401", message, Label(span), help=help_))


def _thread_exchange(node: Node, thread: Thread, deployment: Deployment) -> tuple[Workload, ...]:
    """The port exchanges that a thread executes: those named by it, and those of instances it executes as a whole."""
    instances = {i.name: i for i in deployment.architecture.instances}
    names = [m.instance for m, _ in thread.members if m.path == (PORTS,) or not m.path]
    cost = sum(_exchange_cost(node, instances[name]) for name in dict.fromkeys(names))
    return (constant("port exchange", cost),) if cost else ()


def _check_gcd(thread: Thread, period: int, periods: list[int], work: tuple[Workload, ...], report: Report) -> None:
    """MV411: the thread runs more often than any of its regions (seed 000, equation (3))."""
    distinct = sorted(set(periods))
    if not distinct or period >= distinct[0]:
        return
    listed = ", ".join(format_time(p) for p in distinct)
    cost = sum(part.curve.total(1) for part in work)
    share = f"{100 * cost / period:.0f} % of the processor" if cost else "nothing"
    message = f"thread `{thread.name}` must run every {format_time(period)}, more often than any of its regions"
    members = " and ".join(format_time(p) for p in distinct)
    label = Label(thread.members[0][1] if thread.members else thread.span, f"regions of {members}")
    notes = (f"{format_time(period)} = gcd({listed}); an activation costs up to {format_time(cost)}, {share}",)
    help_ = Fix(f"put the regions of {members} into threads of their own")
    report.add(Diagnostic("MV411", message, label, Severity.WARNING, notes=notes, help=help_))


def _prioritised(
    drafts: list[tuple[Thread, int, tuple[Workload, ...], list[Machine], list[Instance]]], report: Report
) -> list[PlacedTask]:
    """The threads with priorities and deadlines; missing ones by default, which is reported."""
    ranks = rate_monotonic([(period, t.priority.value if t.priority else None) for t, period, *_ in drafts])
    placed: list[PlacedTask] = []
    for (thread, period, work, built, instances), rank in zip(drafts, ranks, strict=True):
        priority = thread.priority or Setting(rank, None, "rate monotonic")
        if thread.priority is None:
            message = f"the thread `{thread.name}` has no priority; it gets {rank}, rate monotonic"
            report.add(Diagnostic("MV420", message, Label(thread.span), Severity.NOTE))
        deadline = thread.deadline or Setting(period, None, "the period")
        task = Task(thread.name, priority.value, period, deadline.value, work)
        placed.append(PlacedTask(task, tuple(built), tuple(instances), thread.span, priority, deadline))
    return placed


def _with_blocking(
    placed: list[PlacedTask], deployment: Deployment, times: Mapping[CodelId, int]
) -> tuple[PlacedTask, ...]:
    holders = [replace(one, sections=sections(one.instances, deployment, times)) for one in placed]
    views = [(one.task.priority, one.sections) for one in holders]
    result = []
    for one in holders:
        worst = blocking(one.task.priority, views)
        task = replace(one.task, blocking=worst.length if worst else 0)
        result.append(replace(one, task=task, blocker=worst))
    return tuple(result)
