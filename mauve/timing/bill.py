"""The bill of a response time: which work, of whom, fills the window of a job, term by term.

Two windows matter. `worst_bill`: the window w(q) of the job that attains the response; its lines sum to w(q) exactly.
`deadline_bill`: the window from the start of the busy period to the deadline of the first job that misses it; its
lines sum to more than the window, which is why the deadline is missed: as long as the work released in [0, x) exceeds
x the processor is busy, and a job that is not done by d has more than d due by d. (A window of 0: jitter alone exceeds
the deadline.)
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from mauve.records import record
from mauve.timing.deferred import is_deferred, own_demand, section_of, start_of
from mauve.timing.level import Budget, finish
from mauve.timing.psm import Psm, PsmTransition
from mauve.timing.response import STEPS, Analysis, Charge, Method, ResponseResult, first_late, interference_on
from mauve.timing.task import Kind, Task, Workload
from mauve.timing.traces import PsmCurve, witness_run

SHOWN_JOBS = 64
"""Traces and runs in a bill are spelled out for so many jobs at most."""


@record
class BillWork:
    """The share of one workload: how often it runs, what that costs, its trace, and a run of its PSM that costs it.

    `trace` holds e_1, e_2, ... of the first `SHOWN_JOBS` jobs at most; `machine` is the PSM whose run can be shown.
    """

    name: str
    jobs: int
    cost: int
    trace: tuple[int, ...]
    machine: Psm | None = None

    @property
    def run(self) -> tuple[PsmTransition, ...]:
        """The transitions of all jobs, empty where there are more than `SHOWN_JOBS` or the work is not a PSM. They are
        found when asked for: of most interferers nobody asks."""
        if self.machine is None or not 0 < self.jobs <= SHOWN_JOBS:
            return ()
        return witness_run(self.machine, self.jobs)


@record
class BillLine:
    """The share of one task: `cost` = the work + `overhead` (context switches of its `jobs`)."""

    task: str
    kind: Kind
    priority: int
    period: int
    jobs: int
    cost: int
    overhead: int
    work: tuple[BillWork, ...]


@record
class Bill:
    """What is due in a window of length `window` that ends with job `job` of `task`.

    `own` is the task's first `job` jobs, `others` the interfering tasks, dearest first, `blocking` the critical
    section of a less urgent task; `due` is the sum.
    """

    task: str
    job: int
    window: int
    own: BillLine
    others: tuple[BillLine, ...]
    blocking: int

    @property
    def due(self) -> int:
        """The total work due in the window."""
        return self.blocking + self.own.cost + sum(line.cost for line in self.others)

    @property
    def excess(self) -> int:
        """By how much the work due exceeds the window (0 for the bill of a response)."""
        return self.due - self.window


def worst_bill(analysis: Analysis, name: str) -> Bill | None:
    """The bill of the job that attains the response; None where there is no response time."""
    result = analysis.result(name)
    if result.wcrt is None:
        return None
    task = analysis.task(name)
    return _bill(analysis.tasks, task, result.worst_job, result.finish, result.charges, _start(analysis, result))


def deadline_bill(analysis: Analysis, name: str, steps: int = STEPS) -> Bill | None:
    """The bill by the deadline of the first job that misses it; None where none is found to miss."""
    task = analysis.task(name)
    result = analysis.result(name)
    if result.schedulable:
        return None
    if analysis.method is Method.PAPER:
        late = 1
    elif result.method is Method.EXACT:
        # Only its first job matters there, with the charges of its worst run: what came by the deadline is a part.
        late = 1
    else:
        late = first_late(task, interference_on(task, analysis.tasks), Budget(steps))
    if late == 0:
        return None
    window = max(0, task.deadline + (late - 1) * task.period - task.jitter)
    latest = window - section_of(task) if is_deferred(task) else None
    if latest is not None:
        others = interference_on(task, analysis.tasks)
        base = task.blocking + own_demand(task, late) - section_of(task)
        begin = start_of(others, base, 0, Budget(steps), latest)
        latest = max(0, latest if begin is None else min(begin, latest))
    return _bill(analysis.tasks, task, late, window, result.charges, latest)


def first_finish(analysis: Analysis, name: str, steps: int = STEPS) -> int | None:
    """The response J + w(1) of the first job of the busy period, which exists even where the load exceeds 1.

    It is not a worst case; None where the more urgent tasks leave nothing of the processor.
    """
    task = analysis.task(name)
    others = interference_on(task, analysis.tasks)
    if others.load >= 1.0:
        return None
    end = finish(others, task.blocking + task.demand(1), 0, Budget(steps))
    return None if end is None else end + task.jitter


def _start(analysis: Analysis, result: ResponseResult) -> int | None:
    """When the section that is not preempted begins in the worst case; None for a preemptive task."""
    task = analysis.task(result.task)
    if not is_deferred(task):
        return None
    base = task.blocking + own_demand(task, result.worst_job) - result.section
    return start_of(interference_on(task, analysis.tasks), base, 0, Budget(STEPS))


def _bill(
    tasks: Sequence[Task], task: Task, job: int, window: int, charges: tuple[Charge, ...], start: int | None
) -> Bill:
    """`start` is when the last section begins: what other tasks release later does not delay it (`deferred.py`)."""
    charged = {(charge.task, charge.place): charge.costs for charge in charges}
    lines = []
    for other in interference_on(task, tasks).tasks:
        length = window if start is None or other.kind is not Kind.TASK else start + 1
        lines.append(_line(other, -(-(length + other.jitter) // other.period), length, charged))
    others = sorted((line for line in lines if line.cost), key=lambda line: (-line.cost, line.task))
    own = _line(task, job, None, {}) if start is None else _own_deferred(task, job)
    return Bill(task.name, job, window, own, tuple(others), task.blocking)


def _own_deferred(task: Task, job: int) -> BillLine:
    """The task's own jobs where the last one may be the dearest: E(q-1) and E(1)."""
    before, last = _line(task, job - 1, None, {}), _line(task, 1, None, {})
    work = tuple(
        BillWork(a.name, a.jobs + b.jobs, a.cost + b.cost, (a.trace + b.trace)[:SHOWN_JOBS], machine)
        for a, b in zip(before.work, last.work, strict=True)
        for machine in [b.machine if job == 1 else None]
    )
    cost = before.cost + last.cost
    return BillLine(task.name, task.kind, task.priority, task.period, job, cost, before.overhead + last.overhead, work)


def _line(
    task: Task, jobs: int, window: int | None, charged: dict[tuple[str, int], tuple[int, ...]]
) -> BillLine:
    work = []
    for place, part in enumerate(task.work):
        if window is None or not part.period:
            count = task.activations(part, jobs)
        else:
            count = -(-(window + task.jitter) // part.period)
        costs = charged.get((task.name, place))
        work.append(_work(part, count) if costs is None else _charged(part, costs[:count]))
    overhead = jobs * task.overhead
    cost = overhead + sum(one.cost for one in work)
    return BillLine(task.name, task.kind, task.priority, task.period, jobs, cost, overhead, tuple(work))


def _charged(part: Workload, costs: tuple[int, ...]) -> BillWork:
    return BillWork(part.name, len(costs), sum(costs), costs[:SHOWN_JOBS])


def _work(part: Workload, jobs: int) -> BillWork:
    curve = part.curve
    totals = [curve.total(count) for count in range(min(jobs, SHOWN_JOBS) + 1)]
    trace = tuple(later - earlier for earlier, later in pairwise(totals))
    return BillWork(part.name, jobs, curve.total(jobs), trace, curve.psm if isinstance(curve, PsmCurve) else None)
