"""A simulation as JSON, schema mauve.simulation/1 (docs/schema/simulation-1.schema.json)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mauve.report.simulation_views import NOT_A_BOUND, describe, reach_note
from mauve.timing.simulation.outcome import Job, Measures, Outcome, Segment, Simulated

SCHEMA = "mauve.simulation/1"


def simulation_document(runs: Sequence[Simulated], file: str, version: str) -> dict[str, object]:
    """The document. Times are integers in the unit of each simulation; jobs and segments are those of its window."""
    return {
        "schema": SCHEMA,
        "tool": {"name": "mauvec", "version": version},
        "file": file,
        "note": NOT_A_BOUND,
        "simulations": [_simulation(run) for run in runs],
    }


def _simulation(run: Simulated) -> dict[str, object]:
    return {
        "name": run.name,
        "unit": run.unit,
        "hyperperiod": run.horizon.hyperperiod,
        "deadlines_missed": run.misses,
        "remark": reach_note(run) or None,
        "processors": [_processor(outcome, bounds) for outcome, bounds in zip(run.outcomes, run.bounds, strict=True)],
    }


def _processor(outcome: Outcome, bounds: Mapping[str, int | None]) -> dict[str, object]:
    start, end = outcome.window
    settings: dict[str, object] = dict(describe(outcome.settings))
    settings["seed"] = outcome.settings.seed
    return {
        "name": outcome.processor.name,
        "settings": settings,
        "simulated": outcome.end,
        "cut": outcome.cut,
        "events": outcome.events,
        "busy": outcome.busy,
        "idle": outcome.idle,
        "load": outcome.busy / outcome.end if outcome.end else 0.0,
        "context_switches": outcome.switches,
        "preemptions": outcome.preemptions,
        "deadlines_missed": outcome.misses,
        "tasks": [_task(one, bounds.get(one.task), outcome.end) for one in outcome.tasks],
        "window": {"from": start, "to": end},
        "jobs": [_job(job, outcome.end) for job in outcome.jobs],
        "segments": [_segment(segment) for segment in outcome.segments],
        "waits": [_segment(segment) for segment in outcome.waits],
    }


def _task(one: Measures, bound: int | None, end: int) -> dict[str, object]:
    return {
        "name": one.task,
        "kind": one.kind.value,
        "priority": one.priority,
        "period": one.period,
        "deadline": one.deadline,
        "released": one.released,
        "finished": one.finished,
        "response": {
            "least": one.least,
            "mean": None if one.mean is None else float(one.mean),
            "greatest": one.greatest,
            "greatest_job": one.worst_job,
            "greatest_arrival": one.worst_arrival,
        },
        "proven_bound": bound,
        "deadlines_missed": one.misses,
        "preemptions": one.preemptions,
        "longest_blocking": one.blocked,
        "busy": one.busy,
        "load": one.busy / end if end else 0.0,
    }


def _job(job: Job, end: int) -> dict[str, object]:
    return {
        "task": job.task,
        "number": job.number,
        "arrival": job.arrival,
        "release": job.release,
        "start": job.start,
        "finish": job.finish,
        "deadline": job.deadline,
        "response": job.response,
        "missed": job.missed(end),
        "preemptions": job.preemptions,
        "blocked": job.blocked,
        "executed": job.cost,
        "runs": job.mode,
    }


def _segment(segment: Segment) -> dict[str, object]:
    return {
        "task": segment.task,
        "job": segment.job,
        "from": segment.start,
        "to": segment.end,
        "activity": segment.activity.value,
        "label": segment.label,
        "resources": list(segment.resources),
    }
