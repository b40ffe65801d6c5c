"""A mission as the net is built from it: resources, activities with alternatives, and the tree of objectives.

The words are those of the mission paper (sections 3 and 4). All names of resources and activities in a mission are
distinct. Nothing here is checked: `verify` lists what a plan must satisfy for the net to be safe and deterministic.
"""

from __future__ import annotations

from enum import Enum
from typing import TypeAlias

from mauve.records import record


@record
class Hardware:
    """A sensor or actuator; with `may_fail` it can go out of service, with `may_recover` come back."""

    name: str
    may_fail: bool = True
    may_recover: bool = True


@record
class Software:
    """A resource that activities produce; exclusive unless `shared` (then any number of consumers at a time)."""

    name: str
    shared: bool = False


@record
class Alternative:
    """One way to run an activity: the resources it takes, and those it then offers."""

    name: str
    consumes: tuple[str, ...] = ()
    produces: tuple[str, ...] = ()


class OnRecovery(Enum):
    """What an activity does when a resource of a better alternative is available again."""

    KEEP = "keep"
    UPGRADE = "upgrade"


@record
class Activity:
    """Alternatives in falling priority; without choice there is one."""

    name: str
    alternatives: tuple[Alternative, ...]
    on_recovery: OnRecovery = OnRecovery.KEEP

    @property
    def produces(self) -> tuple[str, ...]:
        """All that any alternative offers, in order, each once."""
        return tuple(dict.fromkeys(name for one in self.alternatives for name in one.produces))

    @property
    def consumes(self) -> tuple[str, ...]:
        """All that any alternative takes, in order, each once."""
        return tuple(dict.fromkeys(name for one in self.alternatives for name in one.consumes))


# ------------------------------------------------------------------------------------------- the tree of objectives
@record
class Abort:
    """The enclosing block fails (the default)."""


@record
class Continue:
    """The failure counts as a success."""


@record
class Retry:
    """The step is tried again up to `times` times, then its block fails."""

    times: int


@record
class Recover:
    """`block` runs; then the enclosing block fails, or goes on where `resume`. It fails if `block` fails."""

    block: Sequence
    resume: bool = False


OnFailure: TypeAlias = Abort | Continue | Retry | Recover


@record
class Elementary:
    """An objective that runs activities until it is reached, fails, or times out.

    One objective can stand at several places of a mission: `name` is that of the objective, its place gives it a path.
    """

    name: str
    activities: tuple[str, ...]
    timeout: int | None = None
    """After so many picoseconds it fails; None for never."""


@record
class Sequence:
    """Steps one after the other, each started by the success of the one before (a recursive objective or a block)."""

    name: str
    steps: tuple[Step, ...]


@record
class Parallel:
    """Children started together; it waits for all, and succeeds if the mandatory ones did (section 4.2)."""

    name: str
    children: tuple[Child, ...]


Block: TypeAlias = Elementary | Sequence | Parallel


@record
class Step:
    """A block and what its failure means for the block around it."""

    block: Block
    on_failure: OnFailure = Abort()


@record
class Child:
    """A step of a parallel block."""

    step: Step
    mandatory: bool = True


@record
class Mission:
    """A whole mission, self-contained: only what it uses, directly or through producers, is listed."""

    name: str
    root: Sequence
    activities: tuple[Activity, ...]
    software: tuple[Software, ...]
    hardware: tuple[Hardware, ...]
