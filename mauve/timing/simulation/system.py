"""What is simulated: the tasks of one processor with their critical sections, and the settings of a run.

Times are integers in one unit (picoseconds in mauvec). The tasks are those of the analysis, platform included
(`on_platform`), so that both speak of the same system: a job pays its `overhead`, half of it (rounded up) before its
work and half after it. A task's `blocking` is a result of the sections of others, so it is not used here.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from math import lcm

from mauve.records import record
from mauve.timing.suspension import CarryInCurve
from mauve.timing.task import Task


@record
class Hold:
    """A stay in a critical section: `length` units of execution while all of `resources` are held; with `above_all`
    nothing but interrupts preempts it. Without either it is a stretch outside of sections."""

    resources: tuple[str, ...]
    length: int
    above_all: bool = False


@record
class Locked:
    """Work of this label (that of a transition's part, or a workload's name) starts with these sections, in order, once
    for each time that it is counted."""

    label: str
    holds: tuple[Hold, ...]


@record
class SimTask:
    """A task and where its jobs hold resources; `simulated` makes one from the sections of a task.

    `locked` says it by the label of the work. `holds` lie at the start of each job's work, as far as the job is long
    enough, or, where runs are random, anywhere in this order. One of length 0 only says that the task uses the
    resource, which raises its ceiling. A `sporadic` task may arrive later than its period says. `waits` are the parts
    of its work, by label, at which a job leaves the processor, each with the time that it does so at most.
    """

    task: Task
    holds: tuple[Hold, ...] = ()
    locked: tuple[Locked, ...] = ()
    sporadic: bool = False
    waits: tuple[tuple[str, int], ...] = ()

    def uses(self) -> set[str]:
        """The resources that it holds in some section."""
        inner = [hold for part in self.locked for hold in part.holds]
        return {resource for hold in (*self.holds, *inner) for resource in hold.resources}


def simulated(task: Task, sporadic: bool = False) -> SimTask:
    """A task that holds what its sections say: those with a label in the work of that label, others anywhere."""
    labels = dict.fromkeys(section.label for section in task.sections if section.label)
    locked = tuple(Locked(label, _holds(task, label)) for label in labels)
    return SimTask(executed(task), _holds(task, ""), locked, sporadic)


def executed(task: Task) -> Task:
    """What a task executes: of one that suspends itself (`suspension.py`), the work without the waits."""
    curve = task.outside.work[0].curve if task.outside is not None and task.outside.work else None
    return curve.task if isinstance(curve, CarryInCurve) else task


def _holds(task: Task, label: str) -> tuple[Hold, ...]:
    """The sections of a label; those of one length are one stay, as they come from one piece of work."""
    sections = [section for section in task.sections if section.label == label]
    if not label:
        return tuple(Hold((one.resource,), one.length, one.above_all) for one in sections)
    found: dict[tuple[int, bool], list[str]] = {}
    for one in sections:
        found.setdefault((one.length, one.above_all), []).append(one.resource)
    return tuple(Hold(tuple(names), length, above) for (length, above), names in found.items())


@record
class Processor:
    """The tasks that share one processor. ValueError if two have one name."""

    name: str
    tasks: tuple[SimTask, ...]

    def __post_init__(self) -> None:
        if len({one.task.name for one in self.tasks}) != len(self.tasks):
            raise ValueError("two tasks have one name")

    def ceilings(self) -> dict[str, int]:
        """Per resource the greatest priority among the tasks that use it."""
        found: dict[str, int] = {}
        for one in self.tasks:
            for resource in one.uses():
                found[resource] = max(found.get(resource, one.task.priority), one.task.priority)
        return found


class Offsets(Enum):
    """When the tasks start: all releases at 0 (the critical instant of independent tasks), or each at random."""

    SYNCHRONOUS = "synchronous"
    RANDOM = "random"


class Runs(Enum):
    """Which transitions the machines take."""

    WORST = "worst"
    """Stretches of the dearest runs there are, each as long as the busy period (the witness of E(l))."""
    RANDOM = "random"
    """Any transition, from any state that can be reached."""
    FIRST = "first"
    """From the initial state, always the first transition."""


class Jitter(Enum):
    """How long after its arrival a job is released."""

    WORST = "worst"
    """All that may wait is released at the start, what follows without delay: the critical instant of the analysis."""
    RANDOM = "random"
    NONE = "none"


class Arrivals(Enum):
    """How far apart the jobs of sporadic tasks arrive."""

    PERIODIC = "periodic"
    SPORADIC = "sporadic"


class Execution(Enum):
    """How much of its greatest cost a piece of work takes."""

    WORST = "worst"
    RANDOM = "random"


class Order(Enum):
    """Who goes first among equal priorities."""

    FIFO = "fifo"
    """The one released first; a running job is not preempted by an equal."""
    DECLARED = "declared"
    NAME = "name"
    RANDOM = "random"
    """A new choice at each dispatch, also against the running job."""


class Protocol(Enum):
    """What a critical section does to the priority of its holder."""

    CEILING = "ceiling"
    """Immediate ceiling: raised when the section is entered."""
    EAGER = "eager"
    """Competes at the ceiling already when ready to enter: what reproduces the simulated table III of C-Forge."""
    NONE = "none"
    """Sections are ignored: only priorities count."""


@record
class Settings:
    """How to run: `length` is simulated from 0 on, at most `events` events; jobs and segments are kept where they
    touch `window` (None: the whole)."""

    length: int
    seed: int = 0
    offsets: Offsets = Offsets.SYNCHRONOUS
    runs: Runs = Runs.WORST
    jitter: Jitter = Jitter.WORST
    arrivals: Arrivals = Arrivals.PERIODIC
    execution: Execution = Execution.WORST
    order: Order = Order.FIFO
    protocol: Protocol = Protocol.CEILING
    window: tuple[int, int] | None = None
    events: int = 1_000_000


def hyperperiod(tasks: Sequence[Task]) -> int:
    """The time after which the arrivals repeat: the least common multiple of all periods; 1 without tasks."""
    return lcm(*(task.period for task in tasks), *(part.period for task in tasks for part in task.work if part.period))
