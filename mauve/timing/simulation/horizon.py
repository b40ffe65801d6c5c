"""How long to simulate: as asked, or the hyperperiod where that is within reach."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from mauve.records import changed, record
from mauve.timing.simulation.system import Processor, Settings, hyperperiod
from mauve.timing.task import Task

JOBS = 10_000
"""Unless another length is asked for, so many jobs at most."""

LAPS = 8
"""Hyperperiods to go on at most until work that is late has ended."""

MOST_JOBS = 400_000
"""A hyperperiod that is asked for is cut after so many jobs."""


BUSY_STEPS = 200
"""Evaluations spent on the length of the busy period, for which worst runs are planned."""


@record
class Asked:
    """What was asked for: a length, or the whole hyperperiod (neither: what is within reach), and what to show of it
    (None: from the start, to the end)."""

    length: int | None = None
    whole: bool = False
    start: int | None = None
    end: int | None = None


@record
class Horizon:
    """A length to simulate; `whole` says that it is at least the `hyperperiod`."""

    length: int
    hyperperiod: int

    @property
    def whole(self) -> bool:
        """Whether arrivals have repeated by then."""
        return self.length >= self.hyperperiod


def horizon(processors: Sequence[Processor], asked: Asked) -> Horizon:
    """The length asked for; else the hyperperiod of all processors, cut after some number of jobs (more of them where
    the whole is asked for), and not before the end of what is to be shown."""
    tasks = [one.task for processor in processors for one in processor.tasks]
    whole = hyperperiod(tasks)
    if asked.length is not None:
        return Horizon(max(asked.length, asked.end or 0), whole)
    rate = sum((Fraction(1, task.period) for task in tasks), Fraction(0))
    most = MOST_JOBS if asked.whole else JOBS
    # Work left at the end of a hyperperiod would look as if it never ended: go on beyond the busy period.
    busy = [busy_period([one.task for one in each.tasks], LAPS * whole) for each in processors if each.tasks]
    laps = -(-max(busy, default=1) // whole)
    length = whole * (laps + 1 if laps > 1 else 1)
    length = length if length * rate <= most else max(1, int(most / rate))
    return Horizon(max(length, asked.end or 0), whole)


def busy_period(tasks: Sequence[Task], limit: int) -> int:
    """How long the processor is busy after a synchronous release, as far as that is found in few steps; at most
    `limit`."""
    at = max(1, sum(task.demand(1) for task in tasks))
    for _ in range(BUSY_STEPS):
        then = sum(task.demand(-(-(at + task.jitter) // task.period)) for task in tasks)
        if then <= at or at >= limit:
            break
        at = then
    return min(at, limit)


def windowed(settings: Settings, reach: Horizon, asked: Asked) -> Settings:
    """The settings with this length, and with what is to be shown of it."""
    start, end = asked.start or 0, reach.length if asked.end is None else asked.end
    return changed(settings, length=reach.length, window=(start, end))
