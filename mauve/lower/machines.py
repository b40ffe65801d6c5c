"""From a component to its periodic state machines (seed 001, III.C.2; semantics of record, section 2).

From state s every activation costs message + method + run of s + the guards evaluated until one holds, or all of
them when none does: that is the loop s -> s. A transition s -> t adds exit of s, its own `do` steps, entry of t. A
start pseudo-state pays the entry of the initial state. Orthogonal regions are machines of their own; a nested
region has an inactive state.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from mauve.lower.calls import Service, owner_requests, services, step_use
from mauve.model.model import Architecture, CodelId, Endpoint, Instance, Region, RegionId, Role, State, Step, Transition
from mauve.model.periods import region_period
from mauve.timing.psm import CostPart, Psm, PsmTransition, make_psm

START = "(start)"
INACTIVE = "(inactive)"

Times = Mapping[CodelId, int]
"""Picoseconds per codel."""


@dataclass(frozen=True, slots=True)
class Machine:
    """The PSM of a region; `period` is its own (gcd of its activities' periods) or None for that of its instance."""

    region: RegionId
    psm: Psm
    period: int | None


@dataclass(frozen=True, slots=True)
class _Costs:
    """What steps cost in one instance. Codels without a time leave a hole: the machine is then not built."""

    instance: Instance
    connected: Mapping[Endpoint, Service]
    times: Times
    messages: int
    requests: tuple[CostPart, ...]

    def parts(self, steps: tuple[Step, ...]) -> Iterator[CostPart]:
        for step in steps:
            use = step_use(step, self.instance, self.connected, "")
            if use is not None:
                yield CostPart(str(use.codel), self.times[use.codel])

    def activation(self, state: State) -> list[CostPart]:
        """Message, method and run steps of a state, the handlers counted once per waiting element."""
        messages = [
            CostPart(f"{part.label} x{self.messages}", part.cost * self.messages) if self.messages > 1 else part
            for part in self.parts(state.steps(Role.MESSAGE))
        ]
        method_steps = state.steps(Role.METHOD)
        methods = [*self.parts(method_steps), *(self.requests if method_steps else ())]
        return [*messages, *methods, *self.parts(state.steps(Role.RUN))]


def machines(instance: Instance, architecture: Architecture, times: Times) -> tuple[Machine, ...] | None:
    """The machines of an active instance, outer regions before inner ones; None where a codel has no time."""
    connected = services(architecture)
    costs = _Costs(instance, connected, times, waiting_messages(instance, architecture), ())
    try:
        requests = tuple(
            CostPart(str(id_ := CodelId(instance.component.name, operation.codel)), times[id_])
            for _, operation in owner_requests(instance, architecture)
        )
        costs = _Costs(instance, connected, times, costs.messages, requests)
        return tuple(_machines(instance.component.regions, instance, (), costs, False))
    except KeyError:
        return None


def waiting_messages(instance: Instance, architecture: Architecture) -> int:
    """The most messages that may wait at one activation: the sizes of the queues into its ports, 1 for an
    unbuffered one.
    """
    sizes = [c.size or 1 for c in architecture.data if c.target.instance == instance.name]
    return max(1, sum(sizes))


def _machines(
    regions: tuple[Region, ...], instance: Instance, path: tuple[str, ...], costs: _Costs, nested: bool
) -> Iterator[Machine]:
    for region in regions:
        here = (*path, region.name) if region.name else path
        id_ = RegionId(instance.name, here)
        yield Machine(id_, _psm(str(id_), region, costs, nested), region_period(region))
        for state in region.states:
            yield from _machines(state.regions, instance, here, costs, True)


def _psm(name: str, region: Region, costs: _Costs, nested: bool) -> Psm:
    transitions: list[PsmTransition] = []
    initial = region.state(region.initial)
    entry = tuple(costs.parts(initial.steps(Role.ENTRY)))
    start = INACTIVE if nested else START
    transitions.append(_arc(start, initial.name, entry, "entry"))
    if nested:
        transitions.append(_arc(INACTIVE, INACTIVE, (), "parent not active"))
    for state in region.states:
        transitions += _from_state(state, region, costs)
        if nested:
            parts = [*costs.activation(state), *_guards(state.transitions, costs), *costs.parts(state.steps(Role.EXIT))]
            transitions.append(_arc(state.name, INACTIVE, tuple(parts), "parent left"))
    return make_psm(name, start, transitions)


def _guards(tried: tuple[Transition, ...], costs: _Costs) -> Iterator[CostPart]:
    for transition in tried:
        yield from costs.parts(transition.guards)


def _from_state(state: State, region: Region, costs: _Costs) -> Iterator[PsmTransition]:
    """The transitions that can be taken, in the order they are tried, and the loop where none need be."""
    step = costs.activation(state)
    for index, transition in enumerate(state.transitions):
        target = region.state(transition.target)
        parts = [
            *step,
            *_guards(state.transitions[: index + 1], costs),
            *costs.parts(state.steps(Role.EXIT)),
            *costs.parts(transition.do),
            *costs.parts(target.steps(Role.ENTRY)),
        ]
        yield _arc(state.name, target.name, tuple(parts), _words(transition))
        if transition.always:
            return
    yield _arc(state.name, state.name, (*step, *_guards(state.transitions, costs)), "stays")


def _words(transition: Transition) -> str:
    words = [f"on {transition.event}"] if transition.event else []
    words += [f"when {' '.join(guard.codel for guard in transition.guards)}"] if transition.guards else []
    return " ".join(words) or ("after a time" if transition.after is not None else "always")


def _arc(source: str, target: str, parts: tuple[CostPart, ...], label: str) -> PsmTransition:
    return PsmTransition(source, target, sum(part.cost for part in parts), label, parts)
