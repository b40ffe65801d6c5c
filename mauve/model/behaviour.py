"""From a written behaviour, or the use of a lifecycle, to resolved regions; and the checks of their states."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.model.model import (
    Activity,
    CallMethod,
    Codel,
    Datum,
    Method,
    Port,
    Region,
    RunCodel,
    State,
    Step,
    Transition,
)
from mauve.model.names import Scope, duplicate, unknown
from mauve.model.reachability import check_region
from mauve.model.types import BUILT_IN, Type
from mauve.records import record
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.quantities import time_of


@record
class Members:
    """What the steps, guards and events of a component may name."""

    component: str
    ports: Mapping[str, Port]
    data: Mapping[str, Datum]
    events: Mapping[str, Span]
    methods: Mapping[str, Method]
    codels: Mapping[str, Codel]

    def type_of(self, name: str) -> Type | None:
        """The type of a port, property or variable."""
        if name in self.ports:
            return self.ports[name].type
        return self.data[name].type if name in self.data else None

    def spans(self) -> dict[str, Span]:
        """Where the ports, properties and variables are declared."""
        return {n: p.span for n, p in self.ports.items()} | {n: d.span for n, d in self.data.items()}


Hooks = Mapping[str, tuple[Step, ...]]
"""The steps bound to each hook of a lifecycle; an unassigned hook is empty and costs nothing."""


def resolve_behaviour(
    behaviour: ast.Machine | ast.LifecycleUse, members: Members, scope: Scope, report: Report
) -> tuple[Region, ...]:
    """The regions of a component's behaviour, checked. Parts in error are reported and left out."""
    if isinstance(behaviour, ast.Machine):
        return tuple(_region(region, members, None, report) for region in _named_once(behaviour.regions, report))
    found = scope.find(behaviour.lifecycle, (ast.LifecycleDecl,))
    if not isinstance(found, ast.LifecycleDecl):
        known = {name: d.name.span for name, d in scope.of_kind((ast.LifecycleDecl,)).items()}
        message = f"there is no lifecycle `{behaviour.lifecycle}`"
        diagnostic = unknown("MV111", message, scope.where(), behaviour.lifecycle.span, known, "a lifecycle")
        if diagnostic.help is None and str(behaviour.lifecycle) == "orocos":
            help_ = Fix("the standard library has it: write `import std.lifecycle` at the head of the file")
            diagnostic = Diagnostic("MV111", message, diagnostic.primary, help=help_)
        report.add(diagnostic)
        return ()
    hooks = _hooks(behaviour, found, members, report)
    return tuple(_region(region, members, hooks, report) for region in found.regions)


def _named_once(regions: tuple[ast.RegionDecl, ...], report: Report) -> Iterator[ast.RegionDecl]:
    seen: dict[str, Span] = {}
    for region in regions:
        name = region.name.text if region.name else ""
        if region.name is not None and name in seen:
            report.add(duplicate("region", region.name, seen[name]))
            continue
        seen[name] = region.name.span if region.name else region.span
        yield region


def _hooks(use: ast.LifecycleUse, lifecycle: ast.LifecycleDecl, members: Members, report: Report) -> Hooks:
    known = {hook.text: hook.span for hook in lifecycle.hooks}
    bound: dict[str, tuple[Step, ...]] = dict.fromkeys(known, ())
    seen: dict[str, Span] = {}
    for binding in use.hooks:
        name = binding.hook.text
        if name not in known:
            label = "its hooks are " + ", ".join(f"`{hook}`" for hook in known)
            message = f"the lifecycle `{lifecycle.name}` has no hook `{name}`"
            report.add(unknown("MV111", message, label, binding.hook.span, list(known), "a hook"))
        elif name in seen:
            report.add(duplicate("hook binding", binding.hook, seen[name]))
        else:
            seen[name] = binding.hook.span
            bound[name] = _steps(binding.steps, members, None, report)
    return bound


def _region(region: ast.RegionDecl, members: Members, hooks: Hooks | None, report: Report) -> Region:
    name = region.name.text if region.name else ""
    states: dict[str, ast.StateDecl] = {}
    for state in region.states:
        if state.name.text in states:
            report.add(duplicate("state", state.name, states[state.name.text].name.span))
        else:
            states[state.name.text] = state
    resolved = tuple(_state(state, states, members, hooks, report) for state in states.values())
    initial = _initial(region, states, report)
    result = Region(name, initial, resolved, region.span)
    named = {transition.target.text for state in states.values() for transition in state.transitions}
    if initial and named <= set(states):  # else a wrong name may hide the way to a state
        check_region(result, members.component, report)
    return result


def _initial(region: ast.RegionDecl, states: Mapping[str, ast.StateDecl], report: Report) -> str:
    initials = [state for state in states.values() if state.initial]
    where = region.name.span if region.name else region.span
    what = f"the region `{region.name}`" if region.name else "the behaviour"
    if not states:
        report.add(Diagnostic("MV302", f"{what} has no state", Label(where, "a behaviour needs at least one state")))
        return ""
    if not initials:
        first = next(iter(states.values()))
        label = Label(first.name.span, "the first state is here")
        help_ = Fix(f"write `initial state {first.name}` for the state in which it starts")
        report.add(Diagnostic("MV302", f"{what} has no initial state", label, help=help_))
        return first.name.text
    if len(initials) > 1:
        labels = (Label(initials[0].name.span, "the first one is here"),)
        message = f"{what} has {len(initials)} initial states"
        report.add(Diagnostic("MV302", message, Label(initials[1].name.span, "a second initial state"), labels=labels))
    return initials[0].name.text


def _state(
    state: ast.StateDecl,
    states: Mapping[str, ast.StateDecl],
    members: Members,
    hooks: Hooks | None,
    report: Report,
) -> State:
    activities = tuple(_activity(activity, members, hooks, report) for activity in state.activities)
    transitions = tuple(
        resolved
        for transition in state.transitions
        if (resolved := _transition(transition, states, members, hooks, report)) is not None
    )
    _check_shadowed(transitions, report)
    regions = tuple(_region(region, members, hooks, report) for region in _named_once(state.regions, report))
    return State(state.name.text, state.final, activities, regions, transitions, state.name.span)


def _check_shadowed(transitions: tuple[Transition, ...], report: Report) -> None:
    for index, transition in enumerate(transitions[:-1]):
        if transition.always:
            later = transitions[index + 1]
            labels = (Label(transition.span, "this one is always taken"),)
            message = f"the transition to `{later.target}` is never tried"
            help_ = Fix(
                "transitions are tried in the order written: give the earlier one a guard, or move it to the end"
            )
            report.add(Diagnostic("MV306", message, Label(later.span), Severity.WARNING, labels, help=help_))
            return


def _activity(activity: ast.Activity, members: Members, hooks: Hooks | None, report: Report) -> Activity:
    steps = _steps(activity.steps, members, hooks, report)
    every = apart = None
    match activity.timing:
        case ast.Every(period=period):
            every = _positive(period, "a period", report)
        case ast.Once(apart=None):
            apart = 0
        case ast.Once(apart=quantity) if quantity is not None:
            apart = _positive(quantity, "a separation", report) or 0
    return Activity(activity.role, steps, every, apart, activity.span)


def _positive(quantity: ast.Quantity, what: str, report: Report) -> int | None:
    time = time_of(quantity, report)
    if time is not None and time <= 0:
        report.add(
            Diagnostic("MV401", f"{what} of {quantity.span.text}", Label(quantity.span, "must be longer than 0"))
        )
        return None
    return time


def _transition(
    transition: ast.Transition,
    states: Mapping[str, ast.StateDecl],
    members: Members,
    hooks: Hooks | None,
    report: Report,
) -> Transition | None:
    target = transition.target.text
    event = transition.event
    if event is not None and not _known_event(event.text, members, hooks):
        known = dict(members.events) | {n: p.span for n, p in members.ports.items() if p.kind is ast.PortKind.EVENT}
        label = "it has " + (", ".join(f"`{name}`" for name in known) if known else "no events and no event ports")
        message = f"`{members.component}` has no event `{event}`"
        report.add(unknown("MV108", message, label, event.span, known, "an event"))
    for name in transition.emit:
        if name.text not in members.events:
            label = "events are declared by `event " + name.text + "`"
            message = f"`{members.component}` has no event `{name}`"
            report.add(unknown("MV108", message, label, name.span, members.events, "an event"))
    guards = tuple(_guards(transition.guard, members, report)) if transition.guard else ()
    after = (_positive(transition.after, "a delay", report) or 1) if transition.after else None
    do = _steps(transition.do, members, hooks, report)
    emit = tuple(name.text for name in transition.emit)
    if target not in states:
        known = {name: state.name.span for name, state in states.items()}
        message = f"there is no state `{target}` here"
        label = "its states are " + ", ".join(f"`{name}`" for name in known)
        report.add(unknown("MV303", message, label, transition.target.span, known, "a state"))
        return None
    return Transition(target, event.text if event else None, guards, after, do, emit, transition.span)


def _known_event(name: str, members: Members, hooks: Hooks | None) -> bool:
    if hooks is not None:
        return True
    port = members.ports.get(name)
    return name in members.events or (port is not None and port.kind is ast.PortKind.EVENT)


def _guards(guard: ast.Guard, members: Members, report: Report) -> Iterator[RunCodel]:
    match guard:
        case ast.GuardNot(operand=operand):
            yield from _guards(operand, members, report)
        case ast.GuardBinary(left=left, right=right):
            yield from _guards(left, members, report)
            yield from _guards(right, members, report)
        case ast.GuardCodel(name=name):
            codel = members.codels.get(name.text)
            if codel is None:
                report.add(unknown_codel(name, members))
            elif codel.returns != BUILT_IN["bool"]:
                returned = f"returns `{codel.returns}`" if codel.returns else "returns nothing"
                message = f"`{name}` cannot be a guard: it {returned}"
                labels = (Label(codel.span, "declared here"),)
                help_ = Fix(f"a guard is a codel that `returns bool`: `codel {name} ... returns bool`")
                report.add(Diagnostic("MV304", message, Label(name.span, "not a bool"), labels=labels, help=help_))
            yield RunCodel(name.text, name.span)


def unknown_codel(name: ast.Name, members: Members) -> Diagnostic:
    """MV107: the component has no such codel."""
    known = {n: c.span for n, c in members.codels.items()}
    label = "its codels are " + ", ".join(f"`{n}`" for n in known) if known else "it declares no codels"
    return unknown("MV107", f"`{members.component}` has no codel `{name}`", label, name.span, known, "a codel")


def _steps(steps: tuple[ast.Step, ...], members: Members, hooks: Hooks | None, report: Report) -> tuple[Step, ...]:
    result: list[Step] = []
    for step in steps:
        name = step.target
        if hooks is not None and step.arguments is None and name.text in hooks:
            result += hooks[name.text]
        elif step.arguments is None and name.text in members.codels:
            codel = members.codels[name.text]
            if codel.init:
                message = f"the init codel `{name}` cannot be a step: it runs at start-up only"
                report.add(
                    Diagnostic("MV307", message, Label(step.span), labels=(Label(codel.span, "declared `init` here"),))
                )
            result.append(RunCodel(name.text, step.span))
        elif step.arguments is None and name.text in members.methods:
            parameters = ", ".join(parameter for parameter, _ in members.methods[name.text].parameters)
            message = f"`{name}` is a method, not a codel"
            report.add(Diagnostic("MV307", message, Label(name.span), help=Fix(f"call it: `{name}({parameters})`")))
        elif step.arguments is not None and name.text in members.methods:
            _check_call(step, members.methods[name.text], members, report)
            arguments = tuple(argument.text for argument in step.arguments)
            bound = step.result.text if step.result else ""
            result.append(CallMethod(name.text, step.span, arguments, bound))
        elif step.arguments is not None and name.text in members.codels:
            message = f"`{name}` is a codel, its arguments follow from what it reads and writes"
            report.add(Diagnostic("MV307", message, Label(step.span), help=Fix(f"write `{name}`")))
        elif step.arguments is not None:
            known = {n: m.span for n, m in members.methods.items()}
            label = "its methods are " + ", ".join(f"`{n}`" for n in known) if known else "it declares no methods"
            message = f"`{members.component}` has no method `{name}`"
            report.add(unknown("MV107", message, label, name.span, known, "a method"))
        else:
            report.add(unknown_codel(name, members))
    return tuple(result)


def _check_call(step: ast.Step, method: Method, members: Members, report: Report) -> None:
    arguments = step.arguments or ()
    if len(arguments) != len(method.parameters):
        count = len(method.parameters)
        message = f"`{method.name}` takes {count or 'no'} argument{'' if count == 1 else 's'}, not {len(arguments)}"
        report.add(Diagnostic("MV307", message, Label(step.span), labels=(Label(method.span, "declared here"),)))
    for argument, (parameter, type_) in zip(arguments, method.parameters, strict=False):
        found = members.type_of(argument.text)
        if found is None:
            message = f"`{members.component}` has no port, property or variable `{argument}`"
            report.add(unknown("MV108", message, "unknown", argument.span, members.spans(), "something"))
        elif found != type_:
            message = f"`{argument}` is a `{found}`, the parameter `{parameter}` of `{method.name}` a `{type_}`"
            labels = (Label(method.span, "declared here"),)
            report.add(Diagnostic("MV307", message, Label(argument.span, f"a `{found}`"), labels=labels))
    _check_binding(step, method.result, members, report)


def _check_binding(step: ast.Step, result: Type | None, members: Members, report: Report) -> None:
    name = step.result
    if name is None:
        return
    if result is None:
        message = f"`{step.target}` returns nothing that `{name}` could take"
        report.add(Diagnostic("MV307", message, Label(name.span)))
        return
    found = members.type_of(name.text)
    if found is None:
        message = f"`{members.component}` has no variable `{name}`"
        report.add(unknown("MV108", message, "unknown", name.span, members.spans(), "a variable"))
        return
    datum, port = members.data.get(name.text), members.ports.get(name.text)
    if (datum is not None and datum.is_property) or (port is not None and port.kind is not ast.PortKind.OUT):
        what = "property" if datum is not None else "in port"
        report.add(Diagnostic("MV307", f"`{name}` is a {what}: no step may write it", Label(name.span)))
    elif found != result:
        message = f"`{step.target}` returns a `{result}`, `{name}` is a `{found}`"
        report.add(Diagnostic("MV307", message, Label(name.span, f"a `{found}`")))
