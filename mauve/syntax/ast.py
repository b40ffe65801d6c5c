"""The abstract syntax of MAUVE: what the user wrote, with a span on every node.

Names are not resolved and units not checked here. Records and tuples throughout. `doc` is the text of the
`///` lines before a declaration, without the slashes.
"""

from __future__ import annotations

from enum import Enum

from mauve.records import record
from mauve.source import SourceFile, Span


# ------------------------------------------------------------------------------------------------ names and literals
@record
class Name:
    """One identifier."""

    text: str
    span: Span

    def __str__(self) -> str:
        return self.text


@record
class Path:
    """Identifiers joined by dots; at least one."""

    parts: tuple[Name, ...]
    span: Span

    def __str__(self) -> str:
        return ".".join(part.text for part in self.parts)


@record
class Quantity:
    """A numeral with its unit stuck to it, as written: `10ms`, `200MHz`, `16KiB`, `1cycle`. The unit may be unknown."""

    number: str
    unit: str
    span: Span


@record
class Number:
    """A numeral without unit, as written: `3`, `-0.5`, `0x8000`."""

    text: str
    span: Span

    @property
    def is_integer(self) -> bool:
        """Whether it has neither fraction nor exponent."""
        return self.text.lstrip("-").isdigit() or self.text.lower().lstrip("-").startswith("0x")

    @property
    def integer(self) -> int:
        """Its value, when it is an integer."""
        return int(self.text, 16 if "x" in self.text.lower() else 10)


@record
class String:
    """A string without its quotes, escapes resolved."""

    value: str
    span: Span


@record
class Boolean:
    """`true` or `false`."""

    value: bool
    span: Span


@record
class Record:
    """`{ yaw: 0.0, roll: 0.0 }`."""

    fields: tuple[tuple[Name, Value], ...]
    span: Span


@record
class List:
    """`[1, 2, 3]`."""

    items: tuple[Value, ...]
    span: Span


Value = Quantity | Number | String | Boolean | Path | Record | List
"""A Path is the name of an enumeration's literal."""


# ------------------------------------------------------------------------------------------------ types
@record
class TypeRef:
    """A type by name with array dimensions: `Task[64]`."""

    path: Path
    dimensions: tuple[Number, ...]
    span: Span


@record
class Field:
    """One field of a struct (`x, y: f64` gives two)."""

    name: Name
    type: TypeRef
    doc: str = ""


@record
class StructDecl:
    """`struct Pose { x, y, heading: f64 }`."""

    name: Name
    fields: tuple[Field, ...]
    span: Span
    doc: str = ""


@record
class EnumDecl:
    """`enum LinkStatus { OK, TIMEOUT }`."""

    name: Name
    literals: tuple[Name, ...]
    span: Span
    doc: str = ""


# ------------------------------------------------------------------------------------------------ components
class ComponentKind(Enum):
    """An active component has a task; a passive one is a library; an external one lives outside the model."""

    ACTIVE = "active"
    PASSIVE = "passive"
    EXTERNAL = "external"


class PortKind(Enum):
    """Direction of a port. An event port is an in port that wakes its component."""

    IN = "in"
    OUT = "out"
    EVENT = "event"


@record
class PortDecl:
    """`in port state: RobotState`."""

    kind: PortKind
    name: Name
    type: TypeRef
    span: Span
    doc: str = ""


@record
class PropertyDecl:
    """`property gain: f64 = 0.2`, set per instance."""

    name: Name
    type: TypeRef
    default: Value | None
    span: Span
    doc: str = ""


@record
class VarDecl:
    """`var command: TrackCommand`, a variable of the component."""

    name: Name
    type: TypeRef
    span: Span
    doc: str = ""


@record
class EventDecl:
    """`event Done, Failure`: events that transitions emit and react to."""

    names: tuple[Name, ...]
    span: Span
    doc: str = ""


@record
class Parameter:
    """A parameter of an operation or method."""

    name: Name
    type: TypeRef


class RunsIn(Enum):
    """Which task executes an operation."""

    CALLER = "caller"
    OWNER = "owner"


@record
class OperationDecl:
    """`operation send(command: TrackCommand): LinkStatus = send_frame  runs in caller`: a service provided."""

    name: Name
    parameters: tuple[Parameter, ...]
    result: TypeRef | None
    codel: Name | None
    runs: RunsIn | None
    span: Span
    doc: str = ""


@record
class MethodDecl:
    """`method send(command: TrackCommand): LinkStatus`: a service required."""

    name: Name
    parameters: tuple[Parameter, ...]
    result: TypeRef | None
    span: Span
    doc: str = ""


@record
class CodelDecl:
    """`codel fuse reads position, attitude writes state returns bool wcet 2ms symbol "f"`.

    `init` codels run at start-up only.
    """

    name: Name
    reads: tuple[Name, ...]
    writes: tuple[Name, ...]
    returns: TypeRef | None
    wcet: Quantity | None
    symbol: String | None
    init: bool
    span: Span
    doc: str = ""


# ------------------------------------------------------------------------------------------------ behaviour
@record
class Step:
    """One step: a codel `rotate`, or a call `send(command)`; `status = ...` binds its result.

    `arguments` is None for a codel.
    """

    target: Name
    arguments: tuple[Name, ...] | None
    result: Name | None
    span: Span


class Role(Enum):
    """When an activity of a state runs (seed 001, III.A.1)."""

    ENTRY = "entry"
    MESSAGE = "message"
    METHOD = "method"
    RUN = "run"
    EXIT = "exit"


@record
class Every:
    """`every 100ms`: the region steps with this period."""

    period: Quantity


@record
class Once:
    """`once, at least 150ms apart`: executed at state entry, with a least separation."""

    apart: Quantity | None


@record
class Activity:
    """`run rotate then status = send(command)`."""

    role: Role
    steps: tuple[Step, ...]
    timing: Every | Once | None
    span: Span


@record
class GuardCodel:
    """A bool codel as a guard."""

    name: Name


@record
class GuardNot:
    """`not g`."""

    operand: Guard
    span: Span


@record
class GuardBinary:
    """`a and b`, `a or b`."""

    is_and: bool
    left: Guard
    right: Guard
    span: Span


Guard = GuardCodel | GuardNot | GuardBinary


@record
class Transition:
    """`-> Reaching on Event when aligned after 500ms do halt emit Done`."""

    target: Name
    event: Name | None
    guard: Guard | None
    after: Quantity | None
    do: tuple[Step, ...]
    emit: tuple[Name, ...]
    span: Span


@record
class StateDecl:
    """`initial state Rotating { ... }`; nested regions make it hierarchical."""

    name: Name
    initial: bool
    final: bool
    activities: tuple[Activity, ...]
    regions: tuple[RegionDecl, ...]
    transitions: tuple[Transition, ...]
    span: Span
    doc: str = ""


@record
class RegionDecl:
    """`region motion { states }`; the states of a behaviour without regions form one region without a name."""

    name: Name | None
    states: tuple[StateDecl, ...]
    span: Span
    doc: str = ""


@record
class HookBinding:
    """`update read` (or several steps joined by `then`) in the use of a lifecycle."""

    hook: Name
    steps: tuple[Step, ...]
    span: Span


@record
class LifecycleUse:
    """`behaviour orocos { configure open  update read }`."""

    lifecycle: Path
    hooks: tuple[HookBinding, ...]
    span: Span


@record
class Machine:
    """`behaviour { ... }` with states or regions of its own."""

    regions: tuple[RegionDecl, ...]
    span: Span


@record
class LifecycleDecl:
    """`lifecycle orocos { hook configure, start  state ... }`: a behaviour whose steps are hooks."""

    name: Name
    hooks: tuple[Name, ...]
    regions: tuple[RegionDecl, ...]
    span: Span
    doc: str = ""


ComponentMember = PortDecl | PropertyDecl | VarDecl | EventDecl | OperationDecl | MethodDecl | CodelDecl


@record
class ComponentDecl:
    """`component`, `passive component` or `external component`.

    More than one behaviour is reported, the first is kept.
    """

    name: Name
    kind: ComponentKind
    members: tuple[ComponentMember, ...]
    behaviour: LifecycleUse | Machine | None
    span: Span
    doc: str = ""


# ------------------------------------------------------------------------------------------------ architecture
class Execution(Enum):
    """Execution attributes of instances and threads."""

    PERIOD = "period"
    SPORADIC = "sporadic"
    DEADLINE = "deadline"
    OFFSET = "offset"
    JITTER = "jitter"
    PRIORITY = "priority"


@record
class ExecutionAttribute:
    """`period 10ms`, `priority 20` (the value of a priority is a Number)."""

    kind: Execution
    value: Quantity | Number
    span: Span


@record
class Assignment:
    """`gps_weight = 0.25`."""

    name: Name
    value: Value
    span: Span


@record
class InstanceDecl:
    """`instance fusion: StateFusion { period 10ms }`."""

    name: Name
    component: Path
    attributes: tuple[ExecutionAttribute, ...]
    assignments: tuple[Assignment, ...]
    span: Span
    doc: str = ""


class Overflow(Enum):
    """What a full buffer does."""

    DROP_OLDEST = "drop oldest"
    DROP_NEWEST = "drop newest"


@record
class Policy:
    """`buffered size 16 drop oldest initial { yaw: 0.0 }`."""

    buffered: bool
    size: Number | None
    overflow: Overflow | None
    initial: Value | None
    span: Span


@record
class ConnectDecl:
    """`connect nav.nav -> pilot.nav, avoider.nav buffered size 4`, ports or method -> operation."""

    source: Path
    targets: tuple[Path, ...]
    policy: Policy | None
    span: Span


@record
class ExternalDecl:
    """`external command.target`: written outside the model."""

    ports: tuple[Path, ...]
    span: Span


@record
class ArchitectureDecl:
    """Instances and their connections."""

    name: Name
    instances: tuple[InstanceDecl, ...]
    connections: tuple[ConnectDecl, ...]
    externals: tuple[ExternalDecl, ...]
    span: Span
    doc: str = ""


# ------------------------------------------------------------------------------------------------ boards
@record
class CpuItem:
    """`cpu "arm926ej-s" at 200MHz`."""

    core: String
    frequency: Quantity
    span: Span


@record
class FeatureItem:
    """A hardware mechanism: `icache off`, `dcache 16KiB 4-way line 32B`, `mmu off`, `prefetch on`.

    `name` is icache, dcache, mmu or prefetch; `settings` is what follows, word by word.
    """

    name: str
    off: bool
    settings: tuple[str, ...]
    span: Span


@record
class MemoryItem:
    """`memory sram at 0x00200000 size 64KiB wait 1cycles`, optionally `write wait 2cycles`."""

    name: Name
    start: Number | None
    size: Quantity
    wait: Quantity
    write_wait: Quantity | None
    span: Span


@record
class OsItem:
    """`os xenomai { context_switch 8us  tick every 1ms cost 5us }`."""

    name: Name
    context_switch: Quantity | None
    tick_every: Quantity | None
    tick_cost: Quantity | None
    span: Span


@record
class BoardDecl:
    """A processor, its memories and its operating system's overheads."""

    name: Name
    cpus: tuple[CpuItem, ...]
    features: tuple[FeatureItem, ...]
    memories: tuple[MemoryItem, ...]
    systems: tuple[OsItem, ...]
    span: Span
    doc: str = ""


# ------------------------------------------------------------------------------------------------ deployments
@record
class SymbolBinding:
    """`StateFusion.fuse = "statefusion_update"`."""

    codel: Path
    symbol: String
    span: Span


@record
class LoopFactDecl:
    """`loop "fusion.c:41" max 6`, `loop 0x8a34 max 7`, `loop "symbol"+0x10 max 3 total 20`.

    `place` is a string with a colon and a line number, a symbol (with `offset`), or an address.
    """

    place: String | Number
    offset: Number | None
    maximum: Number | None
    total: Number | None
    span: Span


@record
class FactsFile:
    """`facts "robot.ff"`: an OTAWA flow fact file, relative to the model's file."""

    path: String
    span: Span


@record
class BinaryDecl:
    """`binary "ttrk.elf" { ... }`, relative to the model's file."""

    path: String
    symbols: tuple[SymbolBinding, ...]
    loops: tuple[LoopFactDecl, ...]
    facts: tuple[FactsFile, ...]
    span: Span


@record
class AssumeDecl:
    """`assume Command.rotate, Command.reach wcet 580us`; `targets` is empty for `assume others`."""

    targets: tuple[Path, ...]
    wcet: Quantity
    span: Span


@record
class InterruptDecl:
    """`interrupt uart every 87us wcet 3us` or `... symbol "uart_isr"`: above every priority."""

    name: Name
    every: Quantity
    wcet: Quantity | None
    symbol: String | None
    span: Span


@record
class ScheduleDecl:
    """`schedule fixed_priority preemptive`, `schedule rate_monotonic`."""

    policy: Name
    preemptive: bool
    span: Span


@record
class LockDecl:
    """`lock immediate_ceiling`."""

    protocol: Name
    span: Span


@record
class ExchangeDecl:
    """`exchange ports 2ms`, `exchange spooler.ports 9ms`: the cost of a port exchange."""

    target: Path
    cost: Quantity
    span: Span


@record
class ThreadDecl:
    """`thread ms1 { spooler.spooler  spooler.motion }`: instances or regions that one thread executes."""

    name: Name
    attributes: tuple[ExecutionAttribute, ...]
    members: tuple[Path, ...]
    span: Span


@record
class ProcessDecl:
    """`process control { ... }` in a node.

    At the top of an extending deployment its `name` is a path `node.process`.
    """

    name: Path
    threads: tuple[ThreadDecl, ...]
    schedules: tuple[ScheduleDecl, ...]
    locks: tuple[LockDecl, ...]
    exchanges: tuple[ExchangeDecl, ...]
    binaries: tuple[BinaryDecl, ...]
    assumes: tuple[AssumeDecl, ...]
    span: Span


@record
class NodeDecl:
    """`node base on ttrk_arm9 { ... }`; the board is a name, or a string for one of the standard library."""

    name: Name
    board: Path | String
    processes: tuple[ProcessDecl, ...]
    binaries: tuple[BinaryDecl, ...]
    assumes: tuple[AssumeDecl, ...]
    interrupts: tuple[InterruptDecl, ...]
    schedules: tuple[ScheduleDecl, ...]
    span: Span


@record
class DeploymentDecl:
    """`deployment on_robot of TTRK { ... }`, `deployment b extends a { ... }`, `expect unschedulable` inside."""

    name: Name
    abstract: bool
    architecture: Path | None
    extends: Path | None
    nodes: tuple[NodeDecl, ...]
    processes: tuple[ProcessDecl, ...]
    expect_unschedulable: Span | None
    span: Span
    doc: str = ""


Declaration = StructDecl | EnumDecl | ComponentDecl | LifecycleDecl | ArchitectureDecl | BoardDecl | DeploymentDecl


# ------------------------------------------------------------------------------------------------ files
@record
class Import:
    """`import std.lifecycle`, optionally `as life`."""

    path: Path
    alias: Name | None
    span: Span


@record
class Module:
    """One file. `version` is the language version of its first line, None when that line is missing."""

    file: SourceFile
    version: int | None
    package: Path | None
    imports: tuple[Import, ...]
    declarations: tuple[Declaration, ...]
    doc: str = ""
