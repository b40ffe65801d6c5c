"""Actions for architectures, boards and deployments."""

from __future__ import annotations

import re
from typing import Any

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label
from mauve.diagnostics.suggest import closest
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.build import Action, Clause, Context, all_of, check_lines, clause, first, has, only, take
from mauve.syntax.quantities import UNITS


def _items(context: Context, children: list[Any], end: int) -> list[Any]:
    """What stands between the braces, checked to stand on lines of their own; nothing where there are no braces."""
    opening = next((i for i, child in enumerate(children) if has([child], "LBRACE")), None)
    if opening is None:
        return []
    items = [child for child in children[opening + 1 : -1] if child is not None]
    check_lines(context, items, children[opening].start, end)
    return items


# ------------------------------------------------------------------------------------------------ architecture
def _architecture(context: Context, children: list[Any], start: int, end: int) -> ast.ArchitectureDecl:
    items = _items(context, children, end)
    instances, connections = only(items, ast.InstanceDecl), only(items, ast.ConnectDecl)
    span = context.span(start, end)
    externals = only(items, ast.ExternalDecl)
    flows = only(items, ast.FlowDecl)
    return ast.ArchitectureDecl(children[1], instances, connections, externals, span, context.doc(start), flows)


def _instance(context: Context, children: list[Any], start: int, end: int) -> ast.InstanceDecl:
    attributes = only(children, ast.ExecutionAttribute)
    assignments = only(children, ast.Assignment)
    once_each(context, attributes)
    span = context.span(start, end)
    return ast.InstanceDecl(children[1], children[3], attributes, assignments, span, context.doc(start))


def once_each(context: Context, attributes: tuple[ast.ExecutionAttribute, ...]) -> None:
    """Report an execution attribute that is given twice."""
    seen: dict[ast.Execution, ast.ExecutionAttribute] = {}
    for attribute in attributes:
        if attribute.kind in seen:
            label = Label(seen[attribute.kind].span, "first here")
            message = f"`{attribute.kind.value}` is given twice"
            context.report.add(Diagnostic("MV001", message, Label(attribute.span, "and here"), labels=(label,)))
        seen.setdefault(attribute.kind, attribute)


def _execution(context: Context, children: list[Any], start: int, end: int) -> ast.ExecutionAttribute | None:
    word: ast.Name = children[0]
    span = context.span(start, end)
    known = {kind.value: kind for kind in ast.Execution}
    if word.text not in known:
        fix = None
        for near in closest(word.text, known, limit=1):
            fix = Fix(f"there is an attribute `{near}`", (Edit(word.span, near),), Applicability.MAYBE)
        listed = ", ".join(f"`{name}`" for name in known)
        label = f"the attributes are {listed}"
        context.error(f"there is no execution attribute `{word}`", word.span, label, fix)
        return None
    kind = known[word.text]
    return ast.ExecutionAttribute(kind, _execution_value(context, kind, children[1]), span)


def _execution_value(
    context: Context, kind: ast.Execution, value: ast.Quantity | ast.Number
) -> ast.Quantity | ast.Number:
    """The value, of the form its attribute asks for: a priority is a bare number, all others have a unit."""
    if kind is ast.Execution.PRIORITY and isinstance(value, ast.Quantity):
        fix = Fix(f"write `priority {value.number}`", (Edit(value.span, value.number),), Applicability.MAYBE)
        context.error("a priority has no unit", value.span, "a bare number is expected", fix)
        return ast.Number(value.number, value.span)
    if kind is not ast.Execution.PRIORITY and isinstance(value, ast.Number):
        missing_unit(context, value, kind.value)
        return ast.Quantity(value.text, "", value.span)
    return value


def missing_unit(context: Context, value: ast.Number, of: str) -> None:
    """Report a time without a unit, or with its unit apart."""
    after = re.compile(r"[ \t]+([A-Za-z\u00b5]+)\b").match(context.file.text, value.span.end)
    if after and any(after[1] in units for units in UNITS.values()):
        context.report.add(unit_apart(context.span(value.span.start, after.end()), value.text, after[1]))
        return
    fix = Fix(f"write the unit against the number, as in `{value.text}ms`")
    message = f"the {of} `{value.text}` has no unit"
    context.report.add(Diagnostic("MV004", message, Label(value.span, "of what?"), help=fix))


def unit_apart(span: Span, number: str, unit: str) -> Diagnostic:
    """White space between a number and its unit."""
    fix = Fix(f"write `{number}{unit}`", (Edit(span, number + unit),), Applicability.MACHINE)
    return Diagnostic("MV001", "a unit stands against its number", Label(span), help=fix)


def _assignment(context: Context, children: list[Any], start: int, end: int) -> ast.Assignment:
    return ast.Assignment(children[0], children[2], context.span(start, end))


def _connect(context: Context, children: list[Any], start: int, end: int) -> ast.ConnectDecl:
    clauses = only(children, Clause)
    policy = _policy(context, clauses) if clauses else None
    return ast.ConnectDecl(children[1], children[3], policy, context.span(start, end))


def _policy(context: Context, clauses: tuple[Clause, ...]) -> ast.Policy:
    buffering, size = take(context, clauses, "buffered"), take(context, clauses, "size")
    overflow, initial = take(context, clauses, "drop"), take(context, clauses, "initial")
    for word, value in (("size", size), ("drop", overflow)):
        if value is not None and not buffering:
            span = all_of(clauses, word)[0].span
            before = context.span(span.start, span.start)
            fixed = buffering is None
            fix = Fix("write `buffered` before it", (Edit(before, "buffered "),) if fixed else (), Applicability.MAYBE)
            context.error(f"`{word}` belongs to a buffered connection", span, fix=fix)
    return ast.Policy(bool(buffering), size, overflow, initial, clauses[0].span.to(clauses[-1].span))


def _buffering(context: Context, children: list[Any], start: int, end: int) -> Clause:
    return Clause("buffered", children[0].kind == "BUFFERED", context.span(start, end))


_OVERFLOWS = {"OLDEST": ast.Overflow.DROP_OLDEST, "NEWEST": ast.Overflow.DROP_NEWEST}


def _overflow(context: Context, children: list[Any], start: int, end: int) -> Clause:
    return Clause("drop", _OVERFLOWS[children[1].kind], context.span(start, end))


def _outside(context: Context, children: list[Any], start: int, end: int) -> ast.ExternalDecl:
    return ast.ExternalDecl(children[1], context.span(start, end))


# ------------------------------------------------------------------------------------------------ boards
def _board(context: Context, children: list[Any], start: int, end: int) -> ast.BoardDecl:
    items = _items(context, children, end)
    named = children[1]
    name = named if isinstance(named, ast.Name) else ast.Name(named.value, named.span)
    return ast.BoardDecl(
        name,
        cpus=only(items, ast.CpuItem),
        features=only(items, ast.FeatureItem),
        memories=only(items, ast.MemoryItem),
        systems=only(items, ast.OsItem),
        span=context.span(start, end),
        doc=context.doc(start),
    )


def _cpu(context: Context, children: list[Any], start: int, end: int) -> ast.CpuItem:
    return ast.CpuItem(children[1], children[3], context.span(start, end))


def _feature(context: Context, children: list[Any], start: int, end: int) -> ast.FeatureItem:
    settings = tuple(child for child in children[1:] if isinstance(child, str))
    return ast.FeatureItem(children[0], has(children, "OFF"), settings, context.span(start, end))


def _word(context: Context, children: list[Any], start: int, end: int) -> str:
    return context.file.text[start:end]


def _memory(context: Context, children: list[Any], start: int, end: int) -> ast.MemoryItem:
    size, wait = only(children, ast.Quantity)
    address = first(children, ast.Number)
    written = take(context, children, "write wait")
    return ast.MemoryItem(children[1], address, size, wait, written, context.span(start, end))


def _os(context: Context, children: list[Any], start: int, end: int) -> ast.OsItem:
    clauses = only(children, Clause)
    tick = take(context, clauses, "tick") or (None, None)
    switch = take(context, clauses, "context_switch")
    return ast.OsItem(children[1], switch, tick[0], tick[1], context.span(start, end))


def _os_item(context: Context, children: list[Any], start: int, end: int) -> Clause | None:
    word: ast.Name = children[0]
    forms = {"context_switch": "context_switch 8us", "tick": "tick every 1ms cost 5us"}
    if word.text not in forms:
        fix = None
        for near in closest(word.text, forms, limit=1):
            fix = Fix(f"there is an overhead `{near}`", (Edit(word.span, near),), Applicability.MAYBE)
        label = "the overheads are `context_switch` and `tick`"
        context.error(f"there is no overhead `{word}`", word.span, label, fix)
        return None
    span = context.span(start, end)
    periodic = len(children) > 2
    if periodic != (word.text == "tick"):
        fix = Fix(f"write it like `{forms[word.text]}`")
        context.error(f"`{word}` has another form", span, fix=fix)
        return None
    value = (children[1].value, children[3]) if periodic else children[1]
    return Clause(word.text, value, span)


# ------------------------------------------------------------------------------------------------ deployments
def _deployment(context: Context, children: list[Any], start: int, end: int) -> ast.DeploymentDecl:
    items = _items(context, children, end)
    name = first(children, ast.Name)
    assert name is not None
    expected = take(context, items, "expect")
    return ast.DeploymentDecl(
        name,
        abstract=has(children, "ABSTRACT"),
        architecture=take(context, children, "of"),
        extends=take(context, children, "extends"),
        nodes=only(items, ast.NodeDecl),
        processes=only(items, ast.ProcessDecl),
        expect_unschedulable=expected,
        span=context.span(start, end),
        doc=context.doc(start),
    )


def _expect(context: Context, children: list[Any], start: int, end: int) -> Clause:
    span = context.span(start, end)
    return Clause("expect", span, span)


def _node(context: Context, children: list[Any], start: int, end: int) -> ast.NodeDecl:
    items = _items(context, children, end)
    return ast.NodeDecl(
        children[1],
        children[3],
        processes=only(items, ast.ProcessDecl),
        binaries=only(items, ast.BinaryDecl),
        assumes=only(items, ast.AssumeDecl),
        interrupts=only(items, ast.InterruptDecl),
        schedules=only(items, ast.ScheduleDecl),
        span=context.span(start, end),
    )


def _process(context: Context, children: list[Any], start: int, end: int) -> ast.ProcessDecl:
    items = _items(context, children, end)
    return ast.ProcessDecl(
        children[1],
        threads=only(items, ast.ThreadDecl),
        schedules=only(items, ast.ScheduleDecl),
        locks=only(items, ast.LockDecl),
        exchanges=only(items, ast.ExchangeDecl),
        binaries=only(items, ast.BinaryDecl),
        assumes=only(items, ast.AssumeDecl),
        span=context.span(start, end),
    )


def _thread(context: Context, children: list[Any], start: int, end: int) -> ast.ThreadDecl:
    attributes = only(children, ast.ExecutionAttribute)
    once_each(context, attributes)
    return ast.ThreadDecl(children[1], attributes, only(children, ast.Path), context.span(start, end))


def _schedule(context: Context, children: list[Any], start: int, end: int) -> ast.ScheduleDecl:
    return ast.ScheduleDecl(children[1], not has(children, "NON_PREEMPTIVE"), context.span(start, end))


def _lock(context: Context, children: list[Any], start: int, end: int) -> ast.LockDecl:
    return ast.LockDecl(children[1], context.span(start, end))


def _exchange(context: Context, children: list[Any], start: int, end: int) -> ast.ExchangeDecl:
    return ast.ExchangeDecl(children[1], children[2], context.span(start, end))


def _assume(context: Context, children: list[Any], start: int, end: int) -> ast.AssumeDecl:
    targets: tuple[ast.Path, ...] = children[1]
    if [str(path) for path in targets] == ["others"]:
        targets = ()
    for path in targets:
        if str(path) == "others":
            context.error("`others` stands alone: it means every codel that is not named", path.span)
    targets = tuple(path for path in targets if str(path) != "others")
    return ast.AssumeDecl(targets, children[3], context.span(start, end))


def _interrupt(context: Context, children: list[Any], start: int, end: int) -> ast.InterruptDecl | None:
    every = take(context, children, "every")
    if every is None:
        fix = Fix(f"write `interrupt {children[1]} every 1ms wcet 5us`")
        context.error("an interrupt needs its least separation", context.span(start, end), "`every` is missing", fix)
        return None
    wcet, symbol = take(context, children, "wcet"), take(context, children, "symbol")
    return ast.InterruptDecl(children[1], every, wcet, symbol, context.span(start, end))


SYSTEM_ACTIONS: dict[str, Action] = {
    "architecture": _architecture,
    "instance": _instance,
    "execution": _execution,
    "assignment": _assignment,
    "connect": _connect,
    "buffering": _buffering,
    "size": clause("size"),
    "overflow": _overflow,
    "initial": clause("initial"),
    "outside": _outside,
    "board": _board,
    "cpu": _cpu,
    "feature": _feature,
    "feature_name": _word,
    "setting": _word,
    "memory": _memory,
    "write_wait": clause("write wait", 2),
    "os": _os,
    "os_item": _os_item,
    "deployment": _deployment,
    "of": clause("of"),
    "extends": clause("extends"),
    "expect": _expect,
    "node": _node,
    "process": _process,
    "thread": _thread,
    "schedule": _schedule,
    "lock": _lock,
    "exchange": _exchange,
    "assume": _assume,
    "interrupt": _interrupt,
}
