"""Worst-case response times: fixed priorities, one processor (MAUVE paper, section III.C.4).

    w_i(q) = least fixed point of B_i + E_i(q) + sum over j in hep(i) without i of E_j(ceil((w + J_j) / T_j))
    R_i    = max over q = 1 .. ceil((L_i + J_i) / T_i) of J_i + w_i(q) - (q-1) T_i       from the nominal arrival

with L_i the level-i busy period. Arbitrary deadlines, jitter, blocking and a load of exactly 1 are covered; for tasks
that are not preempted, or not in their last section, see `deferred.py`. Blocking is what a task was given or what the
sections of less urgent tasks cause, whichever is longer (`blocking.py`). Methods:

* sporadic: each job costs the dearest transition of its machine;
* paper:    the paper's own: first job only, no blocking, no jitter. As printed, the release index j T_i would leave
            out the release at 0 (it is (j-1) T_i), and releases count strictly before R. The result says where the
            method does not cover the task;
* trace:    the formula above with the workload curves (the default);
* exact:    concrete runs instead of curves, where R <= T and nothing has jitter (`exact.py`); elsewhere `trace`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from enum import Enum
from itertools import chain, groupby
from typing import TYPE_CHECKING

from mauve.records import changed, record
from mauve.timing.blocking import with_blocking
from mauve.timing.deferred import deferred_finishes, is_deferred, section_of
from mauve.timing.level import (
    Budget,
    Interference,
    JobsOutcome,
    finish,
    float_load,
    job_finishes,
    load_compared_to_one,
    repetition,
)
from mauve.timing.task import Kind, Task
from mauve.timing.traces import ConstantCurve

if TYPE_CHECKING:
    from mauve.timing.exact import Refinement, Runs

STEPS = 100_000
"""Evaluations of the fixed point's right-hand side allowed per task before its response is given up as unknown."""

SURELY_BELOW = 0.999
"""A load that is less as a float is less than 1."""

UNPROVEN_STEPS = 10_000
"""The same at a load of 1 where nothing is proven to repeat, and only a busy period that ends gives an answer."""


class Method(Enum):
    """How the work of interfering machines is bounded."""

    SPORADIC = "sporadic"
    PAPER = "paper"
    TRACE = "trace"
    EXACT = "exact"


class Reason(Enum):
    """Why there is no response time."""

    OVERLOAD = "the task and those at least as urgent need more than the whole processor"
    FULL_LOAD = "the load is exactly 1 and the busy period neither ends nor is proven to repeat"
    LIMIT = "the busy period has more jobs than the analysis looks at"
    ARRIVALS = "nothing bounds how often it, or a task at least as urgent, is woken"
    WAITS = "it, or a task at least as urgent, waits for operations of others for longer than it has time"


class Caveat(Enum):
    """What to know about a response time that is there."""

    LATER_JOBS = "the response exceeds the period, and the paper's method looks at the first job only"
    JITTER = "there is jitter, which the paper's method leaves out"
    BLOCKING = "there is blocking, which the paper's method leaves out"
    NO_PREEMPTION = "there is work that cannot be preempted, which the paper's method leaves out"
    ESTIMATED = "a workload curve was extended by subadditivity beyond its computed part"
    FELL_BACK = "the exact method does not cover this task; the trace method was used"
    GAVE_UP = "the exact method met too many runs; the value is a sound bound between trace and exact"


UNSOUND = frozenset((Caveat.LATER_JOBS, Caveat.JITTER, Caveat.BLOCKING, Caveat.NO_PREEMPTION))
"""The caveats that say a response may be too small."""


@record
class Charge:
    """What the exact method charges one workload (`task.work[place]`) of an interfering task, job by job."""

    task: str
    place: int
    costs: tuple[int, ...]


@record
class ResponseResult:
    """The response of one task: `wcrt` from the nominal arrival, or None and the `reason`.

    `from_release` is the greatest response from the release, which is later by up to the jitter: job q of a busy period
    that begins with a release at its greatest jitter J is not released before max(0, (q-1) T - J).
    `worst_job` is the q that attains it and `finish` its w(q); `section` the part at its end that is not preempted (0
    for a preemptive task); `busy_period` is L_i (None where unknown or without end); `responsible` the tasks of an
    overload, the greatest load first; `method` the one that was really used.
    """

    task: str
    wcrt: int | None
    deadline: int
    method: Method
    reason: Reason | None = None
    worst_job: int = 0
    finish: int = 0
    busy_period: int | None = None
    caveats: tuple[Caveat, ...] = ()
    responsible: tuple[str, ...] = ()
    charges: tuple[Charge, ...] = ()
    section: int = 0
    from_release: int | None = None

    @property
    def schedulable(self) -> bool:
        """Whether the deadline is proven to hold."""
        return self.wcrt is not None and self.wcrt <= self.deadline

    @property
    def slack(self) -> int | None:
        """Deadline - response: negative where it is missed."""
        return None if self.wcrt is None else self.deadline - self.wcrt


@record
class Analysis:
    """The responses of all tasks (not of interrupts and ticks), in the order given.

    `tasks` are those of the request as the method sees them: constant curves for `sporadic`, no jitter and blocking
    for `paper`, else with the blocking that sections cause. Bills are made from them (`bill.py`).
    """

    method: Method
    tasks: tuple[Task, ...]
    results: tuple[ResponseResult, ...]

    @property
    def schedulable(self) -> bool:
        """Whether every deadline is proven to hold."""
        return all(result.schedulable for result in self.results)

    def result(self, name: str) -> ResponseResult:
        """The response of the task of this name; KeyError if there is none."""
        for result in self.results:
            if result.task == name:
                return result
        raise KeyError(name)

    def task(self, name: str) -> Task:
        """The task of this name as analysed; KeyError if there is none."""
        for task in self.tasks:
            if task.name == name:
                return task
        raise KeyError(name)


def analyse(tasks: Sequence[Task], method: Method = Method.TRACE, steps: int = STEPS) -> Analysis:
    """The worst-case response times of these tasks, which share one processor.

    Never raises on a set that cannot be scheduled: such tasks get None and a reason. ValueError if two have one name.
    """
    if len({task.name for task in tasks}) != len(tasks):
        raise ValueError("two tasks have one name")
    seen = as_seen(tasks, method)
    found: dict[str, ResponseResult] = {}
    above = Interference()
    warm: tuple[int, int] = (0, 0)
    runs: dict[int, Runs] = {}
    for _, group in groupby(sorted(seen, key=lambda task: -task.priority), key=lambda task: task.priority):
        peers = list(group)
        for task in peers:
            if task.kind is not Kind.TASK:
                continue
            others = above
            if len(peers) > 1:
                others = above.copy()
                for peer in peers:
                    if peer is not task:
                        others.add(peer.interferer)
            # More interference and no less blocking than the task above: w(1) is its w(1) plus own work at least.
            bound = warm[0] if task.blocking >= warm[1] else 0
            result, first = _respond(task, others, method, Budget(steps), bound, runs)
            found[task.name] = result
        if len(peers) == 1 and peers[0].kind is Kind.TASK and first is not None and peers[0].outside is None:
            warm = (first, peers[0].blocking)
        for peer in peers:
            above.add(peer.interferer)
    results = [found[task.name] for task in seen if task.kind is Kind.TASK]
    if method is Method.PAPER:
        given = with_blocking(tasks)
        results = [_with_paper_caveats(result, given) for result in results]
    return Analysis(method, tuple(seen), tuple(results))


def as_seen(tasks: Sequence[Task], method: Method) -> list[Task]:
    """The tasks as a method sees them."""
    match method:
        case Method.SPORADIC:
            return [_everywhere(task, _dearest) for task in with_blocking(tasks)]
        case Method.PAPER:
            return [_everywhere(task, _plain) for task in tasks]
        case Method.TRACE | Method.EXACT:
            return with_blocking(tasks)


def _everywhere(task: Task, change: Callable[[Task], Task]) -> Task:
    """The task with a change made to it and to what it is to others."""
    return changed(change(task), outside=None if task.outside is None else change(task.outside))


def _dearest(task: Task) -> Task:
    return changed(task, work=tuple(changed(p, curve=ConstantCurve(p.curve.total(1))) for p in task.work))


def _plain(task: Task) -> Task:
    return changed(task, jitter=0, blocking=0, sections=(), preemptive=True, tail=0)


def interference_on(task: Task, tasks: Sequence[Task]) -> Interference:
    """The tasks that delay `task`: all others of at least its priority."""
    others = Interference()
    for other in tasks:
        if other.priority >= task.priority and other.name != task.name:
            others.add(other.interferer)
    return others


def meets_deadline(task: Task, others: Interference, budget: Budget) -> bool:
    """Whether the deadline of a task is proven to hold under this interference, by the trace method.

    Its `blocking` counts as it is (see `with_blocking`). Costs much less than the response where a job is late early.
    """
    level = load_compared_to_one(chain(others.tasks, (task,)), others.load + float_load(task))
    if level > 0:
        return False
    repeat = repetition([*others.tasks, task]) if level == 0 else None
    if level == 0 and repeat is None:
        budget.steps = min(budget.steps, UNPROVEN_STEPS)
    return _jobs(task, others, budget, repeat).closed


def _jobs(task: Task, others: Interference, budget: Budget, repeat: int | None) -> JobsOutcome:
    if is_deferred(task):
        return deferred_finishes(task, others, budget, repeat, until_late=True)
    return job_finishes(task, others, budget, repeat=repeat, until_late=True)


def first_late(task: Task, others: Interference, budget: Budget) -> int:
    """The first job of the busy period that misses its deadline; 0 where none is found to."""
    return _jobs(task, others, budget, None).late


def _respond(
    task: Task, others: Interference, method: Method, budget: Budget, warm: int, runs: dict[int, Runs]
) -> tuple[ResponseResult, int | None]:
    """The result of one task and its w(1), where known."""
    if method is Method.PAPER:
        return _first_job(task, others, budget)
    load = others.load + float_load(task)
    level = -1 if load < SURELY_BELOW else load_compared_to_one(chain(others.tasks, (task,)), load)
    if level > 0:
        if task.outside is not None and load_compared_to_one([*others.tasks, task.outside], 1.0) <= 0:
            return ResponseResult(task.name, None, task.deadline, method, Reason.WAITS), None
        return _overload(task, others, method), None
    repeat = None
    if level == 0:
        repeat = repetition([*others.tasks, task])
        if repeat is None:
            budget.steps = min(budget.steps, UNPROVEN_STEPS)
    deferred = is_deferred(task)
    if deferred:
        jobs = deferred_finishes(task, others, budget, repeat)
    else:
        jobs = job_finishes(task, others, budget, warm, repeat)
    finishes = jobs.finishes
    first = finishes[0] if finishes and not deferred else None
    if not jobs.closed:
        reason = Reason.FULL_LOAD if level == 0 else Reason.LIMIT
        return ResponseResult(task.name, None, task.deadline, method, reason), first
    worst = 0
    lasting = list(finishes)
    if len(finishes) > 1:
        lasting = [end - index * task.period for index, end in enumerate(finishes)]
        worst = lasting.index(max(lasting))
    if method is Method.EXACT and not deferred and task.outside is None:
        from mauve.timing.exact import refine

        refined = refine(task, others, lasting[worst], runs)
        if refined is not None:
            return _refined(task, refined, jobs.busy), first
    result = ResponseResult(
        task=task.name,
        wcrt=task.jitter + lasting[worst],
        deadline=task.deadline,
        method=Method.TRACE if method is Method.EXACT else method,
        worst_job=worst + 1,
        finish=finishes[worst],
        busy_period=jobs.busy,
        caveats=_estimated(task, others, finishes[-1], len(finishes)),
        section=section_of(task) if deferred else 0,
        from_release=finishes[0] if len(finishes) == 1 else _from_release(task, finishes),
    )
    if method is Method.EXACT:
        result = changed(result, caveats=(*result.caveats, Caveat.FELL_BACK))
    return result, first


def _from_release(task: Task, finishes: Sequence[int]) -> int:
    period, jitter = task.period, task.jitter
    return max([end - max(0, index * period - jitter) for index, end in enumerate(finishes)])


def _refined(task: Task, found: Refinement, busy: int | None) -> ResponseResult:
    end = found.finish
    return ResponseResult(
        task=task.name,
        wcrt=end,
        deadline=task.deadline,
        method=Method.EXACT,
        worst_job=1,
        finish=end,
        busy_period=busy,
        caveats=() if found.complete else (Caveat.GAVE_UP,),
        charges=tuple(Charge(*charge) for charge in found.charges),
        from_release=end,
    )


def _first_job(
    task: Task, others: Interference, budget: Budget
) -> tuple[ResponseResult, int | None]:
    """The paper's method: w(1) alone, which is finite as long as the others leave anything of the processor."""
    own = task.demand(1)
    if load_compared_to_one(others.tasks, others.load) >= (0 if own else 1):
        return _overload(task, others, Method.PAPER), None
    end = finish(others, own, 0, budget)
    if end is None:
        return ResponseResult(task.name, None, task.deadline, Method.PAPER, Reason.LIMIT), None
    caveats = _estimated(task, others, end, 1)
    result = ResponseResult(task.name, end, task.deadline, Method.PAPER, None, 1, end, caveats=caveats)
    return changed(result, from_release=end), end


def _overload(task: Task, others: Interference, method: Method) -> ResponseResult:
    ranked = sorted([task, *others.tasks], key=lambda one: -one.load)
    names = tuple(one.name for one in ranked if one.load > 0)
    return ResponseResult(task.name, None, task.deadline, method, Reason.OVERLOAD, responsible=names)


def _estimated(task: Task, others: Interference, window: int, jobs: int) -> tuple[Caveat, ...]:
    if not others.curved and len(task.work) == 1 and isinstance(task.work[0].curve, ConstantCurve):
        return ()
    own = any(part.curve.estimated(task.activations(part, jobs)) for part in task.work)
    foreign = any(
        part.curve.estimated(-(-(window + other.jitter) // (part.period or other.period)))
        for other in others.tasks
        for part in other.work
    )
    return (Caveat.ESTIMATED,) if own or foreign else ()


def _with_paper_caveats(result: ResponseResult, tasks: Sequence[Task]) -> ResponseResult:
    """Say where the paper's method does not cover a task of the set as it was given."""
    task = next(one for one in tasks if one.name == result.task)
    caveats = list(result.caveats)
    if result.wcrt is None or result.wcrt > task.period:
        caveats.append(Caveat.LATER_JOBS)
    if any(max(one.jitter, one.interferer.jitter) > 0 for one in tasks if one.priority >= task.priority):
        caveats.append(Caveat.JITTER)
    if task.blocking > 0:
        caveats.append(Caveat.BLOCKING)
    if is_deferred(task):
        caveats.append(Caveat.NO_PREEMPTION)
    return changed(result, caveats=tuple(caveats))
