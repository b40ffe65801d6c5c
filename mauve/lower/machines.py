"""From a component to its periodic state machines (seed 001, III.C.2; semantics of record, section 2).

From state s every activation costs message + method + run of s + the guards evaluated until one holds, or all of
them when none does: that is the loop s -> s. A transition s -> t adds exit of s, its own `do` steps, entry of t. A
start pseudo-state pays the entry of the initial state. Orthogonal regions are machines of their own.

A nested region has an inactive state. In an activation in which its parent is entered it pays the entry of its initial
state; in one in which its parent is left, at most its own step and the exit of its state; in one between which and the
last its parent was left and entered again, both.

Operations that run in their owner: each activation of a region that serves them, the first one included, carries out
all requests that wait. A task that calls waits for the answer, so of each at most one waits (`requests`). The call
itself costs two more context switches; how long the caller waits is no cost of the machine but a part of its own,
labelled `wait for OWNER.OPERATION`, which `suspension.py` fills in.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence

from mauve.lower.calls import Services, called, served, services, uses
from mauve.model.model import (
    CodelId,
    DataConnection,
    Deployment,
    Instance,
    PortKind,
    Region,
    RegionId,
    Role,
    RunCodel,
    State,
    Step,
    Thread,
    Transition,
)
from mauve.model.periods import region_period
from mauve.model.queues import most_arrivals
from mauve.model.threads import in_threads, placement
from mauve.records import changed, record
from mauve.timing.psm import CostPart, Psm, PsmTransition, make_psm

START = "(start)"
INACTIVE = "(inactive)"

WAIT_SWITCHES = "context switches of a wait"
"""What a call of an operation that runs in its owner costs the caller itself."""

Times = Mapping[CodelId, int]
"""Picoseconds per codel."""

Callers = Mapping[str, Mapping[str, frozenset[str]]]
"""Per owner and task that calls it, the operations it waits for."""


def wait_label(operation: str) -> str:
    """What the wait for `owner.operation` is called among the parts of a transition."""
    return f"wait for {operation}"


@record
class Machine:
    """The PSM of a region; `period` is that of its activations (gcd of its activities' periods, or that of the region
    or the instance around it), None where nothing gives one."""

    region: RegionId
    psm: Psm
    period: int | None


@record
class _Costs:
    """What steps cost in a region of an instance; `waiting` counts the messages that may wait at each of its in-ports,
    `producers` are the instances at the other ends of the connections that lead to them, one per thread that executes
    a part of them (`in_threads`). `callers` are the tasks that wait for its operations, `switch` a context switch."""

    instance: Instance
    connected: Services
    times: Times
    producers: tuple[tuple[DataConnection, tuple[Instance, ...]], ...]
    waiting: Mapping[str, int]
    callers: Mapping[str, frozenset[str]]
    switch: int

    def every(self, period: int | None) -> _Costs:
        """The costs in a region that is activated with this period."""
        return changed(self, waiting=waiting_messages(self.instance, self.producers, period))

    def parts(self, steps: tuple[Step, ...]) -> Iterator[CostPart]:
        """The cost of each step. Raises KeyError for a codel without a time."""
        for step in steps:
            service = called(step, self.instance, self.connected)
            if isinstance(step, RunCodel):
                yield self._codel(CodelId(self.instance.component.name, step.codel))
            elif service is not None and service.waits:
                yield CostPart(wait_label(str(service)), 0)
                if self.switch:
                    yield CostPart(WAIT_SWITCHES, 2 * self.switch)
            elif service is not None:
                yield self._codel(service.codel)

    def _codel(self, codel: CodelId, count: int = 1) -> CostPart:
        return CostPart(str(codel), count * self.times[codel], count)

    def activation(self, state: State) -> Iterator[CostPart]:
        """Message, method and run steps of a state, the message handlers once per message that may wait."""
        for step in state.steps(Role.MESSAGE):
            count = self._messages(step)
            for part in self.parts((step,)):
                yield changed(part, cost=part.cost * count, count=part.count * count)
        yield from self.requests(state)
        yield from self.parts(state.steps(Role.RUN))

    def requests(self, state: State) -> Iterator[CostPart]:
        """The method steps of a state: those that are codels of operations once per task that waits for one of them
        (the dearest it may ask for), any other as often as there are such tasks, once where there is none."""
        component = self.instance.component
        codels = {operation.name: CodelId(component.name, operation.codel) for operation in component.operations}
        here = {operation.name for operation in served(state, self.instance, self.connected)}
        asked = [names & here for names in self.callers.values() if names & here]
        dearest = [max((codels[n] for n in names), key=lambda one: (self.times[one], str(one))) for names in asked]
        carried = {codels[name].codel for names in asked for name in names}
        count = max(1, len(asked))
        for step in state.steps(Role.METHOD):
            if not isinstance(step, RunCodel) or step.codel not in carried:
                for part in self.parts((step,)):
                    yield changed(part, cost=part.cost * count, count=part.count * count)
        for codel, times in Counter(dearest).items():
            yield self._codel(codel, times)

    def guards(self, tried: tuple[Transition, ...]) -> Iterator[CostPart]:
        """The guards of the transitions tried."""
        for transition in tried:
            yield from self.parts(transition.guards)

    def _messages(self, step: Step) -> int:
        """What may wait at the ports that the handler reads, or at any where it names none."""
        reads = self.instance.component.codel(step.codel).reads if isinstance(step, RunCodel) else ()
        counts = [self.waiting[name] for name in reads if name in self.waiting] or list(self.waiting.values())
        return max(1, sum(counts))


def build_machines(deployment: Deployment, times: Times) -> dict[str, tuple[Machine, ...] | None]:
    """The machines of each active instance, outer regions before inner ones; None where a codel has no time."""
    architecture = deployment.architecture
    connected = services(architecture)
    instances = {instance.name: instance for instance in architecture.instances}
    threads = placement(deployment)
    callers = waiting_tasks(deployment, connected)
    switch = max((node.board.context_switch for node in deployment.nodes), default=0)
    incoming: dict[str, list[tuple[DataConnection, tuple[Instance, ...]]]] = {}
    for connection in architecture.data:
        pair = connection, in_threads(instances[connection.source.instance], threads, instances)
        incoming.setdefault(connection.target.instance, []).append(pair)
    built: dict[str, tuple[Machine, ...] | None] = {}
    for instance in architecture.instances:
        if not instance.active:
            continue
        latest = max((one.jitter for one in in_threads(instance, threads, instances)), default=0)
        costs = _Costs(
            changed(instance, jitter=latest), connected, times, tuple(incoming.get(instance.name, ())), {},
            callers.get(instance.name, {}), switch,
        )  # fmt: skip
        try:
            regions = instance.component.regions
            built[instance.name] = tuple(m for region in regions for m in _machines(region, (), costs, threads))
        except KeyError:
            built[instance.name] = None
    return built


def waiting_tasks(deployment: Deployment, connected: Services) -> Callers:
    """The tasks that wait for operations of each owner: the threads of the regions that call them, or the instances
    where there are none."""
    threads = placement(deployment)
    found: dict[str, dict[str, frozenset[str]]] = {}
    for instance in deployment.architecture.instances if connected.asked else ():
        for use in uses(instance, connected):
            if use.waits:
                thread = threads.get(use.region)
                task = thread.name if thread is not None else instance.name
                asked = found.setdefault(use.provider, {})
                asked[task] = asked.get(task, frozenset()) | {use.operation}
    return found


def waiting_messages(
    instance: Instance, producers: Sequence[tuple[DataConnection, tuple[Instance, ...]]], period: int | None
) -> dict[str, int]:
    """The most messages that may wait at each in-port at one activation of a region with this period: as many as its
    queues hold, fewer where less arrive in between; 1 for the value of an unbuffered port."""
    counts = {port.name: 1 for port in instance.component.ports if port.kind is not PortKind.OUT}
    queued: dict[str, int] = {}
    for connection, writers in producers:
        if connection.size is not None:
            port = connection.target.name
            arrivals = [most_arrivals(port, writer, instance, period) for writer in writers]
            held = min(connection.size, sum(connection.size if n is None else n for n in arrivals))
            queued[port] = queued.get(port, 0) + held
    return counts | queued


@record
class _Parent:
    """The state around a nested region: whether it may be left and entered again between two activations of it."""

    again: bool
    period: int | None
    thread: Thread | None


def _machines(
    region: Region,
    path: tuple[str, ...],
    costs: _Costs,
    threads: Mapping[RegionId, Thread],
    parent: _Parent | None = None,
) -> Iterator[Machine]:
    here = (*path, region.name) if region.name else path
    id_ = RegionId(costs.instance.name, here)
    instance = costs.instance
    period = region_period(region, parent.period if parent else instance.period.value if instance.period else None)
    thread = threads.get(id_)
    again = parent is not None and (parent.again or parent.period != period or parent.thread != thread)
    yield Machine(id_, _psm(str(id_), region, costs.every(period), parent is not None, again), period)
    for state in region.states:
        to_itself = any(transition.target == state.name for transition in state.transitions)
        for nested in state.regions:
            yield from _machines(nested, here, costs, threads, _Parent(again or to_itself, period, thread))


def _psm(name: str, region: Region, costs: _Costs, nested: bool, again: bool) -> Psm:
    states = {state.name: state for state in region.states}
    initial = states[region.initial]
    entry = tuple(costs.parts(initial.steps(Role.ENTRY)))
    requests = tuple(costs.requests(initial)) if served(initial, costs.instance, costs.connected) and not nested else ()
    transitions = [_arc(INACTIVE if nested else START, region.initial, (*entry, *requests), "entry")]
    if nested:
        transitions.append(_arc(INACTIVE, INACTIVE, (), "parent not active"))
    for state in region.states:
        transitions += _from_state(state, states, costs)
        if nested:
            left = (*costs.activation(state), *costs.guards(state.transitions), *costs.parts(state.steps(Role.EXIT)))
            transitions.append(_arc(state.name, INACTIVE, left, "parent left"))
            if again:
                transitions.append(_arc(state.name, region.initial, (*left, *entry), "parent left and entered"))
    return make_psm(name, INACTIVE if nested else START, transitions)


def _from_state(state: State, states: Mapping[str, State], costs: _Costs) -> Iterator[PsmTransition]:
    """The transitions that can be taken, in the order they are tried, and the loop where none need be."""
    step = tuple(costs.activation(state))
    leaving = tuple(costs.parts(state.steps(Role.EXIT)))
    tried: tuple[CostPart, ...] = ()
    for transition in state.transitions:
        tried += tuple(costs.parts(transition.guards))
        entering = costs.parts(states[transition.target].steps(Role.ENTRY))
        parts = (*step, *tried, *leaving, *costs.parts(transition.do), *entering)
        yield _arc(state.name, transition.target, parts, _words(transition))
        if transition.always:
            return
    yield _arc(state.name, state.name, (*step, *tried), "stays")


def _words(transition: Transition) -> str:
    words = [f"on {transition.event}"] if transition.event else []
    words += [f"when {' '.join(guard.codel for guard in transition.guards)}"] if transition.guards else []
    return " ".join(words) or ("after a time" if transition.after is not None else "always")


def _arc(source: str, target: str, parts: tuple[CostPart, ...], label: str) -> PsmTransition:
    return PsmTransition(source, target, sum(part.cost for part in parts), label, parts)
