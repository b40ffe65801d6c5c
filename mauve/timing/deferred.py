"""The fixed point of a task that is not preempted once it runs, or not in the last section of each job.

    s(q) = least fixed point of B + E_i(q-1) + (c - n) + sum over interfering parts of E_j(floor((s + J_j) / T_j) + 1)
    f(q) = s(q) + n                           R = max over q = 1 .. ceil((L + J) / T) of J + f(q) - (q-1) T

where job q starts the section that nothing preempts at s(q), c is the dearest job, n the length of the section (all of
c for a task without preemption), and L the level-i busy period. What is released at s(q) itself still comes first. All
L / T jobs count, not those up to the first that ends before its successor arrives: the work that a job keeps from
running is pushed into the next one (Davis, Burns, Bril and Lukkien, 2007). A job is taken to do at most c - n before
its section. Interrupts preempt the section, too: f(q) then is a fixed point of its own.
"""

from __future__ import annotations

from mauve.timing.level import (
    NEAR_ONE,
    Budget,
    Interference,
    JobsOutcome,
    finish,
    float_load,
    load_compared_to_one,
    settled_from,
)
from mauve.timing.task import Kind, Task


def is_deferred(task: Task) -> bool:
    """Whether the task has jobs, or ends of jobs, that more urgent tasks cannot preempt."""
    return not task.preemptive or task.tail > 0


def section_of(task: Task) -> int:
    """n: the length of the section at the end of each job that nothing but interrupts preempts."""
    dearest = task.demand(1)
    return dearest if not task.preemptive else min(task.tail, dearest)


def own_demand(task: Task, job: int) -> int:
    """E(q-1) + c: what the first `job` jobs cost at most where the last may be the dearest."""
    return task.demand(job - 1) + task.demand(1)


def deferred_finishes(
    task: Task, others: Interference, budget: Budget, repeat: int | None = None, until_late: bool = False
) -> JobsOutcome:
    """f(1), f(2), ... of the jobs of the busy period; parameters and result as of `level.job_finishes`."""
    overload = until_late and load_compared_to_one([*others.tasks, task], others.load + float_load(task)) > 0
    busy = None if repeat or overload else _busy_period(task, others, budget)
    if busy is None and repeat is None and not overload:
        return JobsOutcome((), False, None, 0)
    handlers = _only(others, interrupts=True)
    section = section_of(task)
    count = max(1, -(-(busy + task.jitter) // task.period)) if busy is not None else 0
    jobs = repeat // task.period if repeat else 0
    settled = settled_from(task, others) if repeat else None
    finishes: list[int] = []
    q, at = 0, 0
    while busy is None or q < count:
        q += 1
        base = task.blocking + own_demand(task, q) - section
        # An overload has no busy period, and times that grow without end: only what is in time is looked at.
        latest = task.deadline + (q - 1) * task.period - task.jitter - section if until_late else None
        start = start_of(others, base, at, budget, latest)
        if start is not None and latest is not None and start > latest:
            return JobsOutcome(tuple(finishes), False, None, q)
        end = start if start is None else end_of(handlers, start, section, budget)
        if start is None or end is None:
            return JobsOutcome(tuple(finishes), False, None, 0)
        finishes.append(end)
        at = start
        if until_late and end + task.jitter > task.deadline + (q - 1) * task.period:
            return JobsOutcome(tuple(finishes), False, None, q)
        if settled and repeat and q > jobs and end - finishes[q - 1 - jobs] == repeat and settled(q - jobs):
            return JobsOutcome(tuple(finishes), True, None, 0)
    return JobsOutcome(tuple(finishes), True, busy, 0)


def start_of(
    others: Interference, base: int, least: int, budget: Budget, above: int | None = None
) -> int | None:
    """The least fixed point of base + work released in a closed window; at least `least`. None at the budget's end; a
    value greater than `above` as soon as the fixed point is known to exceed it."""
    # In whole numbers floor(x / T) + 1 = ceil((x + 1) / T): the closed window is one unit longer.
    at = max(least, base + others.demand(1))
    room = 1.0 - others.floor
    if room > NEAR_ONE:
        at = max(at, int((base + others.offset) / room * (1 - 1e-7)))
    while budget.steps > 0:
        if above is not None and at > above:
            return at
        budget.steps -= 1
        then = base + others.demand(at + 1)
        if then <= at:
            return at
        at = then
    return None


def end_of(handlers: Interference, start: int, section: int, budget: Budget) -> int | None:
    """When a section ends that began at `start` and is delayed by interrupts only; None at the budget's end."""
    if not handlers.tasks or not section:
        return start + section
    return finish(handlers, start + section - handlers.demand(start + 1), start + section, budget)


def _only(others: Interference, interrupts: bool) -> Interference:
    found = Interference()
    for other in others.tasks:
        if (other.kind is not Kind.TASK) == interrupts:
            found.add(other)
    return found


def _busy_period(task: Task, others: Interference, budget: Budget) -> int | None:
    """L: the time in which the task, those that interfere and the blocking keep the processor busy."""
    level = others.copy()
    level.add(task)
    if level.floor >= 1.0 - NEAR_ONE and task.blocking:
        # A load of 1 with blocking never ends; the caller looks for a repetition.
        budget.steps = min(budget.steps, 10_000)
    return finish(level, task.blocking, 0, budget)
