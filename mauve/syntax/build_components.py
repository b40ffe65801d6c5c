"""Actions for files, names, types, values and components."""

from __future__ import annotations

from typing import Any

from mauve.diagnostics.diagnostic import Diagnostic, Label
from mauve.syntax import ast
from mauve.syntax.build import Action, Clause, Context, all_of, as_name, check_lines, clause, first, has, only, take


# ------------------------------------------------------------------------------------------------ files and names
def _module(context: Context, children: list[Any], start: int, end: int) -> ast.Module:
    package = first(children, Clause)
    imports = only(children, ast.Import)
    keep = (ast.StructDecl, ast.EnumDecl, ast.ComponentDecl, ast.LifecycleDecl, ast.ArchitectureDecl)
    declarations = tuple(c for c in children if isinstance(c, (*keep, ast.BoardDecl, ast.DeploymentDecl)))
    missions = tuple(c for c in children if isinstance(c, ast.MissionPart))
    binaries = only(children, ast.BinaryDecl)
    written = sorted([*imports, *declarations, *missions, *binaries], key=lambda item: item.span.start)
    check_lines(context, written, 0, len(context.file.text))
    version = first(children, int)
    path = package.value if package else None
    doc = context.doc(package.span.start) if package else ""
    return ast.Module(context.file, version, path, imports, declarations, doc, missions, binaries)


def _version(context: Context, children: list[Any], start: int, end: int) -> int | None:
    number: ast.Number = children[1]
    return number.integer if number.is_integer else None


def _import(context: Context, children: list[Any], start: int, end: int) -> ast.Import:
    return ast.Import(children[1], first(children, ast.Name), context.span(start, end))


def _names(context: Context, children: list[Any], start: int, end: int) -> tuple[ast.Name, ...]:
    return only(children, ast.Name)


def _path(context: Context, children: list[Any], start: int, end: int) -> ast.Path:
    return ast.Path(only(children, ast.Name), context.span(start, end))


def _paths(context: Context, children: list[Any], start: int, end: int) -> tuple[ast.Path, ...]:
    return only(children, ast.Path)


# ------------------------------------------------------------------------------------------------ types and values
def _struct(context: Context, children: list[Any], start: int, end: int) -> ast.StructDecl:
    fields = tuple(field for group in only(children, tuple) if type(group) is tuple for field in group)
    return ast.StructDecl(children[1], fields, context.span(start, end), context.doc(start))


def _field(context: Context, children: list[Any], start: int, end: int) -> tuple[ast.Field, ...]:
    doc = context.doc(start)
    return tuple(ast.Field(name, children[2], doc) for name in children[0])


def _enum(context: Context, children: list[Any], start: int, end: int) -> ast.EnumDecl:
    return ast.EnumDecl(children[1], children[3], context.span(start, end), context.doc(start))


def _type(context: Context, children: list[Any], start: int, end: int) -> ast.TypeRef:
    return ast.TypeRef(children[0], only(children[1:], ast.Number), context.span(start, end))


def _dimension(context: Context, children: list[Any], start: int, end: int) -> ast.Number:
    number: ast.Number = children[1]
    return number


def _value_path(context: Context, children: list[Any], start: int, end: int) -> ast.Path | ast.Boolean:
    path: ast.Path = children[0]
    if str(path) in ("true", "false"):
        return ast.Boolean(str(path) == "true", path.span)
    return path


def _record(context: Context, children: list[Any], start: int, end: int) -> ast.Record:
    fields = tuple(child for child in children if type(child) is tuple)
    return ast.Record(fields, context.span(start, end))


def _record_field(context: Context, children: list[Any], start: int, end: int) -> tuple[ast.Name, ast.Value]:
    return (children[0], children[2])


_VALUES = (ast.Quantity, ast.Number, ast.String, ast.Boolean, ast.Path, ast.Record, ast.List)


def _list(context: Context, children: list[Any], start: int, end: int) -> ast.List:
    return ast.List(tuple(child for child in children if isinstance(child, _VALUES)), context.span(start, end))


# ------------------------------------------------------------------------------------------------ components
_KINDS = {"PASSIVE": ast.ComponentKind.PASSIVE, "EXTERNAL": ast.ComponentKind.EXTERNAL}


def _component(context: Context, children: list[Any], start: int, end: int) -> ast.ComponentDecl:
    kind = first(children, ast.ComponentKind) or ast.ComponentKind.ACTIVE
    name = first(children, ast.Name)
    assert name is not None
    opening = next(i for i, child in enumerate(children) if has([child], "LBRACE"))
    items = children[opening + 1 : -1]
    check_lines(context, items, children[opening].start, end)
    behaviours = [item for item in items if isinstance(item, (ast.LifecycleUse, ast.Machine))]
    for extra in behaviours[1:]:
        if not context.sound(behaviours[0].span, extra.span):
            continue
        label = Label(behaviours[0].span, "the first one")
        message = f"the component `{name}` has two behaviours"
        context.report.add(Diagnostic("MV001", message, Label(extra.span, "the second one"), labels=(label,)))
    members = tuple(item for item in items if not isinstance(item, (ast.LifecycleUse, ast.Machine)))
    behaviour = behaviours[0] if behaviours else None
    return ast.ComponentDecl(name, kind, members, behaviour, context.span(start, end), context.doc(start))


def _component_kind(context: Context, children: list[Any], start: int, end: int) -> ast.ComponentKind:
    return _KINDS[children[0].kind]


def _port(context: Context, children: list[Any], start: int, end: int) -> ast.PortDecl:
    kind = ast.PortKind[children[0].kind]
    return ast.PortDecl(kind, children[2], children[4], context.span(start, end), context.doc(start))


def _property(context: Context, children: list[Any], start: int, end: int) -> ast.PropertyDecl:
    default = children[5] if len(children) > 5 else None
    return ast.PropertyDecl(children[1], children[3], default, context.span(start, end), context.doc(start))


def _variable(context: Context, children: list[Any], start: int, end: int) -> ast.VarDecl:
    return ast.VarDecl(children[1], children[3], context.span(start, end), context.doc(start))


def _events(context: Context, children: list[Any], start: int, end: int) -> ast.EventDecl:
    return ast.EventDecl(only(children, ast.Name), context.span(start, end), context.doc(start))


def _head(context: Context, children: list[Any], start: int, end: int) -> ast.Name:
    return as_name(context, children[0])


def _operation(context: Context, children: list[Any], start: int, end: int) -> ast.OperationDecl:
    names = only(children, ast.Name)
    codel = names[1] if len(names) > 1 else None
    result, runs = first(children, ast.TypeRef), first(children, ast.RunsIn)
    span = context.span(start, end)
    return ast.OperationDecl(names[0], children[2], result, codel, runs, span, context.doc(start))


def _method(context: Context, children: list[Any], start: int, end: int) -> ast.MethodDecl:
    result = first(children, ast.TypeRef)
    return ast.MethodDecl(children[1], children[2], result, context.span(start, end), context.doc(start))


def _parameters(context: Context, children: list[Any], start: int, end: int) -> tuple[ast.Parameter, ...]:
    return only(children, ast.Parameter)


def _parameter(context: Context, children: list[Any], start: int, end: int) -> ast.Parameter:
    return ast.Parameter(children[0], children[2])


def _runs(context: Context, children: list[Any], start: int, end: int) -> ast.RunsIn:
    return ast.RunsIn[children[2].kind]


def _codel(context: Context, children: list[Any], start: int, end: int) -> ast.CodelDecl:
    name = first(children, ast.Name)
    assert name is not None
    return ast.CodelDecl(
        name,
        reads=tuple(n for c in all_of(children, "reads") for n in c.value),
        writes=tuple(n for c in all_of(children, "writes") for n in c.value),
        returns=take(context, children, "returns"),
        wcet=take(context, children, "wcet"),
        symbol=take(context, children, "symbol"),
        init=has(children, "INIT"),
        span=context.span(start, end),
        doc=context.doc(start),
    )


COMPONENT_ACTIONS: dict[str, Action] = {
    "start": _module,
    "version": _version,
    "package": clause("package"),
    "import_": _import,
    "names": _names,
    "path": _path,
    "paths": _paths,
    "struct": _struct,
    "field": _field,
    "enum": _enum,
    "type": _type,
    "dimension": _dimension,
    "value_path": _value_path,
    "record": _record,
    "record_field": _record_field,
    "list": _list,
    "component": _component,
    "component_kind": _component_kind,
    "port": _port,
    "property": _property,
    "variable": _variable,
    "events": _events,
    "event_head": _head,
    "bind_head": _head,
    "operation": _operation,
    "method": _method,
    "parameters": _parameters,
    "parameter": _parameter,
    "runs": _runs,
    "codel": _codel,
    "reads": clause("reads"),
    "writes": clause("writes"),
    "returns": clause("returns"),
    "wcet": clause("wcet"),
    "symbol": clause("symbol"),
}
