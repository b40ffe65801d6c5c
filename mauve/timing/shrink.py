"""By how much a cost would have to shrink so that a missed deadline holds: the first question after a miss.

Each contributor is capped alone, all else unchanged: no activation of it may cost more than x. The greatest such x is
found by bisection, each probe a new analysis of the one task; that is exact because a lower cost never raises a
response. Under the methods `trace` and `exact` the probes use the trace method, so the answer is safe for both.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Sequence
from enum import Enum

from mauve.records import changed, record
from mauve.timing.deferred import is_deferred
from mauve.timing.level import Budget, finish
from mauve.timing.psm import PsmTransition, map_costs
from mauve.timing.response import STEPS, Analysis, Method, first_late, interference_on, meets_deadline
from mauve.timing.suspension import CarryInCurve
from mauve.timing.task import Task, Workload
from mauve.timing.traces import ConstantCurve, Curve, FramesCurve, PsmCurve, TableCurve

MOMENTS = 5_000
"""Releases in the window of a miss that are looked at to rule out contributors without an analysis."""


class What(Enum):
    """What a candidate caps."""

    WORK = "work"
    CODEL = "codel"
    OVERHEAD = "overhead"
    BLOCKING = "blocking"


@record
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

    Empty where the deadline holds already. Order: the task's own work, that of others by urgency, codels, overhead,
    blocking.
    """
    task = analysis.task(name)
    if analysis.result(name).schedulable:
        return ()
    tasks = [task, *interference_on(task, analysis.tasks).tasks]
    miss = _miss(task, tasks, analysis.method, steps)
    found = []
    for one in _candidates(tasks, task, miss):

        def holds(cost: int, one: _Candidate = one) -> bool:
            changed = [one.change(each, cost) if each.name in one.touched else each for each in tasks]
            return _meets(changed, name, analysis.method, steps)

        at_most = _greatest(holds, one, miss.gap)
        found.append(Shrink(one.what, one.name, one.task, one.now, at_most))
    return tuple(found)


@record
class _Miss:
    """The first late job, the window to its deadline, and the least excess of work over time at any moment in it.

    Unless the work released in some [0, x) of the window falls by at least `gap`, the job stays late.
    """

    job: int
    window: int
    gap: int


@record
class _Candidate:
    """A contributor, how to cap it in the `touched` tasks, and how often it is charged in the window of the miss.

    `saving` bounds what the window loses when it costs nothing; a cap x saves (now - x) at each of `charges`.
    """

    what: What
    name: str
    task: str
    now: int
    touched: frozenset[str]
    change: Callable[[Task, int], Task]
    saving: int
    charges: int


def _greatest(holds: Callable[[int], bool], one: _Candidate, gap: int) -> int | None:
    """The greatest cap in 0 .. now - 1 that holds, of a property that holds up to some cap; None where 0 does not."""
    if one.saving < gap:
        return None
    low, high = -1, one.now
    # With a constant cost this guess is the answer; it only shortens the search, so both sides are probed.
    guess = one.now - -(-gap // max(1, one.charges))
    for probe in (0, guess, guess + 1):
        if low < probe < high:
            if holds(probe):
                low = probe
            else:
                high = probe
    if low < 0:
        return None
    while high - low > 1:
        middle = (low + high) // 2
        if holds(middle):
            low = middle
        else:
            high = middle
    return low


def _miss(task: Task, tasks: Sequence[Task], method: Method, steps: int) -> _Miss:
    """What the first late job lacks; a gap of 0 (nothing known) where none is found or the window is long."""
    others = interference_on(task, tasks)
    late = 1
    if method is not Method.PAPER:
        late = first_late(task, others, Budget(steps))
    window = task.deadline + (late - 1) * task.period - task.jitter
    released = moments(others.tasks, window)
    if late == 0 or window <= 0 or released is None or (is_deferred(task) and method is not Method.PAPER):
        return _Miss(max(1, late), max(0, window), 0)
    base = task.blocking + task.demand(late)
    # Between releases the excess only falls, so its least values are where one is just due, and at the end.
    return _Miss(late, window, min(base + others.demand(at) - at for at in {window, *released}))


def moments(tasks: Sequence[Task], window: int) -> list[int] | None:
    """The releases within the window; None for too many."""
    series = [(part.period or one.period, one.jitter) for one in tasks for part in one.work]
    series += [(one.period, one.jitter) for one in tasks if one.overhead]
    if sum((window + jitter) // period for period, jitter in series) > MOMENTS:
        return None
    return [at for period, jitter in series for at in range(period - jitter % period, window, period)]


def _meets(tasks: Sequence[Task], name: str, method: Method, steps: int) -> bool:
    """Whether the deadline of one task is proven to hold."""
    task = next(one for one in tasks if one.name == name)
    others = interference_on(task, tasks)
    if method is Method.PAPER:
        end = finish(others, task.demand(1), 0, Budget(steps), task.deadline)
        return end is not None and end <= task.deadline
    return meets_deadline(task, others, Budget(steps))


def _candidates(tasks: Sequence[Task], missed: Task, miss: _Miss) -> list[_Candidate]:
    def count(owner: Task, period: int) -> int:
        if owner.name == missed.name:
            return -(-miss.job * owner.period // period)
        return -(-(miss.window + owner.jitter) // period)

    found: list[_Candidate] = []
    for owner in sorted(tasks, key=lambda one: (one.name != missed.name, -one.priority, one.name)):
        for place, part in enumerate(owner.work):
            # What a task that suspends itself costs is not one number to cap: its codels are.
            suspends = isinstance(part.curve, CarryInCurve) or owner.outside is not None
            if not suspends and (now := part.curve.total(1)) > 0:
                jobs = count(owner, part.period or owner.period)
                touched = frozenset((owner.name,))
                change = _cap_work(owner.name, place)
                saving = part.curve.total(jobs)
                found.append(_Candidate(What.WORK, part.name, owner.name, now, touched, change, saving, jobs))
    for label, uses in _codels(tasks).items():
        now = max(use.dearest for use in uses)
        touched = frozenset(use.task.name for use in uses)
        charges = sum(count(use.task, use.period) * use.times for use in uses)
        if now > 0:
            change = _cap_codel(label)
            found.append(_Candidate(What.CODEL, label, "", now, touched, change, charges * now, charges))
    every = frozenset(one.name for one in tasks)
    charges = sum(count(one, one.period) for one in tasks if one.overhead)
    if (now := max(one.overhead for one in tasks)) > 0:
        name = "context switches"
        found.append(_Candidate(What.OVERHEAD, name, "", now, every, _cap_overhead, charges * now, charges))
    if (now := missed.blocking) > 0:
        change = _cap_blocking(missed.name)
        touched = frozenset((missed.name,))
        found.append(_Candidate(What.BLOCKING, "blocking", missed.name, now, touched, change, now, 1))
    return found


@record
class _Use:
    """A part label in one machine: its greatest cost, and how often at most it occurs in one transition."""

    task: Task
    period: int
    dearest: int
    times: int


def _codels(tasks: Sequence[Task]) -> dict[str, list[_Use]]:
    """The machines of these tasks that use each part label."""
    uses: dict[str, list[_Use]] = {}
    for task in tasks:
        for part in task.work:
            if not isinstance(part.curve, PsmCurve):
                continue
            dearest: dict[str, int] = {}
            times: dict[str, int] = {}
            for transition in part.curve.psm.transitions:
                for one in (transition, *transition.alternatives):
                    runs: Counter[str] = Counter()
                    for item in one.parts:
                        runs[item.label] += item.count
                        dearest[item.label] = max(-(-item.cost // item.count), dearest.get(item.label, 0))
                    times = {label: max(times.get(label, 0), runs[label]) for label in times | runs}
            for label, cost in dearest.items():
                uses.setdefault(label, []).append(_Use(task, part.period or task.period, cost, times[label]))
    return uses


def _cap_work(owner: str, place: int) -> Callable[[Task, int], Task]:
    def change(task: Task, cost: int) -> Task:
        if task.name != owner:
            return task
        work = [
            changed(part, curve=capped(part.curve, cost)) if index == place else part
            for index, part in enumerate(task.work)
        ]
        return changed(task, work=tuple(work))

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
    return transition if transition.cost == cost else changed(transition, cost=cost, parts=())


def _cap_codel(label: str) -> Callable[[Task, int], Task]:
    def transition(one: PsmTransition, cost: int) -> PsmTransition:
        parts = tuple(
            changed(part, cost=min(part.cost, cost * part.count)) if part.label == label else part
            for part in one.parts
        )
        saved = sum(part.cost for part in one.parts) - sum(part.cost for part in parts)
        return changed(one, cost=one.cost - saved, parts=parts) if saved else one

    def workload(part: Workload, cost: int) -> Workload:
        curve = part.curve
        if not isinstance(curve, PsmCurve) or not uses_label(curve, label):
            return part
        return changed(part, curve=PsmCurve(map_costs(curve.psm, lambda one: transition(one, cost))))

    def change(task: Task, cost: int) -> Task:
        work = tuple(workload(part, cost) for part in task.work)
        return task if work == task.work else changed(task, work=work)

    return change


def uses_label(curve: PsmCurve, label: str) -> bool:
    """Whether a transition of the machine has a part of this label."""
    return any(
        part.label == label
        for transition in curve.psm.transitions
        for one in (transition, *transition.alternatives)
        for part in one.parts
    )


def _cap_overhead(task: Task, cost: int) -> Task:
    return changed(task, overhead=min(task.overhead, cost))


def _cap_blocking(owner: str) -> Callable[[Task, int], Task]:
    def change(task: Task, cost: int) -> Task:
        return changed(task, blocking=min(task.blocking, cost)) if task.name == owner else task

    return change
