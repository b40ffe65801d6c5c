"""Deployments as written: nodes, binaries, assumed times, threads."""

from __future__ import annotations

from mauve.records import record
from mauve.source import Span
from mauve.syntax.ast.architecture import ExecutionAttribute
from mauve.syntax.ast.names import Name, Number, Path, Quantity, String


@record
class SymbolBinding:
    """`StateFusion.fuse = "statefusion_update"`."""

    codel: Path
    symbol: String
    span: Span


@record
class CodePlace:
    """`"fusion.c:41"`, `"symbol"+0x10` (with `offset`), or an address."""

    base: String | Number
    offset: Number | None
    span: Span


@record
class LoopFactDecl:
    """`loop "fusion.c:41" max 6`, `loop 0x8a34 max 7`, `loop "symbol"+0x10 max 3 total 20`.

    A limit that is still a `?` has the text `?`.
    """

    place: CodePlace
    maximum: Number | None
    total: Number | None
    span: Span


@record
class RecursionFactDecl:
    """`recursion "walk" max 8`: how many activations are under way at once."""

    place: CodePlace
    maximum: Number | None
    span: Span


@record
class AssumedRangeDecl:
    """`assume "sum" argument 2 from 0 to 64`, `assume "offsets" each 2B from -5 to 5`, `assume "buffer" any`,
    `assume "parse" argument 1 ends within 80B`.

    `low` and `high` are both None for `any` and for `ends within`.
    """

    place: CodePlace
    argument: Number | None
    width: Quantity | None
    low: Number | None
    high: Number | None
    ends: Quantity | None
    span: Span


@record
class ControlFactDecl:
    """`targets "dispatch"+0x14 to "read", "write"`; `noreturn "panic"`, without targets."""

    word: str
    place: CodePlace
    targets: tuple[CodePlace, ...]
    span: Span


@record
class FactsFile:
    """`facts "robot.ff"`: an OTAWA flow fact file, relative to the model's file."""

    path: String
    span: Span


@record
class BinaryDecl:
    """`binary "ttrk.elf" { ... }`, relative to the model's file; outside of a deployment it only holds flow facts."""

    path: String
    symbols: tuple[SymbolBinding, ...]
    loops: tuple[LoopFactDecl, ...]
    recursions: tuple[RecursionFactDecl, ...]
    ranges: tuple[AssumedRangeDecl, ...]
    control: tuple[ControlFactDecl, ...]
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
