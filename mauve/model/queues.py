"""Queues: fan-in needs them, and none may overflow unless the model says what happens then (MV205, MV206).

In-ports are copied at each release of the consumer, for each region that is due then, out-ports published when a job of
the producer ends, by its deadline. Between two copies, T_c + J_c apart at most, jobs of a producer can end that were
released up to D_p earlier: no more than ceil((T_c + J_c + J_p + D_p) / T_p) elements arrive.
"""

from __future__ import annotations

from collections.abc import Mapping

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.model import DataConnection, Endpoint, Instance
from mauve.model.periods import instance_period, reading_period
from mauve.model.wakeups import event_ports
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


def most_arrivals(port: str, producer: Instance, consumer: Instance, window: int | None = None) -> int | None:
    """The most elements from `producer` between two copies of the consumer's `port`, for a region that is activated
    every `window`, else for the slowest that reads it; None where nothing bounds it.

    A sporadic consumer may sleep for ever, except that an element of one of its event ports wakes it: what waits then
    has arrived within its own release jitter.
    """
    period = instance_period(producer)
    window = window or reading_period(consumer, port)
    if consumer.sporadic:
        window = 0 if port in event_ports(consumer) else None
    if period is None or window is None:
        return None
    delay = producer.deadline.value if producer.deadline is not None else period
    span = window + consumer.jitter + producer.jitter + delay
    return span // period + 1 if consumer.sporadic else -(-span // period)


def _check_overflow(connection: DataConnection, instances: Mapping[str, Instance], report: Report) -> None:
    producer, consumer = instances[connection.source.instance], instances[connection.target.instance]
    arrivals = most_arrivals(connection.target.name, producer, consumer)
    help_ = Fix("write what happens then: `drop oldest` or `drop newest`")
    if arrivals is None:
        who = producer if instance_period(producer) is None else consumer
        message = f"the queue of `{connection.target}` may overflow: nothing bounds the rate of `{who.name}`"
        label = Label(who.span, "it may sleep for any time" if who.sporadic else "no period")
        report.add(Diagnostic("MV206", message, Label(connection.span), labels=(label,), help=help_))
    elif connection.size is not None and arrivals > connection.size:
        message = f"the queue of `{connection.target}` holds {connection.size} elements, {arrivals} may arrive"
        empties = _rate(consumer, "empties it", reading_period(consumer, connection.target.name))
        note = f"{empties}, {_rate(producer, 'writes', instance_period(producer))}"
        help_ = Fix(f"make it `size {arrivals}`, or write what happens: `drop oldest` or `drop newest`")
        report.add(Diagnostic("MV206", message, Label(connection.span), notes=(note,), help=help_))


def _rate(instance: Instance, what: str, period: int | None) -> str:
    every = format_time(period or 0)
    if instance.sporadic:
        return f"`{instance.name}` {what} at least {every} apart"
    return f"`{instance.name}` {what} every {every}"
