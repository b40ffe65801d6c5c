"""Task systems for the tests: task-set files, random systems, a simulator that shares no code with the analysis."""

from __future__ import annotations

import json
import random
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

from hypothesis import strategies as st

from mauve.timing.psm import Psm, PsmTransition, make_psm
from mauve.timing.task import Task, Workload, constant, frames, machine, table
from mauve.timing.traces import ConstantCurve, FramesCurve, PsmCurve, TableCurve

from .test_psm import psms

CASES = Path(__file__).parent / "cases"


def load_cases(file: str) -> list[dict[str, Any]]:
    cases: list[dict[str, Any]] = json.loads((CASES / file).read_text(encoding="utf-8"))
    return cases


def read_psm(name: str, data: dict[str, Any]) -> Psm:
    arrows = [PsmTransition(edge["src"], edge["dst"], edge["cost"]) for edge in data["edges"]]
    return make_psm(name, data["initial"], arrows)


def read_tasks(case: dict[str, Any]) -> list[Task]:
    """The tasks of one mauve.taskset/1 object."""

    def work(data: dict[str, Any]) -> Workload:
        name = data["name"]
        if "frames" in data:
            return frames(name, data["frames"])
        if "curve" in data:
            return table(name, data["curve"])
        if "psm" in data:
            return machine(read_psm(name, data["psm"]))
        return constant(name, data["C"])

    return [
        Task(
            name=data["name"],
            priority=data["prio"],
            period=data["T"],
            deadline=data.get("D", data["T"]),
            work=(work(data),),
            jitter=data.get("J", 0),
            blocking=data.get("B", 0),
        )
        for data in case["tasks"]
    ]


@st.composite
def systems(draw: st.DrawFn, jitter: bool = True, overhead: bool = True, size: int = 4) -> list[Task]:
    """Small random systems: machines, constants and frames, equal priorities, some beyond a load of 1."""
    tasks = []
    for number in range(draw(st.integers(1, size))):
        period = draw(st.integers(4, 24))
        name = f"t{number}"
        match draw(st.sampled_from(["psm", "psm", "constant", "frames", "table", "two", "slow"])):
            case "psm":
                work: tuple[Workload, ...] = (machine(draw(psms(max_states=4, max_cost=7))),)
            case "constant":
                work = (constant(name, draw(st.integers(0, 7))),)
            case "frames":
                work = (frames(name, draw(st.lists(st.integers(0, 7), min_size=1, max_size=3))),)
            case "table":
                steps = sorted(draw(st.lists(st.integers(0, 5), min_size=1, max_size=4)), reverse=True)
                work = (table(name, [sum(steps[:n]) for n in range(1, len(steps) + 1)]),)
            case "two":
                work = (machine(draw(psms(max_states=3, max_cost=4))), constant("b", draw(st.integers(0, 3))))
            case _:
                slow = draw(psms(max_states=3, max_cost=6))
                work = (machine(slow, period=period * draw(st.integers(1, 3))),)
        tasks.append(
            Task(
                name,
                draw(st.integers(1, size)),
                period,
                draw(st.integers(1, 2 * period)),
                work,
                jitter=draw(st.integers(0, 12)) if jitter and draw(st.booleans()) else 0,
                overhead=draw(st.integers(0, 1)) if overhead else 0,
            )
        )
    return tasks


@dataclass
class Job:
    arrival: int
    release: int
    left: int
    task: int


def random_costs(task: Task, jobs: int, rng: random.Random) -> list[int]:
    """The costs of consecutive jobs along random runs, each started in a random reachable state."""
    costs = [task.overhead] * jobs
    for part in task.work:
        every = (part.period or task.period) // task.period
        runs = range(rng.randrange(every), jobs, every)
        for job, cost in zip(runs, _run(part, len(runs), rng), strict=True):
            costs[job] += cost
    return costs


def _run(part: Workload, length: int, rng: random.Random) -> list[int]:
    curve = part.curve
    if isinstance(curve, ConstantCurve):
        return [curve.cost] * length
    if isinstance(curve, FramesCurve):
        start = rng.randrange(len(curve.frames))
        return [curve.frames[(start + n) % len(curve.frames)] for n in range(length)]
    if isinstance(curve, TableCurve):
        # Jobs that all cost the least step of the table: no stretch of them costs more than it says.
        return [min(later - earlier for earlier, later in pairwise(curve.values))] * length
    assert isinstance(curve, PsmCurve)
    state, costs = curve.psm.initial, []
    for step in range(-rng.randrange(6), length):
        out = [t for t in curve.psm.transitions if t.source == state]
        if out and rng.random() < 0.5:
            out = [max(out, key=lambda t: t.cost)]
        taken = rng.choice(out) if out else PsmTransition(state, state, 0)
        state = taken.target
        if step >= 0:
            costs.append(taken.cost)
    return costs


def simulate(tasks: list[Task], horizon: int, rng: random.Random, locked: str | None = None) -> dict[str, int]:
    """The greatest response seen of each task, in unit steps over random offsets, jitters, separations and runs.

    Jobs of one task run in the order of their arrivals; those of zero cost finish when released. The task
    `locked` is never preempted once it runs.
    """
    jobs: list[Job] = []
    synchronous = rng.random() < 0.5
    for index, task in enumerate(tasks):
        at = 0 if synchronous else rng.randrange(task.period)
        periodic = rng.random() < 0.7
        for cost in random_costs(task, horizon // task.period + 1, rng):
            delay = rng.choice((0, task.jitter, rng.randint(0, task.jitter)))
            jobs.append(Job(at, at + delay, cost, index))
            at += task.period + (0 if periodic else rng.randrange(3))
    if synchronous:
        for index, task in enumerate(tasks):
            first = next(job for job in jobs if job.task == index)
            for job in (job for job in jobs if job.task == index):
                job.arrival -= task.jitter
                job.release = max(job.release - task.jitter, first.arrival + task.jitter)
    worst = {task.name: 0 for task in tasks}
    queues = [[job for job in reversed(jobs) if job.left and job.task == index] for index in range(len(tasks))]
    for job in jobs:
        if not job.left:
            worst[tasks[job.task].name] = max(worst[tasks[job.task].name], job.release - job.arrival)
    running: Job | None = None
    for now in range(min((job.release for job in jobs), default=0), horizon):
        if not (running and running.left and tasks[running.task].name == locked):
            heads = [queue[-1] for queue in queues if queue and queue[-1].release <= now]
            top = max((tasks[job.task].priority for job in heads), default=0)
            ready = [job for job in heads if tasks[job.task].priority == top]
            running = rng.choice(ready) if ready else None
        if running:
            running.left -= 1
            if not running.left:
                queues[running.task].pop()
                name = tasks[running.task].name
                worst[name] = max(worst[name], now + 1 - running.arrival)
    return worst
