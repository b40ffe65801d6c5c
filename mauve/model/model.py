"""The resolved, typed model: names are bound, units converted, defaults applied and marked. The input of `lower`.

Times are picoseconds. Objects refer to each other by value where the target is immutable and by name where a cycle
would arise. Every object keeps the span it was written at, for diagnostics of later stages.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from mauve.model.types import Type
from mauve.records import record
from mauve.source import Span
from mauve.syntax.ast import ComponentKind, Latency, Overflow, PortKind, Role, RunsIn

if TYPE_CHECKING:
    from mauve.model.missions import MissionPart

__all__ = ["ComponentKind", "Latency", "Overflow", "PortKind", "Role", "RunsIn"]


@record
class Setting:
    """An integer that was written (`span` says where) or taken by default (`default` says by which rule)."""

    value: int
    span: Span | None = None
    default: str = ""


# ------------------------------------------------------------------------------------------------ components
@record
class Port:
    """A data or event port."""

    name: str
    kind: PortKind
    type: Type
    span: Span
    type_span: Span


@record
class Datum:
    """A property or a variable."""

    name: str
    type: Type
    span: Span
    is_property: bool


@record
class Codel:
    """A C function. `reads` and `writes` name ports, properties, variables, or parameters of the operation it
    implements. `wcet` is the declared time; `symbol` a fixed name of the function."""

    name: str
    reads: tuple[str, ...]
    writes: tuple[str, ...]
    returns: Type | None
    wcet: int | None
    symbol: str | None
    init: bool
    span: Span


@record
class Operation:
    """A service provided, executed by `codel` in the caller's or the owner's task."""

    name: str
    parameters: tuple[tuple[str, Type], ...]
    result: Type | None
    codel: str
    runs: RunsIn
    span: Span


@record
class Method:
    """A service required."""

    name: str
    parameters: tuple[tuple[str, Type], ...]
    result: Type | None
    span: Span


@record
class RunCodel:
    """A step that executes a codel of the component."""

    codel: str
    span: Span


@record
class CallMethod:
    """A step that calls a required service with `arguments` of the component; `result` takes what it returns."""

    method: str
    span: Span
    arguments: tuple[str, ...] = ()
    result: str = ""


Step = RunCodel | CallMethod


@record
class Activity:
    """The steps of one role of a state. `every` is a period of its own; `apart` the least separation of a `once`
    activity (0 when none was given), None for an activity that is executed at each step."""

    role: Role
    steps: tuple[Step, ...]
    every: int | None
    apart: int | None
    span: Span


@record
class Transition:
    """From its state to `target`. `guards` are the bool codels that deciding the guard may call, in order of writing;
    `always` says that nothing can keep it from being taken (no event, guard or delay)."""

    target: str
    event: str | None
    guards: tuple[RunCodel, ...]
    after: int | None
    do: tuple[Step, ...]
    emit: tuple[str, ...]
    span: Span

    @property
    def always(self) -> bool:
        """Whether it is taken whenever it is tried."""
        return self.event is None and not self.guards and self.after is None


@record
class State:
    """A state with its activities, nested regions and transitions in the order written."""

    name: str
    final: bool
    activities: tuple[Activity, ...]
    regions: tuple[Region, ...]
    transitions: tuple[Transition, ...]
    span: Span

    def steps(self, role: Role) -> tuple[Step, ...]:
        """The steps of a role that run at every activation (those of `once` activities count as entry steps)."""
        return tuple(
            step
            for activity in self.activities
            if (activity.role is role and activity.apart is None) or (role is Role.ENTRY and activity.apart is not None)
            for step in activity.steps
        )


@record
class Region:
    """States of which one is active at a time. `name` is empty for a behaviour without regions."""

    name: str
    initial: str
    states: tuple[State, ...]
    span: Span


@record
class Component:
    """A component type. `regions` is empty for passive and external ones and for one whose behaviour is in error."""

    name: str
    kind: ComponentKind
    ports: tuple[Port, ...]
    data: tuple[Datum, ...]
    events: tuple[str, ...]
    operations: tuple[Operation, ...]
    methods: tuple[Method, ...]
    codels: tuple[Codel, ...]
    regions: tuple[Region, ...]
    span: Span

    def codel(self, name: str) -> Codel:
        """A codel by its name."""
        return next(codel for codel in self.codels if codel.name == name)


# ------------------------------------------------------------------------------------------------ architecture
@record
class Instance:
    """A component in an architecture. Periodic (`period`), or sporadic with a least separation (`period` too,
    `sporadic` true). Passive instances have neither period, priority nor deadline, external ones no priority and
    deadline. The analysis takes every phasing for possible, so it does not use `offset`."""

    name: str
    component: Component
    period: Setting | None
    sporadic: bool
    deadline: Setting | None
    priority: Setting | None
    offset: int
    jitter: int
    span: Span

    @property
    def active(self) -> bool:
        """Whether it has a task."""
        return self.component.kind is ComponentKind.ACTIVE


@record
class Endpoint:
    """A port, method or operation of an instance."""

    instance: str
    name: str

    def __str__(self) -> str:
        return f"{self.instance}.{self.name}"


@record
class DataConnection:
    """An out port to an in or event port. `size` is None where unbuffered."""

    source: Endpoint
    target: Endpoint
    size: int | None
    overflow: Overflow | None
    span: Span


@record
class ServiceConnection:
    """A required method to a provided operation."""

    caller: Endpoint
    provider: Endpoint
    span: Span


@record
class FlowStep:
    """An instance on a flow: the port or operation where data come in, the port or method where they go out (each empty
    where the flow does not say); `woken` by what comes in."""

    instance: str
    enters: str
    leaves: str
    woken: bool


@record
class Flow:
    """Data on their way through the tasks of some instances, and within which time which `latency` is to be."""

    name: str
    steps: tuple[FlowStep, ...]
    within: Setting | None
    latency: Latency
    span: Span


@record
class Architecture:
    """Instances, connections, and flows along them. `complete` is False where an instance in error was left out."""

    name: str
    instances: tuple[Instance, ...]
    data: tuple[DataConnection, ...]
    services: tuple[ServiceConnection, ...]
    external: tuple[Endpoint, ...]
    complete: bool
    span: Span
    flows: tuple[Flow, ...] = ()


# ------------------------------------------------------------------------------------------------ platform
@record
class Wait:
    """Wait states: CPU cycles, or picoseconds to be rounded up to cycles."""

    amount: int
    in_cycles: bool


@record
class MemoryRegion:
    """A memory of a board."""

    name: str
    start: int
    size: int
    wait: Wait
    write_wait: Wait | None
    span: Span


@record
class Feature:
    """A hardware mechanism that is switched on, as written."""

    name: str
    settings: tuple[str, ...]
    span: Span


@record
class Board:
    """A processor with its memories and its operating system's overheads (times in picoseconds, 0 when not given)."""

    name: str
    core: str
    core_span: Span
    hertz: int
    memories: tuple[MemoryRegion, ...]
    features: tuple[Feature, ...]
    context_switch: int
    tick_every: int | None
    tick_cost: int
    span: Span


# ------------------------------------------------------------------------------------------------ deployment
@record
class CodelId:
    """A codel of a component type."""

    component: str
    codel: str

    def __str__(self) -> str:
        return f"{self.component}.{self.codel}"


@record
class CodePlace:
    """A place in a binary: `file` and `line`, or `symbol` and the offset `address`, or `address` alone."""

    file: str | None
    line: int | None
    symbol: str | None
    address: int


@record
class LoopFact:
    """A loop bound: per entry, and per execution of the function."""

    place: CodePlace
    maximum: int | None
    total: int | None
    span: Span


@record
class RecursionFact:
    """How many activations of a function are under way at once."""

    place: CodePlace
    maximum: int
    span: Span


@record
class ControlFact:
    """Where an indirect branch or call goes; without targets: a function that does not return."""

    place: CodePlace
    targets: tuple[CodePlace, ...]
    span: Span


@record
class AssumedRange:
    """What is assumed of a number in memory, or of an argument (counted from 1) of the function at `place`. `width` in
    bytes is that of an element; `low` and `high` are None for any number. `ends`: the argument points to so many bytes,
    and every string that begins in them ends in them."""

    place: CodePlace
    argument: int | None
    width: int | None
    low: int | None
    high: int | None
    span: Span
    ends: int | None = None


@record
class Binary:
    """An ELF file (`path` resolved against the model's file) with symbols by codel and flow facts."""

    path: str
    symbols: tuple[tuple[CodelId, str, Span], ...]
    facts: tuple[LoopFact | RecursionFact | AssumedRange | ControlFact, ...]
    fact_files: tuple[tuple[str, Span], ...]
    span: Span


@record
class Assumption:
    """A time assumed for a codel; `codel` None covers every codel that nothing else names."""

    codel: CodelId | None
    wcet: int
    span: Span


@record
class Interrupt:
    """An interrupt above every priority, at least `every` apart; its handler's time is given or comes from `symbol`."""

    name: str
    every: int
    wcet: int | None
    symbol: str | None
    span: Span


@record
class RegionId:
    """A region of an instance: the path of region names from the outermost (`spooler.processing`), or the whole
    instance's single region when `path` is empty; `ports` of an instance stand for its port exchange."""

    instance: str
    path: tuple[str, ...]

    def __str__(self) -> str:
        return ".".join((self.instance, *self.path))


@record
class Thread:
    """A task of the operating system that executes regions. `period` is the gcd of theirs unless written; `process`
    the address space it belongs to, `locked` whether that protects shared data by immediate priority ceilings."""

    name: str
    members: tuple[tuple[RegionId, Span], ...]
    period: Setting | None
    deadline: Setting | None
    priority: Setting | None
    jitter: int
    process: str
    locked: bool
    span: Span


@record
class Node:
    """A board with what runs on it. `threads` is empty when every active instance is a task of its own; `locked` then
    says that they protect shared data by immediate ceilings."""

    name: str
    board: Board
    binaries: tuple[Binary, ...]
    assumptions: tuple[Assumption, ...]
    interrupts: tuple[Interrupt, ...]
    threads: tuple[Thread, ...]
    exchanges: tuple[tuple[str, int, Span], ...]
    rate_monotonic: bool
    locked: bool
    span: Span


@record
class Deployment:
    """An architecture on nodes. `expect_unschedulable` inverts its verdict."""

    name: str
    abstract: bool
    architecture: Architecture
    nodes: tuple[Node, ...]
    expect_unschedulable: Span | None
    span: Span


@record
class Model:
    """Everything one check needs, from the file given and its imports."""

    components: tuple[Component, ...]
    architectures: tuple[Architecture, ...]
    boards: tuple[Board, ...]
    deployments: tuple[Deployment, ...]
    missions: MissionPart | None = None
