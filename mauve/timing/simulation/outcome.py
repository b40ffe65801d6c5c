"""What a simulation saw. Responses are observations: greatest, mean and least of one run, never bounds."""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum
from fractions import Fraction

from mauve.records import record
from mauve.timing.simulation.horizon import Horizon
from mauve.timing.simulation.system import Processor, Settings
from mauve.timing.task import Kind


class Activity(Enum):
    """What a job does in a segment."""

    WAIT = "wait"
    """Off the processor, for an answer of another task; only among the waits of an outcome."""
    WORK = "work"
    SECTION = "section"
    SWITCH = "switch"


@record
class Segment:
    """A stretch of execution of one job without interruption and of one kind; `label` names the work, `resources`
    what is held."""

    task: str
    job: int
    start: int
    end: int
    activity: Activity
    label: str = ""
    resources: tuple[str, ...] = ()


@record
class Job:
    """One job: `number` counts from 1, `deadline` is absolute, `mode` tells the transitions it took.

    `finish` is None where the simulation ended before; `start` where it never ran. `blocked` is how long it waited for
    work of a less urgent task, `cost` how long it has executed, context switches included.
    """

    task: str
    number: int
    arrival: int
    release: int
    deadline: int
    start: int | None
    finish: int | None
    preemptions: int
    blocked: int
    cost: int
    mode: str = ""

    @property
    def response(self) -> int | None:
        """From the nominal arrival to the end."""
        return None if self.finish is None else self.finish - self.arrival

    def missed(self, end: int) -> bool:
        """Whether it was, or at `end` is, beyond its deadline."""
        return (end + 1 if self.finish is None else self.finish) > self.deadline


@record
class Measures:
    """What was seen of one task over the whole simulation.

    `released` jobs, of which `finished` ended; `greatest`, `least` and the sum `total` of their responses; `worst_job`
    (its number) attains the greatest and arrived at `worst_arrival`. `misses` counts the late ones, unfinished ones
    beyond their deadline included; `blocked` is the longest blocking of one job; `busy` the time executed.
    """

    task: str
    kind: Kind
    priority: int
    period: int
    deadline: int
    released: int
    finished: int
    greatest: int | None
    least: int | None
    total: int
    worst_job: int | None
    worst_arrival: int | None
    preemptions: int
    misses: int
    blocked: int
    busy: int

    @property
    def mean(self) -> Fraction | None:
        """The mean response of the jobs that ended."""
        return Fraction(self.total, self.finished) if self.finished else None


@record
class Outcome:
    """One simulated processor, from 0 to `end`. `cut` says that the event budget ended it before `settings.length`.

    `switches` counts how often the processor went from one task to another (idle time in between or not, interrupts
    and ticks aside), `preemptions` how often an unfinished job had to make way for another task's. `jobs` in the order
    of their ends, unfinished ones last, `segments` in time, and `waits`, in which a job has left the processor by
    itself, are those that touch the window.
    """

    processor: Processor
    settings: Settings
    end: int
    cut: bool
    events: int
    tasks: tuple[Measures, ...]
    jobs: tuple[Job, ...]
    segments: tuple[Segment, ...]
    busy: int
    switches: int
    preemptions: int
    waits: tuple[Segment, ...] = ()

    @property
    def idle(self) -> int:
        """The time in which nothing ran."""
        return self.end - self.busy

    @property
    def misses(self) -> int:
        """Deadlines missed, of all tasks."""
        return sum(one.misses for one in self.tasks)

    @property
    def window(self) -> tuple[int, int]:
        """What is shown of it."""
        start, end = self.settings.window or (0, self.end)
        return min(start, self.end), min(end, self.end)

    def measures(self, name: str) -> Measures:
        """What was seen of the task of this name; KeyError if there is none."""
        for one in self.tasks:
            if one.task == name:
                return one
        raise KeyError(name)


@record
class Simulated:
    """The processors of one deployment or task set, simulated side by side. `name` is that of the deployment or of the
    set in `file`; `unit` that of all times. `bounds` are the proven responses per processor and task, for comparison
    (None where there is none); `misses_expected` whether a missed deadline is what the model expects."""

    name: str
    file: str
    unit: str
    outcomes: tuple[Outcome, ...]
    bounds: tuple[Mapping[str, int | None], ...]
    horizon: Horizon
    misses_expected: bool = False

    @property
    def misses(self) -> int:
        """Deadlines missed on all processors."""
        return sum(outcome.misses for outcome in self.outcomes)
