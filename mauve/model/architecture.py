"""From a written architecture to a resolved one: instances with their execution attributes, connections, defaults."""

from __future__ import annotations

from collections.abc import Mapping

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.model.connections import resolve_connections
from mauve.model.execution import execution_settings
from mauve.model.flows import resolve_flows
from mauve.model.model import Architecture, Component, ComponentKind, Endpoint, Instance, PortKind, Setting
from mauve.model.names import Scope, duplicate, unknown
from mauve.model.periods import instance_period
from mauve.model.priorities import rate_monotonic
from mauve.model.typing import TypeTable, check_value
from mauve.model.wakeups import check_separations
from mauve.records import changed, record
from mauve.source import Span
from mauve.syntax import ast


@record
class Context:
    """What an architecture is resolved against: resolved components by the identity of their declaration."""

    scope: Scope
    types: TypeTable
    components: Mapping[int, Component]


def resolve_architecture(declaration: ast.ArchitectureDecl, context: Context, report: Report) -> Architecture:
    """The architecture of a declaration, with defaults applied and marked."""
    instances: dict[str, Instance] = {}
    failed: set[str] = set()
    for item in declaration.instances:
        if item.name.text in instances or item.name.text in failed:
            first = instances.get(item.name.text)
            report.add(duplicate("instance", item.name, first.span if first else item.name.span))
            continue
        instance = _instance(item, context, report)
        if instance is None:
            failed.add(item.name.text)
        else:
            instances[item.name.text] = instance
    _check_component_names(tuple(instances.values()), report)
    with_defaults = apply_defaults(tuple(instances.values()))
    instances = {instance.name: instance for instance in with_defaults}
    external = _external(declaration, instances, failed, report)
    data, services = resolve_connections(declaration, instances, frozenset(failed), external, report)
    endpoints = tuple(endpoint for endpoint, _ in external)
    check_separations(data, endpoints, instances, report)
    name = declaration.name
    flows = resolve_flows(declaration.flows, instances, data, services, report) if not failed else ()
    return Architecture(name.text, with_defaults, data, services, endpoints, not failed, name.span, flows)


def _check_component_names(instances: tuple[Instance, ...], report: Report) -> None:
    """Codels are told apart by the name of their component: one architecture has no two components of one name."""
    first: dict[str, Instance] = {}
    for instance in instances:
        other = first.setdefault(instance.component.name, instance)
        if other.component is not instance.component:
            message = f"`{instance.name}` and `{other.name}` are of different components named `{other.component.name}`"
            labels = (Label(other.component.span, "one"), Label(instance.component.span, "the other"))
            help_ = Fix("rename one of the components")
            report.add(Diagnostic("MV103", message, Label(instance.span), labels=labels, help=help_))


def _instance(item: ast.InstanceDecl, context: Context, report: Report) -> Instance | None:
    scope = context.scope
    found = scope.find(item.component, (ast.ComponentDecl,))
    component = context.components.get(id(found)) if found is not None else None
    if component is None:
        known = {name: d.name.span for name, d in scope.of_kind((ast.ComponentDecl,)).items()}
        message = f"there is no component `{item.component}`"
        report.add(unknown("MV101", message, scope.where(), item.component.span, known, "a component"))
        return None
    if isinstance(found, ast.ComponentDecl):
        _check_assignments(item, found, component, context.types, report)
    settings = execution_settings(item.attributes, report)
    period = settings.get(ast.Execution.PERIOD) or settings.get(ast.Execution.SPORADIC)
    instance = Instance(
        item.name.text, component, period, ast.Execution.SPORADIC in settings, settings.get(ast.Execution.DEADLINE),
        settings.get(ast.Execution.PRIORITY), _value(settings, ast.Execution.OFFSET),
        _value(settings, ast.Execution.JITTER), item.name.span,
    )  # fmt: skip
    _check_activation(item, instance, settings, report)
    return instance


def _value(settings: Mapping[ast.Execution, Setting], kind: ast.Execution) -> int:
    return settings[kind].value if kind in settings else 0


def _check_activation(
    item: ast.InstanceDecl, instance: Instance, settings: Mapping[ast.Execution, Setting], report: Report
) -> None:
    """An active instance needs exactly one way of being woken; the others have none."""
    component, name = instance.component, item.name
    if not instance.active:
        allowed = {ast.Execution.PERIOD, ast.Execution.SPORADIC, ast.Execution.JITTER}
        for kind, setting in settings.items():
            if component.kind is ComponentKind.PASSIVE or kind not in allowed:
                message = f"`{name}` has no task, so it has no {kind.value}"
                labels = (Label(component.span, f"a {component.kind.value} component"),)
                report.add(Diagnostic("MV401", message, Label(setting.span or name.span), labels=labels))
        return
    written = {attribute.kind for attribute in item.attributes}
    if {ast.Execution.PERIOD, ast.Execution.SPORADIC} <= written:
        message = f"`{name}` is both periodic and sporadic"
        report.add(Diagnostic("MV401", message, Label(name.span), help=Fix("keep one of `period` and `sporadic`")))
    elif ast.Execution.SPORADIC in settings and all(port.kind is not PortKind.EVENT for port in component.ports):
        message = f"`{name}` is sporadic, but has no event port that wakes it"
        labels = (Label(component.span, "the component"),)
        help_ = Fix("give it an `event port`, or a `period`; as it is, it is taken to wake as often as it may")
        span = settings[ast.Execution.SPORADIC].span or name.span
        report.add(Diagnostic("MV401", message, Label(span), Severity.WARNING, labels, help=help_))
    if {ast.Execution.PERIOD, ast.Execution.SPORADIC} & written or not component.regions:
        return
    if instance_period(instance) is None:
        events = [port.name for port in component.ports if port.kind is PortKind.EVENT]
        help_ = Fix("write `{ period 10ms }`")
        if events:
            help_ = Fix(f"it is woken by `{events[0]}`: write `{{ sporadic 20ms }}`, the least time between two events")
        report.add(Diagnostic("MV401", f"nothing says when `{name}` runs", Label(name.span, "no period"), help=help_))


def _check_assignments(
    item: ast.InstanceDecl, declaration: ast.ComponentDecl, component: Component, types: TypeTable, report: Report
) -> None:
    properties = {datum.name: datum for datum in component.data if datum.is_property}
    seen: dict[str, Span] = {}
    for assignment in item.assignments:
        name = assignment.name
        if name.text not in properties:
            known = {n: d.span for n, d in properties.items()}
            label = "its properties are " + ", ".join(f"`{n}`" for n in known) if known else "it has no properties"
            message = f"`{declaration.name}` has no property `{name}`"
            report.add(unknown("MV113", message, label, name.span, known, "a property"))
        elif name.text in seen:
            report.add(duplicate("value", name, seen[name.text]))
        else:
            check_value(assignment.value, properties[name.text].type, report)
        seen.setdefault(name.text, name.span)


def apply_defaults(instances: tuple[Instance, ...]) -> tuple[Instance, ...]:
    """Seed 001, section IV.D: the deadline is the period, a shorter period has the higher priority. Values taken by
    default are marked; they are reported where a deployment uses them."""
    active = [instance for instance in instances if instance.active]
    periods = {instance.name: instance_period(instance) for instance in active}
    ranks = rate_monotonic([(periods[i.name] or 0, i.priority.value if i.priority else None) for i in active])
    ranked = {i.name: Setting(rank, None, "rate monotonic") for i, rank in zip(active, ranks, strict=True)}
    return tuple(
        changed(
            instance,
            priority=instance.priority or ranked[instance.name],
            deadline=_deadline(instance, periods[instance.name]),
        )
        if instance.active
        else instance
        for instance in instances
    )


def _deadline(instance: Instance, period: int | None) -> Setting | None:
    if instance.deadline is not None or period is None:
        return instance.deadline
    return Setting(period, None, "the period")


def _external(
    declaration: ast.ArchitectureDecl, instances: Mapping[str, Instance], failed: set[str], report: Report
) -> list[tuple[Endpoint, Span]]:
    found: list[tuple[Endpoint, Span]] = []
    for item in declaration.externals:
        for path in item.ports:
            instance = instances.get(path.parts[0].text)
            if instance is None or len(path.parts) != 2:
                if path.parts[0].text not in failed:
                    known = {name: i.span for name, i in instances.items()}
                    message = f"there is no instance `{path.parts[0]}`"
                    if len(path.parts) != 2:
                        message = f"`{path}` is no port of an instance"
                    report.add(
                        unknown("MV106", message, "write `instance.port`", path.parts[0].span, known, "an instance")
                    )
                continue
            ports = {port.name: port.span for port in instance.component.ports if port.kind is not PortKind.OUT}
            name = path.parts[1]
            if name.text not in ports:
                label = "its in ports are " + ", ".join(f"`{n}`" for n in ports) if ports else "it has no in ports"
                message = f"`{instance.component.name}` has no in port `{name}`"
                report.add(unknown("MV112", message, label, name.span, ports, "a port"))
                continue
            found.append((Endpoint(instance.name, name.text), path.span))
    return found
