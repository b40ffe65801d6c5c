"""Missions as written: resources, activities with alternatives, objectives, missions and what they ask for."""

from __future__ import annotations

from enum import Enum

from mauve.records import record
from mauve.source import Span
from mauve.syntax.ast.architecture import ExecutionAttribute
from mauve.syntax.ast.names import Name, Number, Path, Quantity
from mauve.syntax.ast.types import TypeRef


# ------------------------------------------------------------------------------------------------ resources
@record
class HardwareDecl:
    """`hardware GPS_sensor: gps may fail, may recover`; the type is a kind of device, a word of the user."""

    name: Name
    type: TypeRef | None
    may_fail: bool
    may_recover: bool
    span: Span
    doc: str = ""


class Sharing(Enum):
    """How many consumers a resource has at a time, or, for a sink, that data flow from them to the producer."""

    EXCLUSIVE = "exclusive"
    SHARED = "shared"
    SINK = "sink"


@record
class ResourceDecl:
    """`resource location: Pose shared`. `may` is where `may fail` is written, which only hardware does."""

    name: Name
    type: TypeRef | None
    sharing: tuple[Sharing, ...]
    may: Span | None
    span: Span
    doc: str = ""


# ------------------------------------------------------------------------------------------------ activities
@record
class ModeDecl:
    """`mode gps`, `mode gps = state Fusing`: the name of a mode, and the state of the component it is."""

    name: Name
    state: Path | None
    span: Span


@record
class AlternativeDecl:
    """`alternative gps priority 2 { consumes gps_position  mode gps }`."""

    name: Name
    priority: Number | None
    consumes: tuple[Name, ...]
    produces: tuple[Name, ...]
    mode: ModeDecl | None
    span: Span
    doc: str = ""


@record
class ActivityDecl:
    """`activity localisation { ... }`. `upgrade` is None where `on recovery` is not written."""

    name: Name
    consumes: tuple[Name, ...]
    produces: tuple[Name, ...]
    runs: Path | None
    mode: ModeDecl | None
    alternatives: tuple[AlternativeDecl, ...]
    upgrade: bool | None
    span: Span
    doc: str = ""


# ------------------------------------------------------------------------------------------------ objectives
@record
class AbortDecl:
    """`on failure abort`."""

    span: Span


@record
class ContinueDecl:
    """`on failure continue`."""

    span: Span


@record
class RetryDecl:
    """`on failure retry 2`."""

    times: Number
    span: Span


@record
class RecoverDecl:
    """`on failure recover { GoingUp } abort`, or `continue` after it (`resume`)."""

    block: SequenceDecl
    resume: bool
    span: Span


OnFailureDecl = AbortDecl | ContinueDecl | RetryDecl | RecoverDecl


@record
class DoesDecl:
    """`does diving, filming timeout 5min -> failure`."""

    activities: tuple[Name, ...]
    timeout: Quantity | None
    span: Span


@record
class UseDecl:
    """An objective named in a block."""

    name: Name
    span: Span


@record
class ChildDecl:
    """`mandatory Filming`, `optional Temperature`, each perhaps with `on failure`."""

    mandatory: bool
    stage: StageDecl
    span: Span


@record
class ParallelDecl:
    """`parallel Survey { mandatory Filming  optional Temperature }`; the name may be left out."""

    name: Name | None
    children: tuple[ChildDecl, ...]
    span: Span


@record
class StageDecl:
    """A step of a block, and what its failure means."""

    body: UseDecl | ParallelDecl
    on_failure: OnFailureDecl | None
    span: Span


@record
class SequenceDecl:
    """Steps joined by `;`."""

    stages: tuple[StageDecl, ...]
    span: Span


@record
class ObjectiveDecl:
    """`objective Diving { does diving }`, or with a block; `body` is None where the braces are empty."""

    name: Name
    body: DoesDecl | SequenceDecl | None
    span: Span
    doc: str = ""


# ------------------------------------------------------------------------------------------------ formulas
class Prefix(Enum):
    """Operators before a formula."""

    NOT = "not"
    ALWAYS = "always"
    EVENTUALLY = "eventually"
    NEXT = "next"


class Infix(Enum):
    """Operators between formulas."""

    AND = "and"
    OR = "or"
    IMPLIES = "implies"
    UNTIL = "until"
    UNLESS = "unless"
    RELEASE = "release"


class AtomKind(Enum):
    """What a formula may ask of a state."""

    RUNNING = "running"
    OUT_OF_SERVICE = "out_of_service"
    ACTIVE = "active"
    SUCCESS = "success"
    FAILURE = "failure"
    TRUE = "true"
    FALSE = "false"


@record
class FormulaAtom:
    """`running(localisation.gps)`, `success`; `path` names an activity, a resource or an objective."""

    kind: AtomKind
    path: Path | None
    span: Span


@record
class FormulaPrefix:
    """`always f`."""

    operator: Prefix
    operand: FormulaDecl
    span: Span


@record
class FormulaInfix:
    """`f implies g`."""

    operator: Infix
    left: FormulaDecl
    right: FormulaDecl
    span: Span


FormulaDecl = FormulaAtom | FormulaPrefix | FormulaInfix


# ------------------------------------------------------------------------------------------------ missions
class ClaimKind(Enum):
    """What `check` can ask for, beside formulas."""

    LIVE = "live"
    BOUNDED = "bounded"
    DETERMINISTIC = "deterministic"
    SUCCESS_REACHABLE = "success_reachable"


@record
class LossDecl:
    """`with at most 1 of A, B out of service`; no names mean any hardware."""

    most: Number
    among: tuple[Name, ...]
    span: Span


@record
class ClaimDecl:
    """`live`, `success reachable with at most 1 of A, B out of service`."""

    kind: ClaimKind
    loss: LossDecl | None
    span: Span


@record
class LtlDecl:
    """`check ltl no_blind_drive: always ...`; the formula is None where it was refused."""

    name: Name
    formula: FormulaDecl | None
    span: Span


@record
class ControllerDecl:
    """`generate controller runs supervisor`, or with a task of its own: `{ period 10ms priority 5 wcet 200us }`."""

    runs: Path | None
    attributes: tuple[ExecutionAttribute, ...]
    wcet: Quantity | None
    span: Span


@record
class AcceptsDecl:
    """`accepts single failure of Thruster`."""

    resources: tuple[Name, ...]
    span: Span


@record
class MissionDecl:
    """`mission Coral { block  check ...  report cuts  generate controller }`; `steps` is None without a block."""

    name: Name
    steps: SequenceDecl | None
    claims: tuple[ClaimDecl, ...]
    formulas: tuple[LtlDecl, ...]
    report_cuts: Span | None
    controller: ControllerDecl | None
    accepts: tuple[AcceptsDecl, ...]
    span: Span
    doc: str = ""


MissionPart = HardwareDecl | ResourceDecl | ActivityDecl | ObjectiveDecl | MissionDecl
