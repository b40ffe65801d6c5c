"""From a written component to a resolved one: members, types, what codels access, services, behaviour."""

from __future__ import annotations

from collections.abc import Mapping

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.behaviour import Members, resolve_behaviour, unknown_codel
from mauve.model.model import Codel, Component, ComponentKind, Datum, Method, Operation, Port, PortKind, Region, RunsIn
from mauve.model.names import Scope, duplicate, unknown
from mauve.model.types import Type
from mauve.model.typing import TypeTable, check_value
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.quantities import time_of


def resolve_component(declaration: ast.ComponentDecl, scope: Scope, types: TypeTable, report: Report) -> Component:
    """The component of a declaration. What is in error is reported and left out, the rest stays usable."""
    members = _unique(declaration, report)
    ports = {
        m.name.text: Port(m.name.text, m.kind, type_, m.name.span, m.type.span)
        for m in members
        if isinstance(m, ast.PortDecl) and (type_ := types.resolve(m.type)) is not None
    }
    data = _data(members, types, report)
    events = {name.text: name.span for m in members if isinstance(m, ast.EventDecl) for name in m.names}
    methods = {
        m.name.text: Method(m.name.text, *_signature(m, types), m.name.span)
        for m in members
        if isinstance(m, ast.MethodDecl)
    }
    operations = [m for m in members if isinstance(m, ast.OperationDecl)]
    parameters = _parameters(operations, types)
    codels = {
        m.name.text: _codel(m, declaration, ports, data, parameters.get(m.name.text, {}), types, report)
        for m in members
        if isinstance(m, ast.CodelDecl)
    }
    scope_of_steps = Members(declaration.name.text, ports, data, events, methods, codels)
    resolved = tuple(
        operation
        for m in operations
        if (operation := _operation(m, declaration, scope_of_steps, types, report)) is not None
    )
    regions = _behaviour(declaration, scope_of_steps, scope, report)
    return Component(
        declaration.name.text, declaration.kind, tuple(ports.values()), tuple(data.values()), tuple(events), resolved,
        tuple(methods.values()), tuple(codels.values()), regions, declaration.name.span,
    )  # fmt: skip


def _unique(declaration: ast.ComponentDecl, report: Report) -> list[ast.ComponentMember]:
    """The members without those whose name is taken; all members of a component share one space of names."""
    seen: dict[str, Span] = {}
    kept: list[ast.ComponentMember] = []
    for member in declaration.members:
        names = member.names if isinstance(member, ast.EventDecl) else (member.name,)
        fresh = True
        for name in names:
            if name.text in seen:
                report.add(duplicate("member", name, seen[name.text]))
                fresh = False
            seen.setdefault(name.text, name.span)
        if fresh or isinstance(member, ast.EventDecl):
            kept.append(member)
    return kept


def _data(members: list[ast.ComponentMember], types: TypeTable, report: Report) -> dict[str, Datum]:
    data: dict[str, Datum] = {}
    for member in members:
        if isinstance(member, (ast.PropertyDecl, ast.VarDecl)):
            type_ = types.resolve(member.type)
            if type_ is None:
                continue
            is_property = isinstance(member, ast.PropertyDecl)
            data[member.name.text] = Datum(member.name.text, type_, member.name.span, is_property)
            if isinstance(member, ast.PropertyDecl) and member.default is not None:
                check_value(member.default, type_, report)
    return data


def _signature(
    member: ast.MethodDecl | ast.OperationDecl, types: TypeTable
) -> tuple[tuple[tuple[str, Type], ...], Type | None]:
    parameters = tuple((p.name.text, type_) for p in member.parameters if (type_ := types.resolve(p.type)) is not None)
    return parameters, types.resolve(member.result) if member.result else None


def _parameters(operations: list[ast.OperationDecl], types: TypeTable) -> dict[str, dict[str, Type]]:
    """Per codel that implements an operation, the parameters it may read."""
    found: dict[str, dict[str, Type]] = {}
    for operation in operations:
        codel = (operation.codel or operation.name).text
        found.setdefault(codel, {}).update(_signature(operation, types)[0])
    return found


def _codel(
    member: ast.CodelDecl,
    declaration: ast.ComponentDecl,
    ports: Mapping[str, Port],
    data: Mapping[str, Datum],
    parameters: Mapping[str, Type],
    types: TypeTable,
    report: Report,
) -> Codel:
    known = {n: p.span for n, p in ports.items()} | {n: d.span for n, d in data.items()}
    known_here = {m.name.text for m in declaration.members if not isinstance(m, ast.EventDecl)}
    for name in (*member.reads, *member.writes):
        if name.text in known or name.text in parameters:
            continue
        if name.text in known_here and not _is_service(declaration, name.text):
            continue  # its type is in error, which is reported there
        message = f"`{declaration.name}` has no port, property or variable `{name}`"
        report.add(unknown("MV108", message, "unknown", name.span, known, "something"))
    for name in member.writes:
        port, datum = ports.get(name.text), data.get(name.text)
        if port is not None and port.kind is not PortKind.OUT:
            help_ = Fix(f"a codel writes out ports and variables; it `reads {name}`")
            message = f"`{member.name}` cannot write the {port.kind.value} port `{name}`"
            labels = (Label(port.span, f"an {port.kind.value} port"),)
            report.add(Diagnostic("MV202", message, Label(name.span), labels=labels, help=help_))
        elif datum is not None and datum.is_property:
            message = f"`{member.name}` cannot write the property `{name}`"
            labels = (Label(datum.span, "a property is set by the architecture and stays"),)
            help_ = Fix(f"make it a variable: `var {name}: {datum.type}`")
            report.add(Diagnostic("MV202", message, Label(name.span), labels=labels, help=help_))
    wcet = time_of(member.wcet, report) if member.wcet else None
    if wcet is not None and wcet < 0 and member.wcet is not None:
        report.add(Diagnostic("MV401", "an execution time cannot be negative", Label(member.wcet.span)))
        wcet = None
    return Codel(
        member.name.text, tuple(n.text for n in member.reads), tuple(n.text for n in member.writes),
        types.resolve(member.returns) if member.returns else None, wcet,
        member.symbol.value if member.symbol else None, member.init, member.name.span,
    )  # fmt: skip


def _is_service(declaration: ast.ComponentDecl, name: str) -> bool:
    services = (ast.OperationDecl, ast.MethodDecl, ast.CodelDecl)
    return any(isinstance(m, services) and m.name.text == name for m in declaration.members)


def _operation(
    member: ast.OperationDecl, declaration: ast.ComponentDecl, members: Members, types: TypeTable, report: Report
) -> Operation | None:
    name = member.codel or member.name
    codel = members.codels.get(name.text)
    parameters, result = _signature(member, types)
    if codel is None:
        if member.codel is None:
            message = f"the operation `{member.name}` has no codel"
            help_ = Fix(f"name the codel that carries it out: `operation {member.name}(...) = CODEL`")
            report.add(Diagnostic("MV107", message, Label(member.name.span), help=help_))
            return None
        report.add(unknown_codel(name, members))
        return None
    if codel.returns != result:
        message = f"the codel `{name}` does not return what the operation `{member.name}` promises"
        promised, returned = (f"`{t}`" if t else "nothing" for t in (result, codel.returns))
        labels = (Label(codel.span, f"returns {returned}"),)
        report.add(Diagnostic("MV207", message, Label(member.name.span, f"promises {promised}"), labels=labels))
    if declaration.kind is ComponentKind.PASSIVE and member.runs is RunsIn.OWNER:
        message = f"the passive component `{declaration.name}` has no task to run `{member.name}`"
        report.add(Diagnostic("MV308", message, Label(member.span), help=Fix("write `runs in caller`")))
    return Operation(member.name.text, parameters, result, name.text, member.runs or RunsIn.CALLER, member.name.span)


def _behaviour(declaration: ast.ComponentDecl, members: Members, scope: Scope, report: Report) -> tuple[Region, ...]:
    name, behaviour = declaration.name, declaration.behaviour
    match declaration.kind, behaviour:
        case ComponentKind.ACTIVE, None:
            help_ = Fix(
                "give it a `behaviour`, or say that it has no task: `passive component` for a library of operations, "
                "`external component` for what lives outside the model"
            )
            report.add(Diagnostic("MV308", f"the component `{name}` has no behaviour", Label(name.span), help=help_))
            return ()
        case ComponentKind.ACTIVE, _ if behaviour is not None:
            return resolve_behaviour(behaviour, members, scope, report)
        case kind, _ if behaviour is not None:
            message = f"the {kind.value} component `{name}` cannot have a behaviour"
            labels = (Label(name.span, f"{kind.value} components have no task"),)
            report.add(Diagnostic("MV308", message, Label(behaviour.span), labels=labels))
    return ()
