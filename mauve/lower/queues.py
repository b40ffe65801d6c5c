"""Queues that must not overflow, by what a deployment makes of their writers and readers (MV206).

The architecture is checked by the deadlines written there (`model/queues.py`). Threads may have other jitters, and jobs
may end later than by any deadline: here the responses count. Between two copies, T_c + J_c apart at most, a task that
publishes by R after its nominal arrivals, T_p apart, adds no more than ceil((T_c + J_c + R) / T_p) elements. A consumer
that the elements wake finds those that came within its own release jitter J: no more than floor((J + R) / T_p) + 1.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Severity
from mauve.lower.flows import touching
from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.model.model import DataConnection, Deployment, Instance
from mauve.model.periods import instance_period, reading_period
from mauve.model.wakeups import event_ports
from mauve.timing.response import Analysis
from mauve.units import format_time

Responses = Mapping[str, int]


def check_overflow(
    deployment: Deployment, nodes: Sequence[tuple[NodeTasks, Analysis | None]]
) -> tuple[Diagnostic, ...]:
    """MV206 for each queue without an overflow policy that may overflow; nothing where a response has no bound, which
    is told by itself."""
    responses = {r.task: r.wcrt for _, analysis in nodes if analysis is not None for r in analysis.results}
    known = {name: response for name, response in responses.items() if response is not None}
    if len(known) < len(responses):
        return ()
    tasks = [placed for node, _ in nodes for placed in node.tasks]
    instances = {instance.name: instance for instance in deployment.architecture.instances}
    return tuple(
        found
        for connection in deployment.architecture.data
        if connection.size is not None and connection.overflow is None
        if (found := _check(connection, instances, tasks, known, deployment)) is not None
    )


def _check(
    connection: DataConnection,
    instances: Mapping[str, Instance],
    tasks: Sequence[PlacedTask],
    responses: Responses,
    deployment: Deployment,
) -> Diagnostic | None:
    writer, reader = instances[connection.source.instance], instances[connection.target.instance]
    period = instance_period(writer)
    regions = touching(writer, connection.source.name)
    writers = [
        (one, part.period or period)
        for one in tasks
        for part in one.machines
        if part.region in regions and (part.period or period) is not None
    ]
    readers = [one for one in tasks if reader in one.instances]
    if period is None or not writers or not readers or connection.size is None:
        return None
    arrivals = sum(
        _arrivals(connection, reader, readers, every or period, responses[one.task.name]) for one, every in writers
    )
    if arrivals <= connection.size:
        return None
    message = f"the queue of `{connection.target}` holds {connection.size} elements, {arrivals} may arrive"
    message += f" (deployment `{deployment.name}`)"
    severity = Severity.ERROR if deployment.expect_unschedulable is None else Severity.NOTE
    latest, every = max(writers, key=lambda one: responses[one[0].task.name])
    notes = (
        f"`{writer.name}` writes every {format_time(every or period)}, by "
        f"{format_time(responses[latest.task.name])} after its "
        f"arrival; task `{readers[0].task.name}` empties it, released up to {format_time(_late(reader, readers))} late",
    )
    help_ = Fix(f"make it `size {arrivals}`, or write what happens: `drop oldest` or `drop newest`")
    return Diagnostic("MV206", message, Label(connection.span), severity, notes=notes, help=help_)


def _arrivals(
    connection: DataConnection, reader: Instance, readers: Sequence[PlacedTask], period: int, response: int
) -> int:
    if reader.sporadic and connection.target.name in event_ports(reader):
        return (reader.jitter + response) // period + 1
    window = reading_period(reader, connection.target.name) or max(one.task.period for one in readers)
    return -(-(window + _late(reader, readers) + response) // period)


def _late(reader: Instance, readers: Sequence[PlacedTask]) -> int:
    """How late a task that reads may be released."""
    return reader.jitter if reader.sporadic else max(one.task.jitter for one in readers)
