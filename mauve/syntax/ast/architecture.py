"""Architectures as written: instances and connections."""

from __future__ import annotations

from enum import Enum

from mauve.records import record
from mauve.source import Span
from mauve.syntax.ast.names import Name, Number, Path, Quantity, Value


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


class Latency(Enum):
    """Which latency of a flow a bound is for."""

    BOTH = "both"
    AGE = "age"
    REACTION = "reaction"


@record
class FlowDecl:
    """`flow brake: lidar.scan -> ... -> wheels.stop within 40ms`. A point that is None stands for `...`."""

    name: Name
    points: tuple[Path | None, ...]
    within: Quantity | None
    latency: Latency
    span: Span
    doc: str = ""


@record
class ArchitectureDecl:
    """Instances, their connections, and flows along them."""

    name: Name
    instances: tuple[InstanceDecl, ...]
    connections: tuple[ConnectDecl, ...]
    externals: tuple[ExternalDecl, ...]
    span: Span
    doc: str = ""
    flows: tuple[FlowDecl, ...] = ()
