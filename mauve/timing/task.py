"""Tasks: what the response-time analysis needs to know of a component, and what the platform adds to it.

Times are integers in one unit (picoseconds in mauvec). A larger priority number is more urgent; tasks of equal priority
delay each other both ways.
"""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum
from fractions import Fraction

from mauve.records import changed, record
from mauve.timing.psm import Psm
from mauve.timing.traces import ConstantCurve, Curve, FramesCurve, PsmCurve, TableCurve


class Kind(Enum):
    """What a task stands for: only a TASK gets a verdict, the others only interfere."""

    TASK = "task"
    INTERRUPT = "interrupt"
    TICK = "tick"


@record
class Workload:
    """One part of a task's work: a PSM, a constant, frames or a table as a workload curve.

    With a `period` of its own, a multiple of its task's, it runs in one of period / task period jobs (an orthogonal
    region of the C-Forge paper); 0 means in every job.
    """

    name: str
    curve: Curve
    period: int = 0


def constant(name: str, cost: int, period: int = 0) -> Workload:
    """Work that costs the same at each activation."""
    return Workload(name, ConstantCurve(cost), period)


def frames(name: str, costs: Sequence[int], period: int = 0) -> Workload:
    """Work that cycles through these costs, from an unknown start (multiframe)."""
    return Workload(name, FramesCurve(costs), period)


def table(name: str, totals: Sequence[int], period: int = 0) -> Workload:
    """Work of which the greatest cost of 1, 2, .. n consecutive activations is given."""
    return Workload(name, TableCurve(totals), period)


def machine(psm: Psm, period: int = 0) -> Workload:
    """The work of a PSM, one transition at each activation."""
    return Workload(psm.name, PsmCurve(psm), period)


@record
class Section:
    """A stay of `holder` in the critical section of `resource`: `length` units of time at most. `what` it does there,
    in words; `label` the part of its transitions whose cost the length is, where it is one; `above_all`: nothing but
    interrupts preempts it."""

    resource: str
    holder: str
    what: str
    length: int
    label: str = ""
    above_all: bool = False


@record
class Task:
    """A task of a fixed-priority schedule on one processor.

    period: (least) separation of arrivals; deadline: from the nominal arrival; jitter: greatest delay from the nominal
    arrival to the release; blocking: longest delay by less urgent tasks, beyond what their sections cause; overhead:
    added to each job (context switches, see `on_platform`), not part of `work`; sections: where it holds resources
    (`blocking.py`). A task that is not `preemptive` runs its jobs to their end once they have started; one with a
    `tail` only the last part of each, of at most that length. Several workloads add up; they are never multiplied into
    one machine. `outside` is what the task is to others, where that is not what it is to itself: one that suspends
    itself counts its waits as work of its own, and delays others otherwise (`suspension.py`). Raises ValueError on
    values that no task can have.
    """

    name: str
    priority: int
    period: int
    deadline: int
    work: tuple[Workload, ...]
    jitter: int = 0
    blocking: int = 0
    overhead: int = 0
    kind: Kind = Kind.TASK
    sections: tuple[Section, ...] = ()
    preemptive: bool = True
    tail: int = 0
    outside: Task | None = None

    def __post_init__(self) -> None:
        if self.period <= 0 or self.deadline <= 0:
            raise ValueError(f"{self.name}: a period and a deadline are positive")
        if self.jitter < 0 or self.blocking < 0 or self.overhead < 0 or self.tail < 0:
            raise ValueError(f"{self.name}: jitter, blocking, overhead and the last section are not negative")
        for part in self.work:
            if part.period % self.period != 0:
                raise ValueError(f"{self.name}: the period of {part.name} is not a multiple of the task's")

    @property
    def interferer(self) -> Task:
        """The task as those see it that it delays."""
        return self if self.outside is None else self.outside

    def activations(self, part: Workload, jobs: int) -> int:
        """How often `part` of its work runs at most in so many consecutive jobs."""
        return -(-jobs * self.period // part.period) if part.period else jobs

    def demand(self, jobs: int) -> int:
        """E(jobs): the greatest total cost of so many consecutive jobs, overhead included."""
        total = jobs * self.overhead
        for part in self.work:
            total += part.curve.total(jobs if not part.period else self.activations(part, jobs))
        return total

    @property
    def load(self) -> Fraction:
        """The part of the processor it needs in the long run: the mean cost of its jobs / period, overhead included."""
        return sum(
            (part.curve.mean / (part.period or self.period) for part in self.work),
            Fraction(self.overhead, self.period),
        )

    def trace(self, length: int) -> tuple[int, ...]:
        """e_1 .. e_length of the whole task, overhead included (equations (9) and (10))."""
        totals = [self.demand(jobs) for jobs in range(length + 1)]
        return tuple(totals[n + 1] - totals[n] for n in range(length))


def total_load(tasks: Sequence[Task]) -> Fraction:
    """The sum of the loads; above 1 not every task can keep up."""
    return sum((task.load for task in tasks), Fraction(0))


def trace_length(task: Task, tasks: Sequence[Task]) -> int:
    """k_i = ceil(max D_j / T_i): the number of activations the paper looks at (section III.C.3)."""
    return -(-max(other.deadline for other in tasks) // task.period)


@record
class Interrupt:
    """An interrupt handler or system tick: at most one arrival per `period`, `cost` each with entry and exit."""

    name: str
    period: int
    cost: int
    kind: Kind = Kind.INTERRUPT


@record
class Platform:
    """What the operating system adds: the cost of one context switch, ticks and interrupts."""

    context_switch: int = 0
    interrupts: tuple[Interrupt, ...] = ()


def on_platform(tasks: Sequence[Task], platform: Platform) -> tuple[Task, ...]:
    """The tasks as they run on a platform.

    Each job of each task pays two context switches (one to it, one back) in its `overhead`, so its work and its bill
    stay apart. Interrupts and ticks become tasks above all priorities, without context switches of their own.
    """
    switched = [changed(task, overhead=task.overhead + 2 * platform.context_switch) for task in tasks]
    top = max((task.priority for task in tasks), default=0) + 1
    above = [
        Task(one.name, top, one.period, one.period, (constant(one.name, one.cost),), kind=one.kind)
        for one in platform.interrupts
    ]
    return (*above, *switched)
