"""Calls of operations that run in their owner: which activations of the owner serve them, and that all of them do.

The caller waits for the answer (semantics of record, section 2). The wait has a bound only where the owner comes to
its requests again and again: it runs with a period, and serves in every state it may be in (MV315). Calls in a circle
wait for each other for ever (MV312).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.model import (
    CallMethod,
    Component,
    Endpoint,
    Instance,
    Operation,
    Region,
    Role,
    RunCodel,
    RunsIn,
    ServiceConnection,
    State,
    Step,
)
from mauve.model.reachability import components, reversed_graph
from mauve.records import record


def serves(state: State, component: Component, operation: Operation) -> bool:
    """Whether an activation in this state of the owner carries out requests of an operation: one of its `method` steps
    names the operation's codel, or one that implements no operation and so stands for all of them."""
    steps = state.steps(Role.METHOD)
    named = {step.codel for step in steps if isinstance(step, RunCodel)}
    others = named - {each.codel for each in component.operations}
    return operation.codel in named or bool(others) or any(not isinstance(step, RunCodel) for step in steps)


def server(component: Component, operation: Operation) -> Region | None:
    """The region that serves an operation in all of its states. A nested one does not count: it may be inactive."""
    return next((r for r in component.regions if all(serves(s, component, operation) for s in r.states)), None)


def steps_of(region: Region) -> Iterator[Step]:
    """The steps of the states of a region and of those nested in it, guards excepted: they call nothing."""
    for state in region.states:
        for activity in state.activities:
            yield from activity.steps
        for transition in state.transitions:
            yield from transition.do
        for nested in state.regions:
            yield from steps_of(nested)


@record
class _Call:
    """A connected method that some step of the caller calls, and the operation that runs in its owner."""

    caller: Instance
    owner: Instance
    operation: Operation
    connection: ServiceConnection


def check_calls(connections: Sequence[ServiceConnection], instances: Mapping[str, Instance], report: Report) -> None:
    """Append MV312 for calls in a circle and MV315 for calls that nothing bounds the wait of."""
    calls = list(_calls(connections, instances))
    told: set[Endpoint] = set()
    for call in calls:
        if call.connection.provider not in told:
            told.add(call.connection.provider)
            _check_served(call, report)
    _check_circles(calls, report)


def _calls(connections: Sequence[ServiceConnection], instances: Mapping[str, Instance]) -> Iterator[_Call]:
    for connection in connections:
        caller, owner = instances[connection.caller.instance], instances[connection.provider.instance]
        operation = next(o for o in owner.component.operations if o.name == connection.provider.name)
        if operation.runs is RunsIn.OWNER and any(
            isinstance(step, CallMethod) and step.method == connection.caller.name
            for region in caller.component.regions
            for step in steps_of(region)
        ):
            yield _Call(caller, owner, operation, connection)


def _check_served(call: _Call, report: Report) -> None:
    owner, operation = call.owner, call.operation
    primary = Label(call.connection.span, "the caller waits for the answer")
    message = f"nothing bounds how long `{call.connection.caller}` waits for `{call.connection.provider}`"
    if not owner.active:
        labels = (Label(owner.component.span, f"a {owner.component.kind.value} component"),)
        help_ = Fix("let it run in its caller (`runs in caller`), or exchange request and answer through ports")
        report.add(Diagnostic("MV315", message, primary, labels=labels, help=help_))
    elif owner.sporadic:
        labels = (Label(owner.span, "it is woken by events, not by requests"),)
        help_ = Fix(f"give `{owner.name}` a `period`, so that it looks at its requests each time")
        report.add(Diagnostic("MV315", message, primary, labels=labels, help=help_))
    elif owner.component.regions and server(owner.component, operation) is None:
        report.add(_unserved(call, message, primary))


def _unserved(call: _Call, message: str, primary: Label) -> Diagnostic:
    component, operation = call.owner.component, call.operation
    some = [r for r in component.regions if any(serves(s, component, operation) for s in r.states)]
    if not some:
        label = Label(operation.span, "no state of the owner serves it")
        help_ = Fix(f"write `method {operation.codel}` in each state of one of its regions")
        return Diagnostic("MV315", message, primary, labels=(label,), help=help_)
    lacking = [state for state in some[0].states if not serves(state, component, operation)]
    labels = tuple(Label(state.span, "no requests are served here") for state in lacking[:3])
    help_ = Fix(f"write `method {operation.codel}` in `{lacking[0].name}` too: the owner may stay there")
    return Diagnostic("MV315", message, primary, labels=labels, help=help_)


def _check_circles(calls: Sequence[_Call], report: Report) -> None:
    after: dict[str, list[str]] = {}
    for call in calls:
        after.setdefault(call.caller.name, []).append(call.owner.name)
        after.setdefault(call.owner.name, [])
    for circle in components(tuple(after), after, reversed_graph(after)):
        links = [call for call in calls if call.caller.name in circle and call.owner.name in circle]
        if len(circle) > 1:
            names = "`" + "`, `".join(circle) + "`"
            labels = tuple(Label(link.connection.span, "and this one") for link in links[1:3])
            help_ = Fix("let one of the operations run in its caller, or answer through a port")
            message = f"{names} call each other in a circle: each may wait for the other for ever"
            primary = Label(links[0].connection.span, "this call")
            report.add(Diagnostic("MV312", message, primary, labels=labels, help=help_))
