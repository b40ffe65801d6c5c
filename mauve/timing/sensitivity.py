"""How much may change before a deadline is missed: costs, periods, the speed of the processor.

Each quantity is varied alone, all else unchanged, by bisection; that is exact because a higher cost, a shorter period
and a slower processor never make a response shorter. The probes use the trace method, so the answers are safe for it
and for `exact`. Sections follow the cost of what runs in them, deadlines and jitters stay as they are; where jitters,
or what a task that suspends itself is to others, follow from responses, `settle` gives them anew at each probe. With
such tasks and no `settle` nothing is known.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction

from mauve.records import changed, record
from mauve.timing.blocking import with_blocking
from mauve.timing.deferred import is_deferred
from mauve.timing.level import Budget
from mauve.timing.psm import PsmTransition, map_costs
from mauve.timing.response import STEPS, first_late, interference_on, meets_deadline
from mauve.timing.shrink import MOMENTS, What, moments, uses_label
from mauve.timing.task import Kind, Section, Task, Workload
from mauve.timing.traces import Curve, DividedCurve, PsmCurve, altered

PRECISION = 24
"""The speed of the processor is searched for in steps of 2^-24."""

FASTEST = 1 << 12
"""A processor so many times faster that still misses a deadline is taken to miss it at any speed."""

PROBE_STEPS = 2_000
"""Evaluations allowed for each task in a probe, beyond a multiple of those it takes as it is."""

Limits = dict[str, int]

Settle = Callable[[Sequence[Task]], Sequence[Task] | None]
"""Gives tasks the jitters that follow from their responses; None where these have no bound."""


@record
class CostSlack:
    """What `name` costs at most at an activation, and what it may cost so that every deadline holds.

    WORK: the workload `name` of `task`, whose every activation becomes dearer by the difference; CODEL: the part
    labelled `name` of every transition of every task, and the sections it runs in (`task` is empty); OVERHEAD: what is
    added to each job (two context switches), everywhere. `at_most` is below `now` where a deadline is missed, None
    where it is missed even at no cost.
    """

    what: What
    name: str
    task: str
    now: int
    at_most: int | None

    @property
    def growth(self) -> int | None:
        """By how much it may grow; negative where it must shrink."""
        return None if self.at_most is None else self.at_most - self.now


@record
class PeriodSlack:
    """The shortest period of a task with which every deadline holds; None where none does."""

    task: str
    now: int
    at_least: int | None


@record
class Speed:
    """The lowest speed of the processor, as a part of its present one, with which every deadline holds.

    Exact, or at most 2^-24 above the truth, or more where a load so close to 1 remains that busy periods become too
    long to look at; None where no speed suffices (jitter alone exceeds a deadline), and, not exact, where nothing is
    known.
    """

    factor: Fraction | None
    exact: bool


@record
class Sensitivity:
    """All of it, for one set of tasks."""

    costs: tuple[CostSlack, ...]
    periods: tuple[PeriodSlack, ...]
    speed: Speed


def sensitivity(tasks: Sequence[Task], steps: int = STEPS, settle: Settle | None = None) -> Sensitivity:
    """How much each cost, each period and the processor's speed may change."""
    costs, periods = cost_slacks(tasks, steps, settle), period_slacks(tasks, steps, settle)
    return Sensitivity(costs, periods, lowest_speed(tasks, steps, settle))


def _unknown(tasks: Sequence[Task], settle: Settle | None) -> bool:
    """Whether what tasks are to others would have to be settled anew, and cannot be."""
    return settle is None and any(task.outside is not None for task in tasks)


# ----------------------------------------------------------------------------------------------------------- probes
class _Probe:
    """Whether deadlines hold after a change; `order` are the tasks to ask, the likeliest to miss first."""

    __slots__ = ("change", "known", "limits", "order", "settle")

    def __init__(
        self, change: Callable[[int], list[Task]], order: Sequence[str], limits: Limits, settle: Settle | None
    ) -> None:
        self.change, self.order, self.limits, self.settle = change, order, limits, settle
        self.known: dict[int, dict[str, Task]] = {}

    def holds(self, value: int, name: str) -> bool:
        """Whether the task of this name meets its deadline with this value."""
        if value not in self.known:
            settled = self.change(value) if self.settle is None else self.settle(self.change(value))
            self.known = {value: {task.name: task for task in with_blocking(settled or ())}}
        tasks = self.known[value]
        if not tasks:
            return False
        task = tasks[name]
        return meets_deadline(task, interference_on(task, list(tasks.values())), Budget(self.limits[name]))

    def greatest(self, low: int, high: int) -> int | None:
        """The greatest value in low .. high with which all hold, of a property that holds up to some value; None where
        `low` is too much."""
        for name in self.order:
            if self.holds(high, name):
                continue
            if not self.holds(low, name):
                return None
            good, bad = low, high
            while bad - good > 1:
                middle = (good + bad) // 2
                if self.holds(middle, name):
                    good = middle
                else:
                    bad = middle
            high = good
        return high


def _as_it_is(tasks: Sequence[Task], steps: int, settle: Settle | None) -> tuple[Limits, list[str]]:
    """How many steps a probe may take per task, some times those that it takes as it is; and who is late now.

    Close to a load of 1 busy periods become so long that a proof is not worth its time; what is not proven counts as
    missed.
    """
    settled = tasks if settle is None else settle(tasks) or tasks
    now = with_blocking(settled)
    limits: Limits = {}
    late = []
    for task in now:
        budget = Budget(steps)
        if task.kind is Kind.TASK and not meets_deadline(task, interference_on(task, now), budget):
            late.append(task.name)
        limits[task.name] = min(steps, PROBE_STEPS + 4 * (steps - budget.steps))
    return limits, late


def _order(tasks: Sequence[Task], touched: frozenset[str], late: Sequence[str], settle: Settle | None) -> list[str]:
    """Who is late now, and the tasks that a change of some can make late: those at or below them, and whom their
    sections block; the lowest first, as they wait for most."""
    top = max((task.priority for task in tasks if task.name in touched), default=0)
    sections = any(task.sections or task.tail or not task.preemptive for task in tasks)
    below = [
        task.name
        for task in sorted(tasks, key=lambda one: (one.priority, one.name not in touched))
        if task.kind is Kind.TASK and (task.priority <= top or sections or settle is not None)
    ]
    return [*late, *(name for name in below if name not in late)]


# ------------------------------------------------------------------------------------------------------------ costs
def cost_slacks(
    tasks: Sequence[Task], steps: int = STEPS, settle: Settle | None = None
) -> tuple[CostSlack, ...]:
    """What each workload, each codel and the context switches may cost, in this order."""
    if _unknown(tasks, settle):
        return ()
    found = []
    limits, late = _as_it_is(tasks, steps, settle)
    longest = max((task.deadline for task in tasks), default=0)
    for one, touched, change in _contributors(tasks):

        def at_cost(
            cost: int,
            now: int = one.now,
            change: Callable[[Task, int], Task] = change,
            touched: frozenset[str] = touched,
        ) -> list[Task]:
            return [change(task, cost - now) if task.name in touched else task for task in tasks]

        probe = _Probe(at_cost, _order(tasks, touched, late, settle), limits, settle)
        # Above the longest deadline no job that includes it can be in time.
        found.append(changed(one, at_most=probe.greatest(0, max(longest, one.now) + 1)))
    return tuple(found)


def _contributors(
    tasks: Sequence[Task],
) -> Iterator[tuple[CostSlack, frozenset[str], Callable[[Task, int], Task]]]:
    """Each contributor, the tasks it touches, and how to add a difference (or take one away) in them."""
    for task in tasks:
        for place, part in enumerate(task.work):
            now = part.curve.total(1)
            if now > 0:
                one = CostSlack(What.WORK, part.name, task.name, now, None)
                yield one, frozenset((task.name,)), _dearer_work(place, now)
    for label, (now, touched) in _labels(tasks).items():
        if now > 0:
            yield CostSlack(What.CODEL, label, "", now, None), touched, _dearer_label(label)
    now = max((task.overhead for task in tasks), default=0)
    if now > 0:
        every = frozenset(task.name for task in tasks if task.overhead)
        yield CostSlack(What.OVERHEAD, "context switches", "", now, None), every, _dearer_overhead


def _labels(tasks: Sequence[Task]) -> dict[str, tuple[int, frozenset[str]]]:
    """Per part label its greatest cost, and the tasks that have it in a transition or a section."""
    found: dict[str, tuple[int, frozenset[str]]] = {}
    for task in tasks:
        costs = {section.label: section.length for section in task.sections if section.label}
        for part in task.work:
            for transition in part.curve.psm.transitions if isinstance(part.curve, PsmCurve) else ():
                for one in (transition, *transition.alternatives):
                    for item in one.parts:
                        costs[item.label] = max(costs.get(item.label, 0), -(-item.cost // item.count))
        for label, cost in costs.items():
            known, names = found.get(label, (0, frozenset[str]()))
            found[label] = max(known, cost), names | {task.name}
    return found


def _dearer_work(place: int, now: int) -> Callable[[Task, int], Task]:
    def change(task: Task, more: int) -> Task:
        work = list(task.work)
        part = work[place]
        if more >= 0:
            curve = altered(part.curve, more=more)
        else:
            from mauve.timing.shrink import capped

            curve = capped(part.curve, now + more)
        work[place] = changed(part, curve=curve)
        return changed(task, work=tuple(work))

    return change


def _dearer_label(label: str) -> Callable[[Task, int], Task]:
    def transition(one: PsmTransition, more: int) -> PsmTransition:
        parts = tuple(
            changed(part, cost=max(0, part.cost + more * part.count)) if part.label == label else part
            for part in one.parts
        )
        cost = one.cost + sum(part.cost for part in parts) - sum(part.cost for part in one.parts)
        return changed(one, cost=cost, parts=parts)

    def workload(part: Workload, more: int) -> Workload:
        curve = part.curve
        if not isinstance(curve, PsmCurve) or not uses_label(curve, label):
            return part
        return changed(part, curve=PsmCurve(map_costs(curve.psm, lambda one: transition(one, more))))

    def section(one: Section, more: int) -> Section:
        return changed(one, length=max(0, one.length + more)) if one.label == label else one

    def change(task: Task, more: int) -> Task:
        work = tuple(workload(part, more) for part in task.work)
        return changed(task, work=work, sections=tuple(section(one, more) for one in task.sections))

    return change


def _dearer_overhead(task: Task, more: int) -> Task:
    return changed(task, overhead=max(0, task.overhead + more))


# ---------------------------------------------------------------------------------------------------------- periods
def period_slacks(
    tasks: Sequence[Task], steps: int = STEPS, settle: Settle | None = None
) -> tuple[PeriodSlack, ...]:
    """The shortest period of each task, its deadline unchanged; regions that run in one of several jobs still do."""
    if _unknown(tasks, settle):
        return ()
    found = []
    limits, late = _as_it_is(tasks, steps, settle)
    for task in tasks:
        if task.kind is not Kind.TASK:
            continue
        touched = frozenset((task.name,))
        # A period as long as all deadlines and jitters together is as good as none: one job each busy period.
        most = max(task.period, sum(one.deadline + one.jitter for one in tasks))

        def at_period(shorter: int, task: Task = task, most: int = most) -> list[Task]:
            return [_with_period(one, most - shorter) if one is task else one for one in tasks]

        probe = _Probe(at_period, _order(tasks, touched, late, settle), limits, settle)
        shorter = probe.greatest(most - task.period, most - 1)
        if shorter is None:
            shorter = probe.greatest(0, most - 1)
        found.append(PeriodSlack(task.name, task.period, None if shorter is None else most - shorter))
    return tuple(found)


def _with_period(task: Task, period: int) -> Task:
    work = tuple(
        changed(part, period=part.period // task.period * period) if part.period else part for part in task.work
    )
    return changed(task, period=period, work=work)


# ------------------------------------------------------------------------------------------------------------ speed
def lowest_speed(tasks: Sequence[Task], steps: int = STEPS, settle: Settle | None = None) -> Speed:
    """The critical scaling factor: the lowest speed, relative to the present one, with which every deadline holds.

    Costs, sections, blocking and context switches take 1 / speed of their time; periods, deadlines and jitters stay.
    Searched for in steps of 2^-24; then the requirement of the first job late at the step below is solved exactly:
    speed >= min over the moments t of its window of (work released in [0, t)) / t. With `settle` times stay in their
    unit and costs are rounded up, so the answer is not exact.
    """
    if _unknown(tasks, settle):
        return Speed(None, False)
    one = 1 << PRECISION
    scale = _Scale(tasks, steps, settle)
    if not scale.costs:
        return Speed(Fraction(0), True)
    low, high = 0, one
    while not scale.holds(Fraction(high, one)):
        low, high = high, 2 * high
        if high > FASTEST * one:
            return Speed(None, True)
    while high - low > 1:
        middle = (low + high) // 2
        if scale.holds(Fraction(middle, one)):
            high = middle
        else:
            low = middle
    needed = Fraction(low, one)
    for _ in range(8 if settle is None else 0):
        more = scale.required(needed)
        if more is None or not needed < more <= Fraction(high, one):
            break
        if scale.holds(more):
            return Speed(more, True)
        needed = more
    return Speed(Fraction(high, one), False)


class _Scale:
    """The tasks at another speed: n / d times as fast is costs times d and all other times times n, in integers."""

    __slots__ = ("costs", "curves", "given", "settle", "steps", "tasks")

    def __init__(self, tasks: Sequence[Task], steps: int, settle: Settle | None) -> None:
        self.given = tasks
        self.tasks = with_blocking(tasks)
        self.steps = steps
        self.settle = settle
        self.costs = any(task.blocking or task.demand(1) for task in self.tasks)
        self.curves: dict[tuple[str, int, int], Curve] = {}

    def at(self, speed: Fraction) -> list[Task]:
        """The tasks at this speed, in a finer unit of time."""
        times, slower = speed.numerator, speed.denominator
        return [self._scaled(task, times, slower) for task in self.tasks]

    def _scaled(self, task: Task, times: int, slower: int) -> Task:
        work = []
        for place, part in enumerate(task.work):
            key = task.name, place, slower
            if key not in self.curves:
                self.curves[key] = altered(part.curve, times=slower)
            work.append(Workload(part.name, self.curves[key], part.period * times))
        return Task(
            task.name,
            task.priority,
            task.period * times,
            task.deadline * times,
            tuple(work),
            task.jitter * times,
            task.blocking * slower,
            task.overhead * slower,
            task.kind,
            (),
            task.preemptive,
            task.tail * slower,
        )

    def holds(self, speed: Fraction) -> bool:
        """Whether every deadline holds at this speed, the lowest tasks asked first."""
        if speed <= 0:
            return False
        if self.settle is None:
            scaled = self.at(speed)
        else:
            scaled = with_blocking(self.settle([_slower(task, speed) for task in self.given]) or ())
            if not scaled:
                return False
        ours = sorted((task for task in scaled if task.kind is Kind.TASK), key=lambda task: task.priority)
        return all(meets_deadline(task, interference_on(task, scaled), Budget(self.steps)) for task in ours)

    def required(self, speed: Fraction) -> Fraction | None:
        """What the first job late at this speed needs, for the task that needs most; None where that is not known."""
        if speed <= 0:
            return None
        scaled = self.at(speed)
        found: list[Fraction] = []
        for task, slow in zip(self.tasks, scaled, strict=True):
            others = interference_on(slow, scaled)
            if task.kind is not Kind.TASK or meets_deadline(slow, others, Budget(self.steps)):
                continue
            late = 0 if is_deferred(task) else first_late(slow, others, Budget(self.steps))
            needed = self._needed(task, late) if late else None
            if needed is None:
                return None
            found.append(needed)
        return max(found, default=None)

    def _needed(self, task: Task, job: int) -> Fraction | None:
        others = interference_on(task, self.tasks)
        window = task.deadline + (job - 1) * task.period - task.jitter
        released = moments(others.tasks, window)
        if window <= 0 or released is None or len(released) > MOMENTS:
            return None
        base = task.blocking + task.demand(job)
        return min(Fraction(base + others.demand(at), at) for at in {window, *released} if at > 0)


def _slower(task: Task, speed: Fraction) -> Task:
    """The task on a processor so much faster, its costs rounded up."""

    def scaled(time: int) -> int:
        return -(-time * speed.denominator // speed.numerator)

    return changed(
        task,
        work=tuple(changed(part, curve=DividedCurve(part.curve, speed)) for part in task.work),
        blocking=scaled(task.blocking),
        overhead=scaled(task.overhead),
        sections=tuple(changed(section, length=scaled(section.length)) for section in task.sections),
        tail=scaled(task.tail),
    )
