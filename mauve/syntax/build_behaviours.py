"""Actions for state machines, guards and lifecycles."""

from __future__ import annotations

from typing import Any

from mauve.diagnostics.diagnostic import Diagnostic, Label
from mauve.syntax import ast
from mauve.syntax.build import DEEPEST_GUARD, Action, Context, all_of, check_lines, clause, first, has, only, take


def _items(context: Context, children: list[Any], end: int) -> list[Any]:
    """What stands between the braces, checked to stand on lines of their own."""
    opening = next(i for i, child in enumerate(children) if has([child], "LBRACE"))
    items = children[opening + 1 : -1]
    check_lines(context, items, children[opening].start, end)
    return items


def _regions(context: Context, items: list[Any]) -> tuple[ast.RegionDecl, ...]:
    """The regions of a machine; states outside of regions form one without a name, and do not mix with others."""
    regions, states = only(items, ast.RegionDecl), only(items, ast.StateDecl)
    if not states:
        return regions
    whole = ast.RegionDecl(None, states, states[0].span.to(states[-1].span))
    if regions and context.sound(items[0].span, items[-1].span):
        message = f"the state `{states[0].name}` stands beside regions"
        label = Label(regions[0].name.span if regions[0].name else regions[0].span, "a region")
        primary = Label(states[0].name.span, "put it into a region of its own")
        context.report.add(Diagnostic("MV001", message, primary, labels=(label,)))
    return (*regions, whole)


def _lifecycle_use(context: Context, children: list[Any], start: int, end: int) -> ast.LifecycleUse:
    return ast.LifecycleUse(children[1], only(children, ast.HookBinding), context.span(start, end))


def _hook_binding(context: Context, children: list[Any], start: int, end: int) -> ast.HookBinding:
    return ast.HookBinding(children[0], children[1], context.span(start, end))


def _machine(context: Context, children: list[Any], start: int, end: int) -> ast.Machine:
    return ast.Machine(_regions(context, _items(context, children, end)), context.span(start, end))


def _lifecycle(context: Context, children: list[Any], start: int, end: int) -> ast.LifecycleDecl:
    opening = next(i for i, child in enumerate(children) if has([child], "LBRACE"))
    items = children[opening + 1 : -1]
    check_lines(context, [item for item in items if type(item) is not tuple], children[opening].start, end)
    hooks = tuple(name for item in items if type(item) is tuple for name in item)
    span = context.span(start, end)
    return ast.LifecycleDecl(children[1], hooks, _regions(context, items), span, context.doc(start))


def _names(context: Context, children: list[Any], start: int, end: int) -> tuple[ast.Name, ...]:
    return only(children, ast.Name)


def _hooks(context: Context, children: list[Any], start: int, end: int) -> tuple[ast.Name, ...]:
    names: tuple[ast.Name, ...] = children[1]
    return names


def _region(context: Context, children: list[Any], start: int, end: int) -> ast.RegionDecl:
    states = tuple(_items(context, children, end))
    return ast.RegionDecl(children[1], states, context.span(start, end), context.doc(start))


def _state(context: Context, children: list[Any], start: int, end: int) -> ast.StateDecl:
    name = first(children, ast.Name)
    assert name is not None
    items = _items(context, children, end)
    return ast.StateDecl(
        name,
        initial=has(children, "INITIAL"),
        final=has(children, "FINAL"),
        activities=only(items, ast.Activity),
        regions=only(items, ast.RegionDecl),
        transitions=only(items, ast.Transition),
        span=context.span(start, end),
        doc=context.doc(start),
    )


def _activity(context: Context, children: list[Any], start: int, end: int) -> ast.Activity:
    timing = children[2] if len(children) > 2 else None
    if timing is not None and not isinstance(timing, ast.Once):
        timing = ast.Every(timing.value)
    return ast.Activity(ast.Role[children[0].kind], children[1], timing, context.span(start, end))


def _once(context: Context, children: list[Any], start: int, end: int) -> ast.Once:
    return ast.Once(first(children, ast.Quantity))


def _steps(context: Context, children: list[Any], start: int, end: int) -> tuple[ast.Step, ...]:
    return only(children, ast.Step)


def _step(context: Context, children: list[Any], start: int, end: int) -> ast.Step:
    span = context.span(start, end)
    match children:
        case [target]:
            return ast.Step(target, None, None, span)
        case [target, arguments]:
            return ast.Step(target, arguments, None, span)
        case [result, _, target, arguments]:
            return ast.Step(target, arguments, result, span)
    raise AssertionError("unreachable")


def _transition(context: Context, children: list[Any], start: int, end: int) -> ast.Transition:
    guard = take(context, children, "when")
    return ast.Transition(
        children[1],
        event=take(context, children, "on"),
        guard=guard,
        after=take(context, children, "after"),
        do=tuple(step for c in all_of(children, "do") for step in c.value),
        emit=tuple(name for c in all_of(children, "emit") for name in c.value),
        span=context.span(start, end),
    )


# ------------------------------------------------------------------------------------------------ guards
def _depth(guard: ast.Guard) -> int:
    """How deeply operators nest, without recursion."""
    deepest, stack = 0, [(guard, 0)]
    while stack:
        node, depth = stack.pop()
        deepest = max(deepest, depth)
        match node:
            case ast.GuardNot(operand):
                stack.append((operand, depth + 1))
            case ast.GuardBinary(_, left, right):
                stack += [(left, depth + 1), (right, depth + 1)]
            case _:
                pass
    return deepest


def _when(context: Context, children: list[Any], start: int, end: int) -> Any:
    guard: ast.Guard | None = children[1]
    if guard is not None and _depth(guard) > DEEPEST_GUARD:
        span = context.span(start, end)
        message = f"this guard nests more than {DEEPEST_GUARD} operators"
        context.report.add(Diagnostic("MV008", message, Label(span, "let a bool codel decide it")))
        guard = None
    return clause("when", 0)(context, [guard], start, end)


def _operand(child: Any) -> ast.Guard:
    return ast.GuardCodel(child) if isinstance(child, ast.Name) else child


def _binary(context: Context, children: list[Any], start: int, end: int) -> ast.Guard:
    if len(children) == 1:
        return _operand(children[0])
    is_and = bool(children[1].kind == "AND")
    return ast.GuardBinary(is_and, _operand(children[0]), _operand(children[2]), context.span(start, end))


def _not(context: Context, children: list[Any], start: int, end: int) -> ast.Guard:
    if len(children) == 1:
        return _operand(children[0])
    return ast.GuardNot(_operand(children[1]), context.span(start, end))


def _atom(context: Context, children: list[Any], start: int, end: int) -> ast.Guard:
    return _operand(children[0] if len(children) == 1 else children[1])


BEHAVIOUR_ACTIONS: dict[str, Action] = {
    "lifecycle_use": _lifecycle_use,
    "hook_binding": _hook_binding,
    "machine": _machine,
    "lifecycle": _lifecycle,
    "hooks": _hooks,
    "region": _region,
    "state": _state,
    "activity": _activity,
    "every": clause("every"),
    "once": _once,
    "steps": _steps,
    "step": _step,
    "arguments": _names,
    "transition": _transition,
    "on_event": clause("on"),
    "when": _when,
    "after": clause("after"),
    "do": clause("do"),
    "emit": clause("emit"),
    "guard_or": _binary,
    "guard_and": _binary,
    "guard_not": _not,
    "guard_atom": _atom,
}
