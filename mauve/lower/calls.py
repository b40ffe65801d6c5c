"""Which codels a step executes: its own, or through a connected service the provider's."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from mauve.model.model import (
    Architecture,
    CallMethod,
    CodelId,
    Endpoint,
    Instance,
    Operation,
    RegionId,
    Role,
    RunCodel,
    State,
    Step,
)
from mauve.model.threads import region_ids
from mauve.records import record
from mauve.source import Span


@record
class Service:
    """Where a method leads: the operation of an instance."""

    provider: Instance
    operation: Operation


Services = Mapping[Endpoint, Service]
"""The operation behind each connected method."""


@record
class Use:
    """A step of `region` that executes a codel; `provider` is the instance called, empty for a codel of its own.
    `when` says in words where it stands; `reads` and `writes` are the instance's data that it touches."""

    codel: CodelId
    region: RegionId
    when: str
    span: Span
    provider: str
    reads: tuple[str, ...]
    writes: tuple[str, ...]


def services(architecture: Architecture) -> Services:
    """The operation behind each connected method."""
    instances = {instance.name: instance for instance in architecture.instances}
    found: dict[Endpoint, Service] = {}
    for connection in architecture.services:
        provider = instances[connection.provider.instance]
        for operation in provider.component.operations:
            if operation.name == connection.provider.name:
                found[connection.caller] = Service(provider, operation)
    return found


def executed(step: Step, instance: Instance, connected: Services) -> tuple[CodelId, str] | None:
    """The codel that a step executes in the task of `instance`, and the instance it calls (empty for none); None for a
    method that leads nowhere (MV210 was reported)."""
    match step:
        case RunCodel(codel=codel):
            return CodelId(instance.component.name, codel), ""
        case CallMethod(method=method):
            service = connected.get(Endpoint(instance.name, method))
            if service is None:
                return None
            return CodelId(service.provider.component.name, service.operation.codel), service.provider.name


def uses(instance: Instance, connected: Services) -> Iterator[Use]:
    """Every codel that the regions of an instance execute, once per place."""
    for id_, region in region_ids(instance):
        for state in region.states:
            for when, steps in _places(state):
                for step in steps:
                    found = executed(step, instance, connected)
                    if found is not None:
                        yield Use(found[0], id_, when, step.span, found[1], *_touched(step, instance))


def _places(state: State) -> Iterator[tuple[str, tuple[Step, ...]]]:
    words = {
        Role.ENTRY: "when entering",
        Role.MESSAGE: "for the messages of",
        Role.METHOD: "for the requests of",
        Role.RUN: "at each step of",
        Role.EXIT: "when leaving",
    }
    for activity in state.activities:
        yield f"{words[activity.role]} `{state.name}`", activity.steps
    for transition in state.transitions:
        yield f"to decide whether to leave `{state.name}`", transition.guards
        yield f"on the way from `{state.name}` to `{transition.target}`", transition.do


def _touched(step: Step, instance: Instance) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The data of an instance that a step reads and writes."""
    match step:
        case RunCodel(codel=name):
            codel = instance.component.codel(name)
            return codel.reads, codel.writes
        case CallMethod(arguments=arguments, result=result):
            return arguments, (result,) if result else ()
