"""Data that codels of several tasks reach (semantics of record, section 1): races, and the sections that prevent them.

A passive component's data is protected by the critical section in which its operations run. Variables and out-ports of
an active component are not: they are shared when its regions run in several threads, or when an operation that runs in
its caller touches what its own codels use. `lock immediate_ceiling` in the process then makes each access a critical
section; without it, it is a race.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.lower.calls import Services, Use, uses
from mauve.lower.placed import PlacedTask
from mauve.model.model import CodelId, ComponentKind, Endpoint, Instance
from mauve.records import record
from mauve.source import Span
from mauve.timing.task import Section


@record
class Access:
    """A codel, executed by `task`, reads or writes a datum of an instance; `called` where it is an operation of it."""

    task: str
    codel: CodelId
    writes: bool
    called: bool
    span: Span


Shared = Mapping[Endpoint, tuple[Access, ...]]
"""Per datum that needs protection, every access to it."""


def task_uses(placed: PlacedTask, connected: Services) -> Iterator[tuple[Instance, Use]]:
    """The codels that a task executes, with the instance that does."""
    regions = {machine.region for machine in placed.machines}
    for instance in placed.instances:
        for use in uses(instance, connected):
            if use.region in regions:
                yield instance, use


def shared_data(tasks: Sequence[PlacedTask], connected: Services, instances: Mapping[str, Instance]) -> Shared:
    """The data of active components that several tasks reach, one of them writing, not all through operations."""
    found: dict[Endpoint, list[Access]] = {}
    for placed in tasks:
        for instance, use in task_uses(placed, connected):
            for owner, name, writes, called in _touched(instance, use, instances):
                access = Access(placed.task.name, use.codel, writes, called, use.span)
                found.setdefault(Endpoint(owner, name), []).append(access)
    return {
        datum: tuple(accesses)
        for datum, accesses in found.items()
        if len({access.task for access in accesses}) > 1
        and any(access.writes for access in accesses)
        and not all(access.called for access in accesses)
    }


def _touched(instance: Instance, use: Use, instances: Mapping[str, Instance]) -> Iterator[tuple[str, str, bool, bool]]:
    """Instance, name, whether it writes, whether by a call."""
    for names, writes in ((use.reads, False), (use.writes, True)):
        yield from ((instance.name, name, writes, False) for name in names)
    provider = instances.get(use.provider)
    if use.waits or provider is None or provider.component.kind is not ComponentKind.ACTIVE:
        return
    codel = provider.component.codel(use.codel.codel)
    component = provider.component
    data = {port.name for port in component.ports} | {datum.name for datum in component.data}
    for names, writes in ((codel.reads, False), (codel.writes, True)):
        yield from ((provider.name, name, writes, True) for name in names if name in data)


def check_races(shared: Shared, tasks: Sequence[PlacedTask], instances: Mapping[str, Instance], report: Report) -> None:
    """MV214 for each datum that a task without a lock reaches."""
    unlocked = {placed.task.name for placed in tasks if not placed.locked}
    for datum, accesses in shared.items():
        if not any(access.task in unlocked for access in accesses):
            continue
        first = next(access for access in accesses if access.writes)
        other = next(access for access in accesses if access.task != first.task)
        message = f"`{datum}` is written in one task and used in another, and nothing protects it"
        word = "writes" if other.writes else "reads"
        labels = (Label(other.span, f"`{other.codel}` {word} it in task `{other.task}`"),)
        if any(access.called for access in accesses):
            help_ = Fix("move the data and the operation to a passive component, which protects them")
        else:
            help_ = Fix("write `lock immediate_ceiling` in the process, or let one thread run both regions")
        primary = Label(first.span, f"`{first.codel}` writes it in task `{first.task}`")
        report.add(Diagnostic("MV214", message, primary, labels=labels, help=help_))


def data_sections(placed: PlacedTask, shared: Shared, times: Mapping[CodelId, int]) -> Iterator[Section]:
    """The critical sections of a task around shared data: each as long as the codel that is in it."""
    for datum, accesses in shared.items():
        for access in accesses:
            if access.task == placed.task.name and access.codel in times:
                what = f"`{access.codel}`, which uses `{datum}`"
                yield Section(str(datum), access.task, what, times[access.codel], str(access.codel))
