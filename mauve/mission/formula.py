"""Properties asked of a mission, and linear temporal logic over its stable states."""

from __future__ import annotations

from enum import Enum
from typing import TypeAlias

from mauve.records import record


@record
class Running:
    """The activity runs, with this alternative where one is named."""

    activity: str
    alternative: str | None = None


@record
class OutOfService:
    """The hardware resource is out of service."""

    resource: str


@record
class Active:
    """The objective (elementary, recursive, or a parallel block) is being pursued, at any of its places."""

    objective: str


@record
class Success:
    """The mission has succeeded."""


@record
class Failure:
    """The mission has failed."""


@record
class Truth:
    """True or false."""

    value: bool


class Unary(Enum):
    """Operators of one operand."""

    NOT = "not"
    ALWAYS = "always"
    EVENTUALLY = "eventually"
    NEXT = "next"


class Binary(Enum):
    """Operators of two operands; `unless` is the weak until."""

    AND = "and"
    OR = "or"
    IMPLIES = "implies"
    UNTIL = "until"
    UNLESS = "unless"
    RELEASE = "release"


@record
class Prefix:
    """An operator before its operand."""

    operator: Unary
    operand: Formula


@record
class Infix:
    """An operator between its operands."""

    left: Formula
    operator: Binary
    right: Formula


Formula: TypeAlias = Running | OutOfService | Active | Success | Failure | Truth | Prefix | Infix


# --------------------------------------------------------------------------------------------------------- properties
@record
class Bounded:
    """No place ever holds two tokens."""


@record
class Deterministic:
    """Each event leads to one stable state, whatever the order of what follows it (confluence)."""


@record
class Live:
    """From each reachable state some event of the mission itself can still happen, at once or after recoveries."""


@record
class SuccessReachable:
    """Success can be reached: from the start, or with at most `lost` of `among` ever out of service (None: any)."""

    lost: int | None = None
    among: tuple[str, ...] = ()


@record
class Ltl:
    """All runs satisfy the formula."""

    name: str
    formula: Formula


Property: TypeAlias = Bounded | Deterministic | Live | SuccessReachable | Ltl


@record
class Verdict:
    """The answer to one property: `holds` is None where a budget ended first; the witness is a sequence of events."""

    name: str
    holds: bool | None
    witness: tuple[str, ...] = ()
    note: str = ""
