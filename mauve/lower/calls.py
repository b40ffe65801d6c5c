"""Which codels a step executes: its own, or through a connected service the provider's."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from mauve.model.model import (
    Architecture,
    CallMethod,
    CodelId,
    Endpoint,
    Instance,
    Operation,
    Region,
    Role,
    RunCodel,
    RunsIn,
    Step,
)
from mauve.source import Span


@dataclass(frozen=True, slots=True)
class Service:
    """Where a method leads: the operation of an instance."""

    provider: Instance
    operation: Operation


@dataclass(frozen=True, slots=True)
class Use:
    """A codel that a step of an instance executes; `provider` is set for a call, `when` says in words where it
    stands.
    """

    codel: CodelId
    when: str
    span: Span
    provider: str = ""


def services(architecture: Architecture) -> Mapping[Endpoint, Service]:
    """The operation behind each connected method."""
    found: dict[Endpoint, Service] = {}
    for connection in architecture.services:
        provider = architecture.instance(connection.provider.instance)
        for operation in provider.component.operations:
            if operation.name == connection.provider.name:
                found[connection.caller] = Service(provider, operation)
    return found


def step_use(step: Step, instance: Instance, connected: Mapping[Endpoint, Service], when: str) -> Use | None:
    """What a step executes in the task of `instance`; None for a method that leads nowhere (MV210 was reported)."""
    match step:
        case RunCodel(codel=codel, span=span):
            return Use(CodelId(instance.component.name, codel), when, span)
        case CallMethod(method=method, span=span):
            service = connected.get(Endpoint(instance.name, method))
            if service is None:
                return None
            codel_id = CodelId(service.provider.component.name, service.operation.codel)
            return Use(codel_id, when, span, service.provider.name)


def uses(instance: Instance, connected: Mapping[Endpoint, Service]) -> Iterator[Use]:
    """Every codel that the task of an instance executes, once per place."""
    for region in instance.component.regions:
        yield from _region_uses(region, instance, connected)


def _region_uses(region: Region, instance: Instance, connected: Mapping[Endpoint, Service]) -> Iterator[Use]:
    words = {
        Role.ENTRY: "when entering",
        Role.MESSAGE: "for the messages of",
        Role.METHOD: "for the requests of",
        Role.RUN: "at each step of",
        Role.EXIT: "when leaving",
    }
    for state in region.states:
        places = [(activity.steps, f"{words[activity.role]} `{state.name}`") for activity in state.activities]
        for transition in state.transitions:
            way = f"on the way from `{state.name}` to `{transition.target}`"
            places += [(transition.guards, f"to decide whether to leave `{state.name}`"), (transition.do, way)]
        for steps, when in places:
            for step in steps:
                use = step_use(step, instance, connected, when)
                if use is not None:
                    yield use
        for nested in state.regions:
            yield from _region_uses(nested, instance, connected)


def owner_requests(instance: Instance, architecture: Architecture) -> Iterator[tuple[Endpoint, Operation]]:
    """The methods whose calls an instance serves in its own task, with the operation each one requests."""
    for caller, service in services(architecture).items():
        if service.provider.name == instance.name and service.operation.runs is RunsIn.OWNER:
            yield caller, service.operation
