"""Threads as tasks (seed 000, equations (3) and (4)): each executes regions, every one at its own period.

The period of a thread is the gcd of those of its regions; a region runs in the jobs at which its own period is due.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.lower.machines import Machine
from mauve.lower.placed import PlacedTask
from mauve.model.model import Deployment, Instance, Node, Setting, Thread
from mauve.model.periods import common_period, instance_period
from mauve.model.priorities import rate_monotonic
from mauve.model.threads import PORTS, placement
from mauve.records import record
from mauve.timing.task import Task, Workload, constant, machine
from mauve.units import format_time

Machines = Mapping[str, tuple[Machine, ...] | None]
"""The machines of each active instance; None where they could not be built."""


@record
class _Draft:
    """A thread before priorities are dealt out."""

    thread: Thread
    period: int
    work: tuple[Workload, ...]
    machines: tuple[Machine, ...]
    instances: tuple[Instance, ...]


def thread_tasks(
    node: Node, deployment: Deployment, machines: Machines, report: Report
) -> tuple[list[PlacedTask], bool]:
    """The tasks of a node's threads, and whether all are there: one with a codel without a time is missing."""
    instances = {instance.name: instance for instance in deployment.architecture.instances}
    executed: dict[str, list[tuple[Instance, Machine]]] = {thread.name: [] for thread in node.threads}
    own = {id(thread) for thread in node.threads}
    for region, thread in placement(deployment).items():
        built = machines.get(region.instance)
        if id(thread) in own and built is not None:
            executed[thread.name] += [(instances[region.instance], one) for one in built if one.region == region]
    exchanging = _exchanging(deployment)
    drafts: list[_Draft] = []
    complete = True
    for thread in node.threads:
        touched = dict.fromkeys(member.instance for member, _ in thread.members)
        draft = None
        if all(machines.get(name) is not None for name in touched):
            members = [instances[name] for name in touched]
            draft = _draft(node, thread, executed[thread.name], members, exchanging, report)
        if draft is None:
            complete = False
        else:
            drafts.append(draft)
    return _prioritised(drafts), complete


def _exchanging(deployment: Deployment) -> set[str]:
    """The instances whose port exchange some thread is said to execute; others do it wherever they run."""
    members = [member for node in deployment.nodes for thread in node.threads for member, _ in thread.members]
    return {member.instance for member in members if member.path == (PORTS,)}


def _draft(
    node: Node,
    thread: Thread,
    executed: Sequence[tuple[Instance, Machine]],
    instances: Sequence[Instance],
    exchanging: set[str],
    report: Report,
) -> _Draft | None:
    if len(instances) > 1 and (sporadic := next((i for i in instances if i.sporadic), None)) is not None:
        message = f"the thread `{thread.name}` executes more than `{sporadic.name}`, which events wake"
        help_ = Fix(f"give `{sporadic.name}` a thread of its own")
        report.add(Diagnostic("MV407", message, Label(thread.span), help=help_))
        return None
    periods = [one.period or (i.period.value if i.period else None) for i, one in executed]
    known = [period for period in periods if period] or [p for i in instances if (p := instance_period(i))]
    period = thread.period.value if thread.period else common_period(known)
    if period is None or any(p is not None and p % period for p in periods):
        _report_period(thread, period, report)
        return None
    work = tuple(machine(one.psm, p if p and p != period else 0) for (_, one), p in zip(executed, periods, strict=True))
    names = {m.instance for m, _ in thread.members if m.path == (PORTS,) or m.instance not in exchanging}
    exchange = sum(exchange_cost(node, instance) for instance in instances if instance.name in names)
    if exchange:
        work = (*work, constant("port exchange", exchange))
    _check_gcd(thread, period, known, work, report)
    return _Draft(thread, period, work, tuple(one for _, one in executed), tuple(instances))


def exchange_cost(node: Node, instance: Instance) -> int:
    """What copying the ports costs at each activation: as given for the instance, else for all; a later value, of an
    extending deployment, goes before an earlier one."""
    costs = {name: cost for name, cost, _ in node.exchanges if name in (instance.name, "")}
    return costs.get(instance.name, costs.get("", 0))


def _report_period(thread: Thread, period: int | None, report: Report) -> None:
    if period is None:
        report.add(Diagnostic("MV401", f"nothing says when the thread `{thread.name}` runs", Label(thread.span)))
        return
    message = f"the period of the thread `{thread.name}` does not divide those of its regions"
    help_ = Fix("leave it out: the greatest common divisor is taken")
    span = thread.period.span if thread.period and thread.period.span else thread.span
    report.add(Diagnostic("MV401", message, Label(span), help=help_))


def _check_gcd(thread: Thread, period: int, periods: Sequence[int], work: tuple[Workload, ...], report: Report) -> None:
    """MV411: the thread runs more often than any of its regions (seed 000, equation (3))."""
    distinct = sorted(set(periods))
    if thread.period is not None or not distinct or period >= distinct[0]:
        return
    every = format_time(period)
    cost = sum(part.curve.total(1) for part in work)
    share = f"{100 * cost / period:.0f} % of that"
    members = " and ".join(format_time(p) for p in distinct)
    message = f"thread `{thread.name}` must run every {every}, more often than any of its regions"
    label = Label(thread.members[0][1] if thread.members else thread.span, f"regions of {members}")
    listed = ", ".join(format_time(p) for p in distinct)
    notes = (f"{every} = gcd({listed}); a job costs up to {format_time(cost)}, {share}",)
    help_ = Fix(f"put the regions of {members} into threads of their own")
    report.add(Diagnostic("MV411", message, label, Severity.WARNING, notes=notes, help=help_))


def _prioritised(drafts: Sequence[_Draft]) -> list[PlacedTask]:
    """The threads with priorities and deadlines; missing ones by default, which is marked."""
    ranks = rate_monotonic([(d.period, d.thread.priority.value if d.thread.priority else None) for d in drafts])
    placed: list[PlacedTask] = []
    for draft, rank in zip(drafts, ranks, strict=True):
        thread = draft.thread
        priority = thread.priority or Setting(rank, None, "rate monotonic")
        deadline = _deadline(draft)
        jitter = max([thread.jitter, *(instance.jitter for instance in draft.instances)])
        task = Task(thread.name, priority.value, draft.period, deadline.value, draft.work, jitter)
        one = PlacedTask(task, draft.machines, draft.instances, thread.span, priority, deadline, thread.locked)
        placed.append(one)
    return placed


def _deadline(draft: _Draft) -> Setting:
    """The deadline written for the thread, and those written for its instances: the shortest. The period without."""
    written = [draft.thread.deadline, *(instance.deadline for instance in draft.instances)]
    known = [setting for setting in written if setting is not None and not setting.default]
    return min(known, key=lambda setting: setting.value, default=Setting(draft.period, None, "the period"))
