"""The fixed point of one task: its busy period and the response of each of its jobs.

    w(q) = least fixed point > 0 of B + E_i(q) + sum over interfering parts of E_j(ceil((w + J_j) / T_j))
    R    = max over q of J + w(q) - (q-1) T, up to the first q with w(q) + J <= q T, where the busy period ends

That w(q) is then the length L of the level-i busy period, so L needs no fixed point of its own: below it each w(q-1)
lies beyond the next release, hence ceil((L + J) / T) = q. The iteration starts from a proven lower bound and only
rises; the number of evaluations is limited, so nothing here loops without end.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from math import lcm

from mauve.records import record
from mauve.timing.task import Task
from mauve.timing.traces import ConstantCurve, Curve

NEAR_ONE = 1e-6
"""Loads this close to 1 are compared as exact fractions, and give no lower bound by division."""


class Interference:
    """What a set of tasks demands in a window, flattened for speed: constants, jittered constants, curves.

    The number of jobs of a workload with a period P of its own, a multiple of its task's T, is
    ceil(ceil((x + J) / T) T / P) = ceil((x + J) / P), so each workload counts by itself. `load` sums the
    long-run loads, `floor` the loads that no window falls below, `offset` the floors x jitters.
    """

    __slots__ = ("curved", "floor", "load", "offset", "places", "plain", "shifted", "tasks")

    def __init__(self) -> None:
        self.plain: list[tuple[int, int]] = []
        self.places: dict[int, int] = {}
        self.shifted: list[tuple[int, int, int]] = []
        self.curved: list[tuple[Callable[[int], int], int, int]] = []
        self.tasks: list[Task] = []
        self.load = self.floor = self.offset = 0.0

    def copy(self) -> Interference:
        """An independent copy, to which tasks can be added."""
        other = Interference()
        other.plain, other.shifted, other.curved = self.plain[:], self.shifted[:], self.curved[:]
        other.tasks, other.places = self.tasks[:], self.places.copy()
        other.load, other.floor, other.offset = self.load, self.floor, self.offset
        return other

    def add(self, task: Task) -> None:
        """Count the work of one more task."""
        self.tasks.append(task)
        jitter = task.jitter
        if task.overhead:
            self._add_constant(task.overhead, task.period, jitter)
        for part in task.work:
            period = part.period or task.period
            curve = part.curve
            if isinstance(curve, ConstantCurve):
                self._add_constant(curve.cost, period, jitter)
            else:
                self.curved.append((curve.total, period, jitter))
                self._weigh(_as_float(curve.mean) / period, _as_float(curve.floor) / period, jitter)

    def _add_constant(self, cost: int, period: int, jitter: int) -> None:
        if jitter:
            self.shifted.append((cost, period, jitter))
            self._weigh(cost / period, cost / period, jitter)
            return
        # Constants of one period are released together: their sum stands for them.
        place = self.places.setdefault(period, len(self.plain))
        if place < len(self.plain):
            self.plain[place] = (self.plain[place][0] + cost, period)
        else:
            self.plain.append((cost, period))
        load = cost / period
        self.load += load
        self.floor += load

    def _weigh(self, load: float, floor: float, jitter: int) -> None:
        self.load += load
        self.floor += floor
        self.offset += floor * jitter

    def demand(self, window: int) -> int:
        """The work released in a half-open window of this length, from a synchronous release on."""
        # -(-a // b) is ceil(a / b) in integers.
        total = sum([cost * -(-window // period) for cost, period in self.plain])
        for cost, period, jitter in self.shifted:
            total += cost * -(-(window + jitter) // period)
        for curve, period, jitter in self.curved:
            total += curve(-(-(window + jitter) // period))
        return total


def _as_float(value: Fraction) -> float:
    return value.numerator / value.denominator


def float_load(task: Task) -> float:
    """The load of a task as a float, for comparisons that `load_compared_to_one` settles exactly."""
    load = task.overhead / task.period
    for part in task.work:
        curve = part.curve
        cost = curve.cost if isinstance(curve, ConstantCurve) else _as_float(curve.mean)
        load += cost / (part.period or task.period)
    return load


class Budget:
    """How many evaluations of the right-hand side are left for one task."""

    __slots__ = ("steps",)

    def __init__(self, steps: int) -> None:
        self.steps = steps


@record
class JobsOutcome:
    """The jobs of one busy period: their w(1), w(2), ...; `closed` if all that can matter were seen.

    `busy` is its length (None where it never ends but was proven to repeat), `late` the first job found beyond its
    deadline (0: none).
    """

    finishes: tuple[int, ...]
    closed: bool
    busy: int | None
    late: int


def finish(interference: Interference, base: int, start: int, budget: Budget, above: int | None = None) -> int | None:
    """The least fixed point > 0 of base + interference; `start` is a lower bound of it (0 for none known).

    None when the budget ends; a value greater than `above` as soon as the fixed point is known to exceed it.
    """
    at = start or base + interference.demand(1)
    if at == 0:
        return 0
    room = 1.0 - interference.floor
    if room > NEAR_ONE:
        # Every E_j(n) >= n f_j, so w >= (base + sum F_j J_j) / (1 - F) with F_j = f_j / T_j and F their sum; the
        # factor outweighs the float's error.
        at = max(at, int((base + interference.offset) / room * (1 - 1e-7)))
    while budget.steps > 0:
        if above is not None and at > above:
            return at
        budget.steps -= 1
        then = base + interference.demand(at)
        if then <= at:
            return at
        at = then
    return None


def job_finishes(
    task: Task,
    others: Interference,
    budget: Budget,
    warm: int = 0,
    repeat: int | None = None,
    until_late: bool = False,
) -> JobsOutcome:
    """w(1), w(2), ... to the end of the busy period.

    `repeat` is the time after which all demands repeat, for a load of exactly 1 (see `repetition`): the loop ends too
    when w(q) has grown by exactly that over repeat / T jobs. `warm` is a lower bound of w(1) - E(1). With `until_late`
    the loop ends at the first late job.
    """
    period, jitter = task.period, task.jitter
    finishes: list[int] = []
    jobs = repeat // period if repeat else 0
    settled = settled_from(task, others) if repeat else None
    own = task.demand(1)
    start = warm + own if warm else 0
    q = 0
    while True:
        q += 1
        above = task.deadline + (q - 1) * period - jitter if until_late else None
        at = finish(others, task.blocking + own, start, budget, above)
        if at is None:
            return JobsOutcome(tuple(finishes), False, None, 0)
        finishes.append(at)
        if above is not None and at > above:
            return JobsOutcome(tuple(finishes), False, None, q)
        if at + jitter <= q * period:
            return JobsOutcome(tuple(finishes), True, at, 0)
        if settled and repeat and q > jobs and at - finishes[q - 1 - jobs] == repeat and settled(q - jobs):
            return JobsOutcome(tuple(finishes), True, None, 0)
        following = task.demand(q + 1)
        start, own = at + following - own, following


def load_compared_to_one(tasks: Iterable[Task], estimate: float) -> int:
    """-1, 0 or 1 as the load of these tasks is below, exactly, or above 1; `estimate` is that load as a float."""
    if abs(estimate - 1.0) > NEAR_ONE:
        return -1 if estimate < 1.0 else 1
    exact = sum((task.load for task in tasks), Fraction(0))
    return (exact > 1) - (exact < 1)


def _curves(tasks: Iterable[Task]) -> list[tuple[Curve, Task, int]]:
    return [(part.curve, task, part.period or task.period) for task in tasks for part in task.work]


def repetition(tasks: Sequence[Task]) -> int | None:
    """One hyperperiod times the cyclicities: a time H with n_j(x + H) jobs of j costing a fixed amount more.

    None where a curve is not proven to repeat. With a load of 1 that amount sums to H over all tasks, so once
    w(q + H/T) = w(q) + H beyond all transients, each iteration of w(q+1+H/T) is that of w(q+1) moved by H: the
    responses repeat for ever.
    """
    whole = 1
    for curve, task, period in _curves(tasks):
        law = curve.repeat()
        if law is None:
            return None
        whole = lcm(whole, law.jobs * period, task.period)
    return lcm(whole, *(task.period for task in tasks))


def settled_from(task: Task, others: Interference) -> Callable[[int], bool]:
    """Whether from job q on all curves are beyond their transients; q is reached in any window >= (q-1) T - J."""
    laws = [(curve.repeat(), period, owner.jitter) for curve, owner, period in _curves([*others.tasks, task])]

    def beyond(q: int) -> bool:
        window = max(0, (q - 1) * task.period - task.jitter)
        return all(law is not None and window // period >= law.start for law, period, _ in laws)

    return beyond
