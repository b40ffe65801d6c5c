"""Event ports: a declared least separation is checked against the rates of those who write them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.model import DataConnection, Endpoint, Instance, PortKind
from mauve.model.periods import instance_period
from mauve.model.reachability import components, reversed_graph
from mauve.units import format_time


def event_ports(instance: Instance) -> frozenset[str]:
    """The event ports that wake an instance: those of a sporadic one."""
    if not instance.sporadic:
        return frozenset()
    return frozenset(port.name for port in instance.component.ports if port.kind is PortKind.EVENT)


def waking(instance: Instance, connections: Sequence[DataConnection]) -> tuple[DataConnection, ...]:
    """The connections whose data wake an instance through its event ports."""
    events = event_ports(instance)
    return tuple(c for c in connections if c.target.name in events and c.target.instance == instance.name)


def check_separations(
    connections: Sequence[DataConnection],
    external: Sequence[Endpoint],
    instances: Mapping[str, Instance],
    report: Report,
) -> None:
    """MV401 where the writers of the event ports of an instance together write more often than its separation allows
    or at an unknown rate beside known ones, and where instances wake each other in a circle."""
    events = {name: ports for name, instance in instances.items() if (ports := event_ports(instance))}
    wakers: dict[str, list[DataConnection]] = {}
    for connection in connections:
        if connection.target.name in events.get(connection.target.instance, ()):
            wakers.setdefault(connection.target.instance, []).append(connection)
    outside = {endpoint.instance for endpoint in external if endpoint.name in events.get(endpoint.instance, ())}
    for name, connected in wakers.items():
        _check_rate(instances[name], connected, name in outside, instances, report)
    _check_circles(wakers, instances, report)


def _check_rate(
    instance: Instance,
    connected: Sequence[DataConnection],
    outside: bool,
    instances: Mapping[str, Instance],
    report: Report,
) -> None:
    """A single writer of unknown rate, outside the model, is taken at the word of the declared separation."""
    periods = [(c, instance_period(instances[c.source.instance])) for c in connected]
    unknown = [c for c, period in periods if period is None]
    span = instance.period.span if instance.period and instance.period.span else instance.span
    if instance.period is None or (len(connected) == 1 and unknown and not outside):
        return
    if unknown or outside:
        message = f"`{instance.name}` is woken by several writers, and nothing bounds how often one of them writes"
        label = Label(unknown[0].span, "this writer has no period") if unknown else Label(connected[0].span, "and this")
        help_ = Fix("give the external component a `period` or a `sporadic` separation")
        report.add(Diagnostic("MV401", message, Label(span, "the least separation"), labels=(label,), help=help_))
        return
    rate = sum(Fraction(1, period) for _, period in periods if period)
    if rate * instance.period.value <= 1:
        return
    labels = tuple(Label(c.span, f"writes every {format_time(period)}") for c, period in periods if period)
    message = f"`{instance.name}` is woken more often than every {format_time(instance.period.value)}"
    help_ = Fix(f"write `sporadic {format_time(int(1 / rate), down=True)}`, or slow the writers down")
    report.add(Diagnostic("MV401", message, Label(span, "the least separation"), labels=labels, help=help_))


def _check_circles(
    wakers: Mapping[str, Sequence[DataConnection]], instances: Mapping[str, Instance], report: Report
) -> None:
    """Instances that only wake each other: no period damps the jitter of their events."""
    before = {name: [c.source.instance for c in connected] for name, connected in wakers.items()}
    for component in components(tuple(before), before, reversed_graph(before)):
        first = component[0]
        if len(component) == 1 and first not in before.get(first, ()):
            continue
        link = next(c for c in wakers[first] if c.source.instance in component)
        message = "`" + "`, `".join(component) + "` wake each other in a circle"
        if len(component) == 1:
            message = f"`{first}` wakes itself"
        labels = (Label(instances[first].span, "it has no period of its own"),)
        help_ = Fix("give one of them a `period`, so that it reads the port when it runs")
        primary = Label(link.span, "a link of the circle")
        report.add(Diagnostic("MV401", message, primary, labels=labels, help=help_))
