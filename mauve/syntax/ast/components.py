"""Components as written: ports, data, services, codels."""

from __future__ import annotations

from enum import Enum

from mauve.records import record
from mauve.source import Span
from mauve.syntax.ast.behaviour import LifecycleUse, Machine
from mauve.syntax.ast.names import Name, Quantity, String, Value
from mauve.syntax.ast.types import TypeRef


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
