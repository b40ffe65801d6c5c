"""By how much a cost would have to shrink so that a missed deadline holds: the first question after a miss.

Each contributor is capped alone, all else unchanged: no activation of it may cost more than x. The greatest such x is
found by bisection, each probe a new analysis of the one task; that is exact because a lower cost never raises a
response. Under the methods `trace` and `exact` the probes use the trace method, so the answer is safe for both.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from enum import Enum

from mauve.timing.level import Budget, float_load, job_finishes, load_compared_to_one, repetition
from mauve.timing.psm import PsmTransition, map_costs
from mauve.timing.response import STEPS, Analysis, Method, analyse, interference_on
from mauve.timing.task import Kind, Task, Workload
from mauve.timing.traces import ConstantCurve, Curve, FramesCurve, PsmCurve, TableCurve


class What(Enum):
    """What a candidate caps."""

    WORK = "work"
    CODEL = "codel"
    OVERHEAD = "overhead"
    BLOCKING = "blocking"


@dataclass(frozen=True, slots=True)
class Shrink:
    """One candidate: `name` costs `now` at most at an activation; with at most `at_most` the deadline holds.

    None where the deadline is missed even if it cost nothing. WORK: the workload `name` of `task`; CODEL: the part
    labelled `name` of every transition of every task (`task` is empty); OVERHEAD: what is added to each job (two
    context switches), everywhere; BLOCKING: the blocking of the missed task.
    """

    what: What
    name: str
    task: str
    now: int
    at_most: int | None


def shrink_to_fit(analysis: Analysis, name: str, steps: int = STEPS) -> tuple[Shrink, ...]:
    """For each contributor to the response of task `name`, the greatest cost with which its deadline holds.

    Empty where the deadline holds already. Order: workloads by urgency, then codels, overhead, blocking.
    """
    task = analysis.task(name)
    if analysis.result(name).schedulable:
        return ()
    tasks = [task, *interference_on(task, analysis.tasks).tasks]
    found = []
    for what, label, owner, now, change in _candidates(tasks, task):

        def holds(cost: int, change: Callable[[Task, int], Task] = change) -> bool:
            return _meets([change(one, cost) for one in tasks], name, analysis.method, steps)

        found.append(Shrink(what, label, owner, now, _greatest(holds, now)))
    return tuple(found)


def _greatest(holds: Callable[[int], bool], now: int) -> int | None:
    """The greatest x in 0 .. now - 1 that holds, of a property that holds up to some x; None where 0 does not."""
    if not holds(0):
        return None
    low, high = 0, now
    while high - low > 1:
        middle = (low + high) // 2
        if holds(middle):
            low = middle
        else:
            high = middle
    return low


def _meets(tasks: Sequence[Task], name: str, method: Method, steps: int) -> bool:
    """Whether the deadline of one task is proven to hold."""
    if method is Method.PAPER:
        return analyse(tasks, method, steps).result(name).schedulable
    task = next(one for one in tasks if one.name == name)
    others = interference_on(task, tasks)
    level = load_compared_to_one(tasks, others.load + float_load(task))
    if level > 0:
        return False
    repeat = repetition(tasks) if level == 0 else None
    return job_finishes(task, others, Budget(steps), repeat=repeat, until_late=True).closed


Candidate = tuple[What, str, str, int, Callable[[Task, int], Task]]


def _candidates(tasks: Sequence[Task], missed: Task) -> list[Candidate]:
    found: list[Candidate] = []
    for owner in sorted(tasks, key=lambda one: (one.name != missed.name, -one.priority, one.name)):
        for place, part in enumerate(owner.work):
            if (now := part.curve.total(1)) > 0:
                found.append((What.WORK, part.name, owner.name, now, _cap_work(owner.name, place)))
    for label, now in _codels(tasks).items():
        found.append((What.CODEL, label, "", now, _cap_codel(label)))
    if (now := max(one.overhead for one in tasks)) > 0:
        found.append((What.OVERHEAD, "context switches", "", now, _cap_overhead))
    if missed.blocking > 0:
        found.append((What.BLOCKING, "blocking", missed.name, missed.blocking, _cap_blocking(missed.name)))
    return found


def _codels(tasks: Sequence[Task]) -> dict[str, int]:
    """The greatest cost of each part label in the machines of these tasks."""
    labels: dict[str, int] = {}
    for task in tasks:
        for part in task.work:
            if isinstance(part.curve, PsmCurve) and task.kind is Kind.TASK:
                for transition in part.curve.psm.transitions:
                    for one in (transition, *transition.alternatives):
                        for item in one.parts:
                            labels[item.label] = max(item.cost, labels.get(item.label, 0))
    return {label: cost for label, cost in labels.items() if cost > 0}


def _cap_work(owner: str, place: int) -> Callable[[Task, int], Task]:
    def change(task: Task, cost: int) -> Task:
        if task.name != owner:
            return task
        work = [
            replace(part, curve=capped(part.curve, cost)) if index == place else part
            for index, part in enumerate(task.work)
        ]
        return replace(task, work=tuple(work))

    return change


def capped(curve: Curve, cost: int) -> Curve:
    """The curve with no activation dearer than `cost` (for a table: no n activations dearer than n x `cost`)."""
    match curve:
        case ConstantCurve():
            return ConstantCurve(min(curve.cost, cost))
        case FramesCurve():
            return FramesCurve([min(frame, cost) for frame in curve.frames])
        case TableCurve():
            return TableCurve([min(total, jobs * cost) for jobs, total in enumerate(curve.values) if jobs])
        case PsmCurve():
            return PsmCurve(map_costs(curve.psm, lambda t: _with_cost(t, min(t.cost, cost))))
    raise TypeError(f"cannot cap {type(curve).__name__}")


def _with_cost(transition: PsmTransition, cost: int) -> PsmTransition:
    """The transition at a lower cost; its parts no longer itemise it, so they are dropped."""
    return transition if transition.cost == cost else replace(transition, cost=cost, parts=())


def _cap_codel(label: str) -> Callable[[Task, int], Task]:
    def transition(one: PsmTransition, cost: int) -> PsmTransition:
        parts = tuple(
            replace(part, cost=min(part.cost, cost)) if part.label == label else part for part in one.parts
        )
        saved = sum(part.cost for part in one.parts) - sum(part.cost for part in parts)
        return replace(one, cost=one.cost - saved, parts=parts) if saved else one

    def workload(part: Workload, cost: int) -> Workload:
        curve = part.curve
        if not isinstance(curve, PsmCurve) or not _uses(curve, label):
            return part
        return replace(part, curve=PsmCurve(map_costs(curve.psm, lambda one: transition(one, cost))))

    def change(task: Task, cost: int) -> Task:
        work = tuple(workload(part, cost) for part in task.work)
        return task if work == task.work else replace(task, work=work)

    return change


def _uses(curve: PsmCurve, label: str) -> bool:
    return any(
        part.label == label
        for transition in curve.psm.transitions
        for one in (transition, *transition.alternatives)
        for part in one.parts
    )


def _cap_overhead(task: Task, cost: int) -> Task:
    return replace(task, overhead=min(task.overhead, cost))


def _cap_blocking(owner: str) -> Callable[[Task, int], Task]:
    def change(task: Task, cost: int) -> Task:
        return replace(task, blocking=min(task.blocking, cost)) if task.name == owner else task

    return change
