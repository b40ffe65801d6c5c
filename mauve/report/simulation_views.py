"""What the reports of a simulation share: times in their unit, settings in words, and where jobs wait."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from enum import Enum
from fractions import Fraction

from mauve.records import record
from mauve.timing.simulation.outcome import Job, Outcome, Segment, Simulated
from mauve.timing.simulation.system import Jitter, Settings
from mauve.units import TIME_UNITS, format_time

NOT_A_BOUND = "one run out of many: what is seen here is no bound"


def show_time(time: int, unit: str) -> str:
    """A time with its unit: one of time in the unit a person would choose, another as it is."""
    return format_time(time * TIME_UNITS[unit]) if unit in TIME_UNITS else f"{time}{unit}"


def show_mean(time: Fraction, unit: str) -> str:
    """A mean with its unit, rounded up."""
    if unit in TIME_UNITS:
        exact = time * TIME_UNITS[unit]
        return format_time(-(-exact.numerator // exact.denominator))
    hundredths = -(-100 * time.numerator // time.denominator)
    return f"{hundredths // 100}.{hundredths % 100:02}".rstrip("0").rstrip(".") + unit


def describe(settings: Settings) -> tuple[tuple[str, str], ...]:
    """The choices that were made, as (name, value); `seed` last."""
    return (
        ("offsets", settings.offsets.value),
        ("runs", settings.runs.value),
        ("jitter", settings.jitter.value if settings.jitter is not Jitter.WORST else "worst"),
        ("arrivals", settings.arrivals.value),
        ("execution", settings.execution.value),
        ("order", settings.order.value),
        ("protocol", settings.protocol.value),
        ("seed", str(settings.seed)),
    )


def reach_note(run: Simulated) -> str:
    """Why less than the hyperperiod was simulated; empty where it was all of it."""
    if not run.outcomes:
        return ""
    end = min(outcome.end for outcome in run.outcomes)
    length = show_time(end, run.unit)
    whole = show_time(run.horizon.hyperperiod, run.unit)
    if any(outcome.cut for outcome in run.outcomes):
        events = max(outcome.events for outcome in run.outcomes)
        return f"stopped at {length} after {events} events; the hyperperiod is {whole}"
    if not run.horizon.whole:
        return f"the hyperperiod is {whole}; the first {length} of it"
    return ""


class Wait(Enum):
    """Why a released job does not run: more (or as) urgent work runs, or less urgent work, in a section or without
    preemption."""

    PREEMPTED = "preempted"
    BLOCKED = "blocked"


@record
class Waiting:
    """A stretch in which a job waits."""

    task: str
    job: int
    start: int
    end: int
    wait: Wait


def waits(outcome: Outcome) -> tuple[Waiting, ...]:
    """Where the jobs of the window wait, from their release or the end of the job before on; task by task."""
    start, end = outcome.window
    priorities = {one.task: one.priority for one in outcome.tasks}
    starts = [segment.start for segment in outcome.segments]
    away: dict[tuple[str, int], list[Segment]] = {}
    for one in outcome.waits:
        away.setdefault((one.task, one.job), []).append(one)
    found: list[Waiting] = []
    free: dict[str, int] = {}
    for job in sorted(outcome.jobs, key=lambda one: one.number):
        first = max(job.release, start, free.get(job.task, 0))
        last = min(end, outcome.end if job.finish is None else job.finish)
        free[job.task] = max(last, free.get(job.task, 0))
        for since, until in _present(first, last, away.get((job.task, job.number), ())):
            at = max(0, bisect_right(starts, since) - 1)
            found += _gaps(job, since, until, outcome.segments, at, priorities)
    return tuple(found)


def _present(first: int, last: int, away: Sequence[Segment]) -> Iterator[tuple[int, int]]:
    """What is left of a stretch without those in which the job is away by itself."""
    for one in away:
        if one.start > first:
            yield first, min(one.start, last)
        first = max(first, one.end)
    if first < last:
        yield first, last


def _gaps(
    job: Job, first: int, last: int, segments: tuple[Segment, ...], at: int, priorities: Mapping[str, int]
) -> Iterator[Waiting]:
    current: Waiting | None = None
    while at < len(segments) and segments[at].start < last:
        segment = segments[at]
        at += 1
        start, end = max(segment.start, first), min(segment.end, last)
        if start >= end or (segment.task == job.task and segment.job == job.number):
            continue
        less = priorities[segment.task] < priorities[job.task]
        wait = Wait.BLOCKED if less else Wait.PREEMPTED
        if current is not None and current.wait is wait and current.end == start:
            current = Waiting(job.task, job.number, current.start, end, wait)
            continue
        if current is not None:
            yield current
        current = Waiting(job.task, job.number, start, end, wait)
    if current is not None:
        yield current
