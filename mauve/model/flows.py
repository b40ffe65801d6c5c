"""Flows: from a port to another along connections, `...` standing for the only way there is (MV216).

A flow names ports, methods and operations. Between two points that stand side by side there is a connection, or the
component that both belong to. Data also go with a call: arguments to the provider, the result back to the caller.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.model import (
    ComponentKind,
    DataConnection,
    Endpoint,
    Flow,
    FlowStep,
    Instance,
    Port,
    PortKind,
    ServiceConnection,
    Setting,
)
from mauve.model.names import unknown
from mauve.model.wakeups import event_ports
from mauve.records import record
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.quantities import time_of

MOST_WAYS = 64
"""Ways that are looked at for one `...`."""

LONGEST = 32
"""Instances on a way for one `...`."""


@record
class _Point:
    """A written point; `enters`: data come in there (an in port, an operation), else they go out."""

    at: Endpoint
    enters: bool
    span: Span


@record
class _Edge:
    """Data go from one instance to another. `answer` is the way back of a call."""

    source: Endpoint
    target: Endpoint
    answer: bool = False


_Way = tuple[_Edge, ...]


def resolve_flows(
    declarations: Sequence[ast.FlowDecl],
    instances: Mapping[str, Instance],
    data: Sequence[DataConnection],
    services: Sequence[ServiceConnection],
    report: Report,
) -> tuple[Flow, ...]:
    """The flows of an architecture, each as the instances it passes; those in error are reported and left out."""
    edges = list(_edges(instances, data, services))
    seen: dict[str, Span] = {}
    found: list[Flow] = []
    for declaration in declarations:
        name = declaration.name
        if name.text in seen:
            labels = (Label(seen[name.text], "first here"),)
            report.add(Diagnostic("MV103", f"there are two flows named `{name}`", Label(name.span), labels=labels))
        seen.setdefault(name.text, name.span)
        flow = _flow(declaration, instances, edges, report)
        if flow is not None:
            found.append(flow)
    return tuple(found)


def _edges(
    instances: Mapping[str, Instance], data: Sequence[DataConnection], services: Sequence[ServiceConnection]
) -> Iterator[_Edge]:
    for connection in data:
        yield _Edge(connection.source, connection.target)
    for service in services:
        yield _Edge(service.caller, service.provider)
        component = instances[service.provider.instance].component
        if any(o.name == service.provider.name and o.result is not None for o in component.operations):
            yield _Edge(service.provider, service.caller, answer=True)


def _flow(
    declaration: ast.FlowDecl, instances: Mapping[str, Instance], edges: Sequence[_Edge], report: Report
) -> Flow | None:
    within = time_of(declaration.within, report) if declaration.within is not None else None
    if within is not None and within <= 0 and declaration.within is not None:
        label = Label(declaration.within.span, "must be longer than 0")
        report.add(Diagnostic("MV401", f"a flow within {declaration.within.span.text}", label))
        return None
    points: list[tuple[_Point, bool]] = []
    elided = False
    for path in declaration.points:
        if path is not None:
            point = _point(path, instances, report)
            if point is None:
                return None
            points.append((point, elided))
        elided = path is None
    if len(points) < 2:
        return None
    way: list[_Edge] = []
    for (before, _), (after, skipped) in pairwise(points):
        leg = _leg(before, after, skipped, instances, edges, report)
        if leg is None:
            return None
        way += leg
    steps = tuple(_steps(points[0][0], way, points[-1][0], instances))
    if not steps:
        message = f"the flow `{declaration.name}` passes no component that has a task"
        report.add(Diagnostic("MV216", message, Label(declaration.span)))
        return None
    span = declaration.within.span if declaration.within is not None else declaration.name.span
    setting = Setting(within, span) if within is not None else None
    return Flow(declaration.name.text, steps, setting, declaration.latency, declaration.name.span)


def _point(path: ast.Path, instances: Mapping[str, Instance], report: Report) -> _Point | None:
    first = path.parts[0]
    instance = instances.get(first.text)
    if instance is None:
        known = {name: one.span for name, one in instances.items()}
        label = "a flow leads over `instance.port`"
        report.add(unknown("MV106", f"there is no instance `{first}`", label, first.span, known, "an instance"))
        return None
    component = instance.component
    items: dict[str, tuple[bool, Span]] = {p.name: (_comes_in(p), p.span) for p in component.ports}
    items |= {m.name: (False, m.span) for m in component.methods}
    items |= {o.name: (True, o.span) for o in component.operations}
    name = path.parts[1] if len(path.parts) == 2 else None
    if name is None or name.text not in items:
        spans = {key: span for key, (_, span) in items.items()}
        message = f"`{path}` is no port, method or operation of an instance"
        shown = path.parts[-1].span if name is None else name.span
        listed = ", ".join(f"`{first}.{key}`" for key in items)
        label = f"there is {listed}" if items else "it has none"
        report.add(unknown("MV112", message, label, shown, spans, "a port"))
        return None
    return _Point(Endpoint(instance.name, name.text), items[name.text][0], path.span)


def _comes_in(port: Port) -> bool:
    return port.kind is not PortKind.OUT


def _leg(
    before: _Point,
    after: _Point,
    skipped: bool,
    instances: Mapping[str, Instance],
    edges: Sequence[_Edge],
    report: Report,
) -> _Way | None:
    """The connections between two points; None after a diagnostic."""
    if before.at.instance == after.at.instance and (before.enters or before.at == after.at):
        return ()
    ways = list(_ways(before, after, instances, edges, LONGEST if skipped else 1))
    routes = list(dict.fromkeys(_route(way) for way in ways))
    if len(routes) == 1:
        return min((way for way in ways), key=lambda way: sum(_wakes(edge, instances) for edge in way))
    labels = (Label(after.span, "to this point"),)
    if routes:
        some = [" -> ".join(route) for route in routes[:4]]
        more = "" if len(routes) <= 4 else f" and {len(routes) - 4} more"
        message = f"there are {len(routes)} ways from `{before.at}` to `{after.at}`, so `...` is ambiguous"
        notes = ("the flow may run over " + ", or over ".join(some) + more,)
        named = Fix("name a port between them that only the way you mean passes")
        report.add(Diagnostic("MV216", message, Label(before.span), labels=labels, notes=notes, help=named))
        return None
    message = f"no connection leads from `{before.at}` to `{after.at}`"
    help_: Fix | None = None
    if not skipped and next(_ways(before, after, instances, edges, LONGEST), None) is not None:
        message = f"no connection leads from `{before.at}` straight to `{after.at}`"
        help_ = Fix("write `...` between them: there is a way over other components")
    report.add(Diagnostic("MV216", message, Label(before.span), labels=labels, help=help_))
    return None


def _route(way: _Way) -> tuple[str, ...]:
    """The instances that a way passes."""
    return (way[0].source.instance, *(edge.target.instance for edge in way)) if way else ()


def _ways(
    before: _Point, after: _Point, instances: Mapping[str, Instance], edges: Sequence[_Edge], longest: int
) -> Iterator[_Way]:
    """Ways that pass no instance twice; those without the answer of a call where there are any."""
    for answers in (False, True):
        out: dict[str, list[_Edge]] = {}
        for edge in edges:
            if answers or not edge.answer:
                out.setdefault(edge.source.instance, []).append(edge)
        found = 0
        stack: list[tuple[str, _Way]] = [(before.at.instance, ())]
        tried = 0
        while stack and found < MOST_WAYS and tried < 100 * MOST_WAYS:
            tried += 1
            here, way = stack.pop()
            for edge in reversed(out.get(here, [])):
                there = edge.target.instance
                if not way and not before.enters and edge.source != before.at:
                    continue
                if there in (before.at.instance, *(one.target.instance for one in way)):
                    continue
                if there == after.at.instance:
                    if not after.enters or edge.target == after.at:
                        found += 1
                        yield (*way, edge)
                elif len(way) + 1 < longest and instances[there].component.kind is not ComponentKind.EXTERNAL:
                    stack.append((there, (*way, edge)))
        if found:
            return


def _wakes(edge: _Edge, instances: Mapping[str, Instance]) -> bool:
    """Whether what comes over a connection wakes the instance that reads it."""
    return not edge.answer and edge.target.name in event_ports(instances[edge.target.instance])


def _steps(first: _Point, way: Sequence[_Edge], last: _Point, instances: Mapping[str, Instance]) -> Iterator[FlowStep]:
    """The active instances that a flow passes, with where it comes in and goes out."""
    at = first.at.instance
    enters, woken = (first.at.name, False) if first.enters else ("", False)
    for edge in way:
        if instances[at].active:
            yield FlowStep(at, enters, edge.source.name if not edge.answer else "", woken)
        at, enters, woken = edge.target.instance, edge.target.name, _wakes(edge, instances)
    if instances[at].active:
        yield FlowStep(at, enters, last.at.name if not last.enters else "", woken)
