"""Missions, resolved: names bound, alternatives in order, objectives spread out into one tree. The input of
`lower.mission`, which turns them into plans. Times are picoseconds; every object keeps its span.
"""

from __future__ import annotations

from enum import Enum

from mauve.model.model import Component, Setting
from mauve.model.types import Type
from mauve.records import record
from mauve.source import Span
from mauve.syntax.ast.missions import ClaimKind, Infix, Prefix

__all__ = ["ClaimKind", "Infix", "Prefix"]


@record
class Ref:
    """A name with the place where it is written."""

    name: str
    span: Span


# ------------------------------------------------------------------------------------------------ resources
@record
class Hardware:
    """A device."""

    name: str
    may_fail: bool
    may_recover: bool
    span: Span


@record
class Software:
    """A resource that activities produce; data flow from the consumers to the producer where it is a `sink`."""

    name: str
    type: Type | None
    shared: bool
    sink: bool
    span: Span


Resource = Hardware | Software


# ------------------------------------------------------------------------------------------------ activities
@record
class Mode:
    """The mode an alternative asks of its component: the state of one of its regions (`region` is the path of its
    names), where one is written."""

    name: str
    region: tuple[str, ...]
    state: str
    span: Span


@record
class Alternative:
    """One way to run an activity, with what belongs to all of them included. `name` is empty for the only way."""

    name: str
    consumes: tuple[Ref, ...]
    produces: tuple[Ref, ...]
    mode: Mode | None
    span: Span

    @property
    def needs(self) -> frozenset[str]:
        """The names of what it consumes."""
        return frozenset(ref.name for ref in self.consumes)

    @property
    def offers(self) -> frozenset[str]:
        """The names of what it produces."""
        return frozenset(ref.name for ref in self.produces)


@record
class Runs:
    """What carries an activity out: a component, and the instance where one is named. `component` is None where the
    model has no architecture part."""

    name: str
    component: Component | None
    instance: str
    span: Span


@record
class Activity:
    """Alternatives in falling priority; at least one."""

    name: str
    alternatives: tuple[Alternative, ...]
    upgrade: bool
    runs: Runs | None
    span: Span

    @property
    def needs(self) -> tuple[str, ...]:
        """All that any alternative consumes, each once."""
        return tuple(dict.fromkeys(ref.name for one in self.alternatives for ref in one.consumes))

    @property
    def offers(self) -> tuple[str, ...]:
        """All that any alternative produces, each once."""
        return tuple(dict.fromkeys(ref.name for one in self.alternatives for ref in one.produces))


# ------------------------------------------------------------------------------------------------ objectives
@record
class Abort:
    """The block around fails."""

    span: Span | None = None


@record
class Continue:
    """The failure counts as a success."""

    span: Span


@record
class Retry:
    """The step is tried again at most `times` times."""

    times: int
    span: Span


@record
class Recover:
    """The block is executed; then the block around fails, or goes on where `resume`."""

    block: Sequence
    resume: bool
    span: Span


OnFailure = Abort | Continue | Retry | Recover


@record
class Elementary:
    """An objective that does activities."""

    name: str
    activities: tuple[Ref, ...]
    timeout: int | None
    span: Span


@record
class Step:
    """A block and what its failure means."""

    block: Block
    on_failure: OnFailure
    span: Span


@record
class Sequence:
    """Steps one after the other."""

    name: str
    steps: tuple[Step, ...]
    span: Span


@record
class Child:
    """A step of a parallel block."""

    step: Step
    mandatory: bool


@record
class Parallel:
    """Children started together."""

    name: str
    children: tuple[Child, ...]
    span: Span


Block = Elementary | Sequence | Parallel


# ------------------------------------------------------------------------------------------------ formulas
class Atom(Enum):
    """What a formula asks of a state."""

    RUNNING = "running"
    OUT_OF_SERVICE = "out_of_service"
    ACTIVE = "active"
    SUCCESS = "success"
    FAILURE = "failure"
    TRUE = "true"
    FALSE = "false"


@record
class Holds:
    """An atom; `name` is an activity, hardware or an objective, `alternative` one of the activity or empty."""

    atom: Atom
    name: str = ""
    alternative: str = ""


@record
class Before:
    """An operator before its operand."""

    operator: Prefix
    operand: Formula


@record
class Between:
    """An operator between its operands."""

    left: Formula
    operator: Infix
    right: Formula


Formula = Holds | Before | Between


# ------------------------------------------------------------------------------------------------ missions
@record
class Claim:
    """A property that the mission is checked for; `lost` and `among` belong to `success reachable`."""

    kind: ClaimKind
    lost: int | None
    among: tuple[str, ...]
    span: Span


@record
class Ltl:
    """A formula that every run must satisfy."""

    name: str
    formula: Formula
    span: Span


@record
class Controller:
    """The controller asked for, and its task: an instance, or attributes of a task of its own (all None: none)."""

    instance: Ref | None
    period: Setting | None
    sporadic: bool
    priority: Setting | None
    deadline: Setting | None
    wcet: int | None
    span: Span


@record
class Mission:
    """A mission with all that it uses, directly or through producers, in the order of declaration. `others` are the
    activities of the model that it does not use, and that never run in it."""

    name: str
    root: Sequence
    activities: tuple[Activity, ...]
    software: tuple[Software, ...]
    hardware: tuple[Hardware, ...]
    claims: tuple[Claim, ...]
    formulas: tuple[Ltl, ...]
    report_cuts: Span | None
    controller: Controller | None
    accepts: tuple[Ref, ...]
    span: Span
    others: tuple[Activity, ...] = ()

    def activity(self, name: str) -> Activity:
        """An activity by its name."""
        return next(activity for activity in self.activities if activity.name == name)

    def producer(self, resource: str) -> Activity | None:
        """The activity that produces a resource; None for hardware."""
        return next((activity for activity in self.activities if resource in activity.offers), None)


@record
class MissionPart:
    """All resources and activities of a model, each by its name, and its missions."""

    hardware: tuple[Hardware, ...] = ()
    software: tuple[Software, ...] = ()
    activities: tuple[Activity, ...] = ()
    missions: tuple[Mission, ...] = ()
