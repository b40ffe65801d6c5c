"""Event ports: a declared least separation is checked against the rates of those who write the port."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.model import DataConnection, Instance, PortKind
from mauve.units import format_time


def waking(instance: Instance, connections: Sequence[DataConnection]) -> tuple[DataConnection, ...]:
    """The connections whose data wake a sporadic instance through its event ports."""
    if not instance.sporadic:
        return ()
    events = {port.name for port in instance.component.ports if port.kind is PortKind.EVENT}
    return tuple(c for c in connections if c.target.instance == instance.name and c.target.name in events)


def check_separations(connections: Sequence[DataConnection], instances: Mapping[str, Instance], report: Report) -> None:
    """MV401 where the writers of an event port together write more often than the separation of its instance allows."""
    for instance in instances.values():
        wakers = waking(instance, connections)
        periods = [(c, instances[c.source.instance].period) for c in wakers]
        known = [(c, period) for c, period in periods if period is not None]
        if not known or instance.period is None or len(known) < len(periods):
            continue
        rate = sum(Fraction(1, period.value) for _, period in known)
        if rate * instance.period.value <= 1:
            continue
        labels = tuple(Label(c.span, f"writes every {format_time(period.value)}") for c, period in known)
        message = f"`{instance.name}` is woken more often than every {format_time(instance.period.value)}"
        help_ = Fix(f"write `sporadic {format_time(int(1 / rate), down=True)}`, or slow the writers down")
        span = instance.period.span or instance.span
        report.add(Diagnostic("MV401", message, Label(span, "the least separation"), labels=labels, help=help_))
