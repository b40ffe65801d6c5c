"""From a deployment to the task set of each node: one task per active instance, or per thread where threads are
declared. Values taken by default are reported where they are used (MV420)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.lower.calls import Services, services
from mauve.lower.machines import Machine
from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.lower.sharing import Shared, check_races, data_sections, shared_data, task_uses
from mauve.lower.suspension import with_calls
from mauve.lower.threads import Machines, exchange_cost, thread_tasks
from mauve.model.model import CodelId, DataConnection, Deployment, Instance, Node
from mauve.model.periods import common_period, instance_period
from mauve.model.priorities import contradiction
from mauve.records import changed
from mauve.timing.blocking import blockers, longest
from mauve.timing.task import Section, Task, Workload, constant, machine
from mauve.units import format_time


def task_sets(
    deployment: Deployment, machines: Machines, times: Mapping[CodelId, int], report: Report
) -> tuple[NodeTasks, ...]:
    """The task set of each node. What cannot be placed or analysed is reported (MV407) and left out."""
    threaded = any(node.threads for node in deployment.nodes)
    if not threaded and len(deployment.nodes) > 1:
        message = f"`{deployment.name}` has {len(deployment.nodes)} nodes and does not say what runs on which"
        help_ = Fix("declare threads in each node: `process main { thread t { instance } }`")
        report.add(Diagnostic("MV407", message, Label(deployment.span), help=help_))
        return ()
    connected = services(deployment.architecture)
    instances = {instance.name: instance for instance in deployment.architecture.instances}
    drafts: list[NodeTasks] = []
    for node in deployment.nodes:
        if threaded:
            placed, complete = thread_tasks(node, deployment, machines, report)
        else:
            placed, complete = _instance_tasks(node, deployment, machines)
        _report_defaults(placed, report)
        _check_monotonic(node, placed, report)
        drafts.append(NodeTasks(node, tuple(placed), complete))
    _check_nodes(drafts, connected, report)
    every = [placed for draft in drafts for placed in draft.tasks]
    shared = shared_data(every, connected, instances)
    check_races(shared, every, instances, report)
    drafts = _with_waits(drafts, every, connected, shared, report)
    return tuple(_with_blocking(draft, deployment, connected, shared, times) for draft in drafts)


def _instance_tasks(node: Node, deployment: Deployment, machines: Machines) -> tuple[list[PlacedTask], bool]:
    placed: list[PlacedTask] = []
    complete = True
    for instance in deployment.architecture.instances:
        built, priority, deadline = machines.get(instance.name), instance.priority, instance.deadline
        if not instance.active:
            continue
        period = _task_period(instance, built or ())
        if built is None or period is None or priority is None or deadline is None:
            complete = False
            continue
        work = tuple(_work(one, instance, period) for one in built)
        exchange = exchange_cost(node, instance)
        if exchange:
            work = (*work, constant("port exchange", exchange))
        task = Task(instance.name, priority.value, period, deadline.value, work, instance.jitter)
        one = PlacedTask(task, built, (instance,), instance.span, priority, deadline, node.locked)
        placed.append(one)
    return placed, complete


def _task_period(instance: Instance, built: tuple[Machine, ...]) -> int | None:
    """The gcd of the periods of an instance's regions, nested ones included."""
    own = instance_period(instance)
    return common_period([*(m.period for m in built if m.period is not None), *([own] if own else [])])


def _work(one: Machine, instance: Instance, period: int) -> Workload:
    """The work of a region; one slower than its task runs in some of the jobs only."""
    own = one.period or (instance.period.value if instance.period else period)
    return machine(one.psm, own if own != period else 0)


def _report_defaults(placed: Sequence[PlacedTask], report: Report) -> None:
    for one in placed:
        name = one.task.name
        if one.priority.default:
            message = f"`{name}` has no priority; it gets {one.priority.value}, {one.priority.default}"
            report.add(Diagnostic("MV420", message, Label(one.span), Severity.NOTE))
        if one.deadline.default:
            value = format_time(one.deadline.value)
            message = f"`{name}` has no deadline; it gets its period, {value}"
            report.add(Diagnostic("MV420", message, Label(one.span), Severity.NOTE))


def _check_monotonic(node: Node, placed: Sequence[PlacedTask], report: Report) -> None:
    """MV407 where `schedule rate_monotonic` is written and priorities say otherwise."""
    if not node.rate_monotonic:
        return
    pair = contradiction([(one.task.name, one.task.period, one.task.priority) for one in placed])
    if pair is None:
        return
    low, high = (next(one for one in placed if one.task.name == name) for name in pair)
    message = f"the priorities of node `{node.name}` are not rate monotonic, as its schedule says"
    primary = Label(low.priority.span or low.span, f"every {format_time(low.task.period)}, less urgent")
    labels = (Label(high.priority.span or high.span, f"every {format_time(high.task.period)}, more urgent"),)
    help_ = Fix("leave the priorities out, or write `schedule fixed_priority`")
    report.add(Diagnostic("MV407", message, primary, labels=labels, help=help_))


def _check_nodes(drafts: Sequence[NodeTasks], connected: Services, report: Report) -> None:
    """MV407 for what two processors would have to share: an instance, a provider that is called, and a codel whose
    time depends on the processor."""
    if len(drafts) < 2:
        return
    seats: dict[str, tuple[str, PlacedTask]] = {}
    for draft in drafts:
        timed = bool(draft.node.binaries or draft.node.assumptions)
        for placed in draft.tasks:
            things = {f"the instance `{instance.name}`" for instance in placed.instances}
            for _, use in task_uses(placed, connected):
                if use.provider:
                    things.add(f"the instance `{use.provider}`")
                if timed:
                    things.add(f"the codel `{use.codel}`")
            for thing in sorted(things):
                first, _ = seats.setdefault(thing, (draft.node.name, placed))
                if first != draft.node.name:
                    message = f"{thing} is used on the nodes `{first}` and `{draft.node.name}`"
                    help_ = Fix("give each processor its own component, and connect them by ports")
                    report.add(Diagnostic("MV407", message, Label(placed.span), help=help_))


def _with_waits(
    drafts: list[NodeTasks], every: Sequence[PlacedTask], connected: Services, shared: Shared, report: Report
) -> list[NodeTasks]:
    """The tasks with the operations they wait for; a call that cannot be analysed leaves the deployment incomplete."""
    waiting, sound = with_calls(every, connected, shared, report)
    found = {one.task.name: one for one in waiting}
    return [
        changed(d, tasks=tuple(found[one.task.name] for one in d.tasks), complete=d.complete and sound) for d in drafts
    ]


def _with_blocking(
    draft: NodeTasks, deployment: Deployment, connected: Services, shared: Shared, times: Mapping[CodelId, int]
) -> NodeTasks:
    exchanged = _exchanges(draft, deployment.architecture.data)
    held = [
        longest(
            (
                *_operations(placed, connected, times),
                *data_sections(placed, shared, times),
                *exchanged.get(placed.task.name, ()),
            )
        )
        for placed in draft.tasks
    ]
    found = blockers([(one.task.priority, sections) for one, sections in zip(draft.tasks, held, strict=True)])
    tasks = tuple(
        changed(
            one,
            task=changed(one.task, sections=sections),
            blocker=worst,
        )
        for one, sections, worst in zip(draft.tasks, held, found, strict=True)
    )
    return changed(draft, tasks=tasks)


def _operations(placed: PlacedTask, connected: Services, times: Mapping[CodelId, int]) -> Iterator[Section]:
    """The operations that a task runs, each in the critical section of its provider."""
    for instance, use in task_uses(placed, connected):
        if use.provider and not use.waits and use.codel in times:
            what = f"`{use.codel}` of `{use.provider}`"
            yield Section(use.provider, instance.name, what, times[use.codel], str(use.codel))


def _exchanges(draft: NodeTasks, connections: Sequence[DataConnection]) -> dict[str, list[Section]]:
    """Per task the copies of port data between it and another task: each lasts at most one exchange of its instance."""
    holders: dict[str, list[tuple[str, int]]] = {}
    for placed in draft.tasks:
        for instance in placed.instances:
            cost = exchange_cost(draft.node, instance)
            holders.setdefault(instance.name, []).append((placed.task.name, cost))
    found: dict[str, list[Section]] = {}
    if not draft.node.exchanges:
        return found
    for connection in connections:
        for end in (connection.source, connection.target):
            for task, cost in holders.get(end.instance, ()):
                what = f"the exchange of `{connection.source}`"
                section = Section(f"port {connection.source}", end.instance, what, cost)
                found.setdefault(task, []).append(section)
    return found
