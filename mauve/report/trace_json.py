"""A simulation in the Trace Event Format, which ui.perfetto.dev and chrome://tracing open.

One process per processor, one thread per task (the most urgent first): jobs as nested slices (the job while it is under
way, and inside it what it executes), releases and missed deadlines as instants. Times are microseconds, as the format
says; the unit of a plain set counts as one where it is no unit of time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from mauve.timing.simulation.outcome import Job, Outcome, Simulated
from mauve.units import NS, TIME_UNITS, US


def trace_document(runs: Sequence[Simulated], version: str) -> dict[str, object]:
    """The document; `otherData` tells what made it."""
    events: list[dict[str, object]] = []
    pid = 0
    for run in runs:
        for outcome in run.outcomes:
            pid += 1
            name = outcome.processor.name if len(runs) == 1 else f"{run.name}: {outcome.processor.name}"
            events += _processor(outcome, pid, name, TIME_UNITS.get(run.unit, US))
    return {
        "displayTimeUnit": "ms",
        "otherData": {"tool": f"mauvec {version}", "kind": "simulation, no bound"},
        "traceEvents": events,
    }


def _processor(outcome: Outcome, pid: int, name: str, unit: int) -> Iterator[dict[str, object]]:
    def at(time: int) -> int:
        # Viewers count in nanoseconds; ends rounded alike keep slices inside those that hold them.
        return time * unit // NS

    yield {"ph": "M", "name": "process_name", "pid": pid, "tid": 0, "args": {"name": name}}
    yield {"ph": "M", "name": "process_sort_index", "pid": pid, "tid": 0, "args": {"sort_index": pid}}
    threads: dict[str, int] = {}
    for one in sorted(outcome.tasks, key=lambda task: -task.priority):
        tid = threads[one.task] = len(threads) + 1
        yield {"ph": "M", "name": "thread_name", "pid": pid, "tid": tid, "args": {"name": one.task}}
        yield {"ph": "M", "name": "thread_sort_index", "pid": pid, "tid": tid, "args": {"sort_index": tid}}
    yield from sorted(_events(outcome, pid, threads, at), key=_place)


def _us(nanoseconds: int) -> float:
    return nanoseconds / 1000


def _place(event: dict[str, object]) -> tuple[float, float]:
    """In time; of two slices that start together the longer, which holds the other, first."""
    ts, duration = event["ts"], event.get("dur", 0.0)
    assert isinstance(ts, float) and isinstance(duration, float | int)
    return ts, -float(duration)


def _events(
    outcome: Outcome, pid: int, threads: dict[str, int], at: Callable[[int], int]
) -> Iterator[dict[str, object]]:
    for job in outcome.jobs:
        common: dict[str, object] = {"pid": pid, "tid": threads[job.task]}
        args = _arguments(job, at)
        release = _us(at(job.release))
        yield {**common, "ph": "i", "s": "t", "name": "release", "cat": "release", "ts": release, "args": args}
        if job.start is not None:
            end = outcome.end if job.finish is None else job.finish
            name = f"{job.task} {job.number}"
            yield {**common, "ph": "X", "name": name, "cat": "job", **_span(at(job.start), at(end)), "args": args}
        if job.missed(outcome.end):
            late = _us(at(job.deadline))
            yield {**common, "ph": "i", "s": "t", "name": "deadline missed", "cat": "miss", "ts": late}
    for one in outcome.segments:
        kind = one.activity.value
        held: dict[str, object] = {"job": one.job, "resources": list(one.resources)}
        common = {"pid": pid, "tid": threads[one.task], "ph": "X", "name": one.label or kind, "cat": kind}
        yield {**common, **_span(at(one.start), at(one.end)), "args": held}


def _arguments(job: Job, at: Callable[[int], int]) -> dict[str, object]:
    response = {} if job.response is None else {"response": _us(at(job.response))}
    return {
        "job": job.number,
        "arrival": _us(at(job.arrival)),
        "deadline": _us(at(job.deadline)),
        **response,
        "preemptions": job.preemptions,
        "blocked": _us(at(job.blocked)),
        "runs": job.mode,
    }


def _span(start: int, end: int) -> dict[str, object]:
    return {"ts": _us(start), "dur": _us(end - start)}
