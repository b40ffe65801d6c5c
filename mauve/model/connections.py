"""Connections of an architecture and the checks of port semantics (semantics of record, section 1)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label, Report, Severity
from mauve.model.calls import check_calls
from mauve.model.model import (
    CallMethod,
    Component,
    ComponentKind,
    DataConnection,
    Endpoint,
    Instance,
    Method,
    Operation,
    Port,
    PortKind,
    Region,
    ServiceConnection,
)
from mauve.model.names import unknown
from mauve.model.queues import check_queues
from mauve.model.typing import check_value
from mauve.records import record
from mauve.source import Span
from mauve.syntax import ast

LARGEST_BUFFER = 1 << 16


@record
class _End:
    """One end of a written connection, resolved."""

    instance: Instance
    name: str
    item: Port | Method | Operation
    span: Span

    @property
    def endpoint(self) -> Endpoint:
        return Endpoint(self.instance.name, self.name)

    @property
    def is_source(self) -> bool:
        """Whether data or a call may start here."""
        return isinstance(self.item, Method) or (isinstance(self.item, Port) and self.item.kind is PortKind.OUT)

    @property
    def is_port(self) -> bool:
        return isinstance(self.item, Port)

    @property
    def kind(self) -> str:
        match self.item:
            case Port(kind=kind):
                return f"{'an' if kind.value[0] in 'aeiou' else 'a'} {kind.value} port"
            case Method():
                return "a method"
            case Operation():
                return "an operation"


def resolve_connections(
    declaration: ast.ArchitectureDecl,
    instances: Mapping[str, Instance],
    failed: frozenset[str],
    external: list[tuple[Endpoint, Span]],
    report: Report,
) -> tuple[tuple[DataConnection, ...], tuple[ServiceConnection, ...]]:
    """The data and service connections; those in error are reported and left out."""
    data: dict[tuple[Endpoint, Endpoint], DataConnection] = {}
    services: dict[Endpoint, ServiceConnection] = {}
    touched: set[Endpoint] = set()
    for item in declaration.connections:
        source = _end(item.source, instances, failed, report, True)
        touched |= _touched(item.source, source, instances)
        for path in item.targets:
            target = _end(path, instances, failed, report, False)
            touched |= _touched(path, target, instances)
            if source is None or target is None or not _directions_fit(item, source, target, report):
                continue
            if isinstance(source.item, Port) and isinstance(target.item, Port):
                connection = _data(item, source, target, report)
                if connection is not None and _fresh(connection, data, report):
                    data[connection.source, connection.target] = connection
            elif isinstance(source.item, Method) and isinstance(target.item, Operation):
                service = _service(item, source, target, report)
                if service is not None and _method_free(service, services, report):
                    services[service.caller] = service
    check_queues(tuple(data.values()), instances, report)
    check_calls(tuple(services.values()), instances, report)
    _check_unconnected(instances, tuple(data.values()), external, touched, report)
    return tuple(data.values()), tuple(services.values())


def _touched(path: ast.Path, end: _End | None, instances: Mapping[str, Instance]) -> set[Endpoint]:
    """What the end of a written connection may mean, right or wrong: it is not reported as unconnected too."""
    if end is not None:
        return {end.endpoint}
    instance = instances.get(path.parts[0].text)
    return {Endpoint(instance.name, name) for name in _items(instance.component)} if instance else set()


def _end(
    path: ast.Path, instances: Mapping[str, Instance], failed: frozenset[str], report: Report, is_source: bool
) -> _End | None:
    first = path.parts[0]
    instance = instances.get(first.text)
    if instance is None:
        if first.text not in failed:
            known = {name: i.span for name, i in instances.items()}
            label = "its instances are " + ", ".join(f"`{n}`" for n in known) if known else "there are no instances"
            report.add(unknown("MV106", f"there is no instance `{first}`", label, first.span, known, "an instance"))
        return None
    component = instance.component
    if len(path.parts) != 2:
        message = f"`{path}` is no port, method or operation of an instance"
        report.add(Diagnostic("MV112", message, Label(path.span, "write `instance.port`")))
        return None
    name = path.parts[1]
    items = _items(component)
    if name.text in items:
        return _End(instance, name.text, items[name.text], path.span)
    wanted = [n for n, item in items.items() if _End(instance, n, item, path.span).is_source == is_source]
    ports = [f"`{n}`" for n in wanted if isinstance(items[n], Port)]
    kind = "out ports" if is_source else "in ports"
    label = f"its {kind} are {_listed(ports)}" if ports else f"it has no {kind}"
    spans = {n: items[n].span for n in wanted}
    report.add(unknown("MV112", f"`{component.name}` has no port `{name}`", label, name.span, spans, "a port"))
    return None


def _listed(names: list[str]) -> str:
    return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))


def _items(component: Component) -> dict[str, Port | Method | Operation]:
    ports: dict[str, Port | Method | Operation] = {port.name: port for port in component.ports}
    methods = {method.name: method for method in component.methods}
    return ports | methods | {operation.name: operation for operation in component.operations}


def _directions_fit(item: ast.ConnectDecl, source: _End, target: _End, report: Report) -> bool:
    if source.is_port != target.is_port:
        labels = (Label(target.span, f"this is {target.kind}"),)
        message = f"{source.kind} cannot be connected to {target.kind}"
        help_ = Fix("ports are connected to ports, methods to operations")
        report.add(
            Diagnostic("MV204", message, Label(source.span, f"this is {source.kind}"), labels=labels, help=help_)
        )
        return False
    if source.is_source and not target.is_source:
        return True
    if not source.is_source and target.is_source:
        swapped = f"connect {target.span.text} -> {source.span.text}"
        edits = (
            (Edit(source.span, target.span.text), Edit(target.span, source.span.text)) if len(item.targets) == 1 else ()
        )
        labels = (Label(target.span, "this one is written" if source.is_port else "this one calls"),)
        message = f"the connection runs backwards: `{source.span.text}` is {source.kind}"
        help_ = Fix(f"swap the ends: `{swapped}`", edits, Applicability.MACHINE)
        report.add(Diagnostic("MV204", message, Label(source.span), labels=labels, help=help_))
        return False
    wrong, role = (target, "end in") if source.is_source else (source, "begin at")
    message = f"a connection cannot {role} `{wrong.span.text}`: it is {wrong.kind}"
    report.add(Diagnostic("MV204", message, Label(wrong.span), help=Fix("connect an out port to an in or event port")))
    return False


def _data(item: ast.ConnectDecl, source: _End, target: _End, report: Report) -> DataConnection | None:
    assert isinstance(source.item, Port) and isinstance(target.item, Port)
    if source.item.type != target.item.type:
        labels = (
            Label(source.item.type_span, f"written as `{source.item.type}`"),
            Label(target.item.type_span, f"read as `{target.item.type}`"),
        )
        message = f"a `{source.item.type}` cannot flow into a port of type `{target.item.type}`"
        report.add(Diagnostic("MV201", message, Label(source.span.to(target.span)), labels=labels))
        return None
    size = None
    if item.policy is not None:
        if item.policy.initial is not None:
            check_value(item.policy.initial, target.item.type, report)
        if item.policy.buffered:
            size = _size(item.policy, target, report)
    overflow = item.policy.overflow if item.policy else None
    return DataConnection(source.endpoint, target.endpoint, size, overflow, source.span.to(target.span))


def _size(policy: ast.Policy, target: _End, report: Report) -> int:
    """The elements of a buffer; the most possible after a diagnostic, so that no overflow follows from it."""
    if policy.size is None:
        message = f"the queue of `{target.span.text}` has no bound"
        help_ = Fix("write how many elements it holds: `buffered size 16`")
        report.add(Diagnostic("MV213", message, Label(policy.span, "no size"), help=help_))
        return LARGEST_BUFFER
    size = policy.size
    if not size.is_integer or not 1 <= size.integer <= LARGEST_BUFFER:
        message = f"a buffer cannot hold {size.text} elements"
        report.add(Diagnostic("MV209", message, Label(size.span, f"a whole number from 1 to {LARGEST_BUFFER}")))
        return LARGEST_BUFFER
    return size.integer


def _fresh(
    connection: DataConnection, earlier: Mapping[tuple[Endpoint, Endpoint], DataConnection], report: Report
) -> bool:
    other = earlier.get((connection.source, connection.target))
    if other is not None:
        message = f"`{connection.source}` is connected to `{connection.target}` twice"
        report.add(Diagnostic("MV212", message, Label(connection.span), labels=(Label(other.span, "first here"),)))
    return other is None


def _service(item: ast.ConnectDecl, source: _End, target: _End, report: Report) -> ServiceConnection | None:
    method, operation = source.item, target.item
    assert isinstance(method, Method) and isinstance(operation, Operation)
    if item.policy is not None:
        message = "a call has no buffer"
        report.add(Diagnostic("MV209", message, Label(item.policy.span), help=Fix("remove the connection policy")))
    wanted = [type_ for _, type_ in method.parameters]
    offered = [type_ for _, type_ in operation.parameters]
    if wanted != offered or method.result != operation.result:
        labels = (
            Label(method.span, f"called as `{_signature(method)}`"),
            Label(operation.span, f"provided as `{_signature(operation)}`"),
        )
        message = f"the method `{method.name}` and the operation `{operation.name}` have different signatures"
        report.add(Diagnostic("MV207", message, Label(source.span.to(target.span)), labels=labels))
        return None
    return ServiceConnection(source.endpoint, target.endpoint, source.span.to(target.span))


def _signature(service: Method | Operation) -> str:
    parameters = ", ".join(f"{name}: {type_}" for name, type_ in service.parameters)
    return f"{service.name}({parameters})" + (f": {service.result}" if service.result else "")


def _method_free(service: ServiceConnection, earlier: Mapping[Endpoint, ServiceConnection], report: Report) -> bool:
    other = earlier.get(service.caller)
    if other is not None:
        message = f"the method `{service.caller}` is connected to two operations"
        report.add(Diagnostic("MV212", message, Label(service.span), labels=(Label(other.span, "first here"),)))
    return other is None


def _check_unconnected(
    instances: Mapping[str, Instance],
    data: tuple[DataConnection, ...],
    external: list[tuple[Endpoint, Span]],
    touched: set[Endpoint],
    report: Report,
) -> None:
    """MV211 for in ports that nobody writes, MV210 for called methods that nobody provides, MV212 for external
    ports that someone writes."""
    written = {connection.target: connection for connection in data}
    for endpoint, span in external:
        if endpoint in written:
            labels = (Label(written[endpoint].span, "written by this connection"),)
            message = f"`{endpoint}` is written inside the model, so it is not external"
            report.add(Diagnostic("MV212", message, Label(span), labels=labels))
    known = {endpoint for endpoint, _ in external} | touched
    for instance in instances.values():
        if instance.component.kind is ComponentKind.EXTERNAL:
            continue
        for port in instance.component.ports:
            endpoint = Endpoint(instance.name, port.name)
            if port.kind is not PortKind.OUT and endpoint not in known:
                _unwritten(instance, port, endpoint, report)
        called = set(_called(instance.component.regions))
        for method in instance.component.methods:
            endpoint = Endpoint(instance.name, method.name)
            if endpoint not in touched and method.name in called:
                message = f"nothing provides `{endpoint}`, which `{instance.component.name}` calls"
                labels = (Label(method.span, "the method is declared here"),)
                help_ = Fix(f"write `connect {endpoint} -> PROVIDER.OPERATION`")
                report.add(Diagnostic("MV210", message, Label(instance.span), labels=labels, help=help_))


def _unwritten(instance: Instance, port: Port, endpoint: Endpoint, report: Report) -> None:
    label = f"its in port `{port.name}` keeps its initial value for ever"
    if port.kind is PortKind.EVENT:
        label = f"its event port `{port.name}` never wakes it"
    help_ = Fix(f"connect it, or write `external {endpoint}` if it is written outside the model")
    message = f"no one writes `{endpoint}`"
    report.add(Diagnostic("MV211", message, Label(instance.span, label), Severity.WARNING, help=help_))


def _called(regions: tuple[Region, ...]) -> Iterator[str]:
    for region in regions:
        for state in region.states:
            steps = [step for activity in state.activities for step in activity.steps]
            steps += [step for transition in state.transitions for step in transition.do]
            yield from (step.method for step in steps if isinstance(step, CallMethod))
            yield from _called(state.regions)
