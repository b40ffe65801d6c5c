"""A simulation as CSV: a line per job or per segment, times in the unit of the simulation."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence

from mauve.timing.simulation.outcome import Simulated

JOBS = (
    "simulation", "processor", "unit", "task", "job", "arrival", "release", "start", "finish", "deadline", "response",
    "missed", "preemptions", "blocked", "executed", "runs",
)  # fmt: skip

SEGMENTS = ("simulation", "processor", "unit", "task", "job", "from", "to", "activity", "label", "resources")


def format_jobs(runs: Sequence[Simulated]) -> str:
    """A line per job of the window, in the order of their ends; what is not known is empty."""
    rows = [
        (
            run.name, outcome.processor.name, run.unit, job.task, job.number, job.arrival, job.release, job.start,
            job.finish, job.deadline, job.response, str(job.missed(outcome.end)).lower(), job.preemptions, job.blocked,
            job.cost, job.mode,
        )
        for run in runs
        for outcome in run.outcomes
        for job in outcome.jobs
    ]  # fmt: skip
    return _table(JOBS, rows)


def format_segments(runs: Sequence[Simulated]) -> str:
    """A line per segment of the window, in the order of time."""
    rows = [
        (
            run.name, outcome.processor.name, run.unit, one.task, one.job, one.start, one.end, one.activity.value,
            one.label, " ".join(one.resources),
        )
        for run in runs
        for outcome in run.outcomes
        for one in outcome.segments
    ]  # fmt: skip
    return _table(SEGMENTS, rows)


def _table(header: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows([["" if cell is None else cell for cell in row] for row in rows])
    return text.getvalue()
