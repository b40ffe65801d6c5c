"""Queues: fan-in needs them, and none may overflow unless the model says what happens then (MV205, MV206).

In-ports are copied at each release of the consumer, out-ports published when a job of the producer ends, by its
deadline. Between two copies, T_c + J_c apart at most, jobs of a producer can end that were released up to D_p
earlier: no more than ceil((T_c + J_c + J_p + D_p) / T_p) elements arrive.
"""

from __future__ import annotations

from collections.abc import Mapping

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.model import DataConnection, Endpoint, Instance
from mauve.units import format_time


def check_queues(connections: tuple[DataConnection, ...], instances: Mapping[str, Instance], report: Report) -> None:
    """Append MV205 for unbuffered fan-in and MV206 for queues that may overflow."""
    by_target: dict[Endpoint, list[DataConnection]] = {}
    for connection in connections:
        by_target.setdefault(connection.target, []).append(connection)
    for target, writers in by_target.items():
        if len(writers) > 1:
            _check_fan_in(target, writers, report)
        for connection in writers:
            if connection.size is not None and connection.overflow is None:
                _check_overflow(connection, instances, report)


def _check_fan_in(target: Endpoint, writers: list[DataConnection], report: Report) -> None:
    unbuffered = [connection for connection in writers if connection.size is None]
    if not unbuffered:
        return
    others = tuple(Label(other.span, "and by this one") for other in writers if other is not unbuffered[0])
    message = f"`{target}` has {len(writers)} writers and no buffer: one would overwrite the other"
    help_ = Fix("make the connections `buffered size N`, or let one component merge the data")
    primary = Label(unbuffered[0].span, "written by this connection")
    report.add(Diagnostic("MV205", message, primary, labels=others, help=help_))


def most_arrivals(producer: Instance, consumer: Instance) -> int | None:
    """The most elements between two copies of the consumer; None where a rate is not known."""
    if producer.period is None or consumer.period is None:
        return None
    delay = producer.deadline.value if producer.deadline is not None else producer.period.value
    window = consumer.period.value + consumer.jitter + producer.jitter + delay
    return -(-window // producer.period.value)


def _check_overflow(connection: DataConnection, instances: Mapping[str, Instance], report: Report) -> None:
    producer, consumer = instances[connection.source.instance], instances[connection.target.instance]
    arrivals = most_arrivals(producer, consumer)
    help_ = Fix("write what happens then: `drop oldest` or `drop newest`")
    if arrivals is None:
        who = producer if producer.period is None else consumer
        message = f"the queue of `{connection.target}` may overflow: nothing bounds the rate of `{who.name}`"
        report.add(
            Diagnostic("MV206", message, Label(connection.span), labels=(Label(who.span, "no period"),), help=help_)
        )
    elif connection.size is not None and arrivals > connection.size and producer.period and consumer.period:
        message = f"the queue of `{connection.target}` holds {connection.size} elements, {arrivals} may arrive"
        note = (
            f"`{consumer.name}` empties it every {format_time(consumer.period.value)}, "
            f"`{producer.name}` writes every {format_time(producer.period.value)}"
        )
        help_ = Fix(f"make it `size {arrivals}`, or write what happens: `drop oldest` or `drop newest`")
        report.add(Diagnostic("MV206", message, Label(connection.span), notes=(note,), help=help_))
