"""Which codels a step executes: its own, or through a connected service the provider's."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from mauve.model.calls import serves
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
    RunsIn,
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

    @property
    def waits(self) -> bool:
        """Whether a call waits for the provider's task."""
        return self.operation.runs is RunsIn.OWNER

    @property
    def codel(self) -> CodelId:
        """What carries the operation out."""
        return CodelId(self.provider.component.name, self.operation.codel)

    def __str__(self) -> str:
        return f"{self.provider.name}.{self.operation.name}"


@record
class Services:
    """The operation behind each connected method, and per instance the operations that its own task carries out for
    those who call them."""

    by_method: Mapping[Endpoint, Service]
    asked: Mapping[str, tuple[Operation, ...]]

    def find(self, instance: str, method: str) -> Service | None:
        """The operation behind a method; None for one that leads nowhere (MV210 was reported)."""
        return self.by_method.get(Endpoint(instance, method))


@record
class Use:
    """A step of `region` that executes a codel; `provider` is the instance called, empty for a codel of its own.
    `when` says in words where it stands; `reads` and `writes` are the instance's data that it touches. Where it
    `waits`, the provider's task executes the codel of its `operation`."""

    codel: CodelId
    region: RegionId
    when: str
    span: Span
    provider: str
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    waits: bool = False
    operation: str = ""


def services(architecture: Architecture) -> Services:
    """The operation behind each connected method."""
    instances = {instance.name: instance for instance in architecture.instances}
    found: dict[Endpoint, Service] = {}
    for connection in architecture.services:
        provider = instances[connection.provider.instance]
        for operation in provider.component.operations:
            if operation.name == connection.provider.name:
                found[connection.caller] = Service(provider, operation)
    asked: dict[str, dict[str, Operation]] = {}
    for service in found.values():
        if service.waits:
            asked.setdefault(service.provider.name, {})[service.operation.name] = service.operation
    return Services(found, {owner: tuple(operations.values()) for owner, operations in asked.items()})


def called(step: Step, instance: Instance, connected: Services) -> Service | None:
    """The operation that a step of `instance` calls; None for another step, or a method that leads nowhere."""
    return connected.find(instance.name, step.method) if isinstance(step, CallMethod) else None


def served(state: State, instance: Instance, connected: Services) -> tuple[Operation, ...]:
    """The operations that an activation in a state of the owner carries out for those who wait."""
    asked = connected.asked.get(instance.name, ())
    return tuple(operation for operation in asked if serves(state, instance.component, operation))


def uses(instance: Instance, connected: Services) -> Iterator[Use]:
    """Every codel that the regions of an instance execute, once per place, and those that they wait for."""
    component = instance.component
    for id_, region in region_ids(instance):
        for state in region.states:
            for when, steps in _places(state):
                for step in steps:
                    touched = _touched(step, instance)
                    service = called(step, instance, connected)
                    if service is not None:
                        provider, asked = service.provider.name, service.operation.name
                        yield Use(service.codel, id_, when, step.span, provider, *touched, service.waits, asked)
                    elif isinstance(step, RunCodel):
                        yield Use(CodelId(component.name, step.codel), id_, when, step.span, "", *touched)
            for operation in served(state, instance, connected):
                codel = component.codel(operation.codel)
                own = {port.name for port in component.ports} | {datum.name for datum in component.data}
                reads, writes = (tuple(n for n in names if n in own) for names in (codel.reads, codel.writes))
                when = f"for the requests of `{state.name}`"
                yield Use(CodelId(component.name, codel.name), id_, when, operation.span, "", reads, writes)


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
