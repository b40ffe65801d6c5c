"""State machines and lifecycles as written: steps, activities, guards, transitions, states, regions."""

from __future__ import annotations

from enum import Enum

from mauve.records import record
from mauve.source import Span
from mauve.syntax.ast.names import Name, Path, Quantity


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
