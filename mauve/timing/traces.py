"""Traces and workload curves: what any l consecutive activations cost at most (MAUVE paper, section III.C.3).

The workload curve of a PSM is E(l) = the greatest total cost of l consecutive transitions from ANY reachable state;
its trace is e_l = E(l) - E(l-1), which is equations (9) and (10) over all runs from all reachable states. (As printed,
(10) subtracts e_{l-1} only; figure 5 shows that the sum of e_1 .. e_{l-1} is meant.) Runs that start in the initial
state alone would be unsound: a task may meet the machine in any state.

E is non-decreasing and subadditive: E(k + l) <= E(k) + E(l). Each curve here is a lazily growing object, so a fixed
point pays only for the jobs it looks at. Curves are compared by identity and may be shared by several tasks.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Sequence
from fractions import Fraction
from itertools import accumulate, pairwise

from mauve.records import record
from mauve.timing.psm import Psm, PsmTransition, max_cycle_mean, reachable_edges

EXACT_JOBS = (1024, 16_384)
"""A PSM's curve is computed exactly for at least the first number of jobs, however large the machine, and up to the
second as long as jobs x transitions stays below EXACT_WORK."""

EXACT_WORK = 1_000_000


@record
class Repeat:
    """A proven law of a curve: E(l + jobs) = E(l) + cost for every l >= start."""

    start: int
    jobs: int
    cost: int


class Curve(ABC):
    """The greatest total cost of n consecutive jobs, for every n; grows as it is asked."""

    __slots__ = ()

    @abstractmethod
    def total(self, jobs: int) -> int:
        """E(jobs), or an upper bound of it where `estimated(jobs)`; 0 for no job."""

    @property
    @abstractmethod
    def mean(self) -> Fraction:
        """The long-run cost per job: the limit of E(l) / l."""

    @property
    def floor(self) -> Fraction:
        """The greatest f with E(l) >= f l for every l: the mean, for a curve that is subadditive throughout."""
        return self.mean

    @abstractmethod
    def repeat(self) -> Repeat | None:
        """The law by which the curve repeats, if it is proven; this may grow the curve."""

    def estimated(self, jobs: int) -> bool:
        """Whether total(jobs) is an extension by subadditivity instead of the exact value."""
        return False


class ConstantCurve(Curve):
    """Every job costs the same."""

    __slots__ = ("cost",)

    def __init__(self, cost: int) -> None:
        if cost < 0:
            raise ValueError("a cost is not negative")
        self.cost = cost

    def __repr__(self) -> str:
        return f"ConstantCurve({self.cost})"

    def total(self, jobs: int) -> int:
        """E(n) = n C."""
        return jobs * self.cost

    @property
    def mean(self) -> Fraction:
        """C."""
        return Fraction(self.cost)

    def repeat(self) -> Repeat:
        """It repeats at each job."""
        return Repeat(0, 1, self.cost)


class TableCurve(Curve):
    """Given values E(1) .. E(H), e.g. measured; beyond, E(kH + r) = k E(H) + E(r) (sound by subadditivity)."""

    __slots__ = ("values",)

    def __init__(self, values: Sequence[int]) -> None:
        if not values or values[0] < 0 or any(later < earlier for earlier, later in pairwise(values)):
            raise ValueError("a workload curve has at least one value, none negative, and never falls")
        self.values = (0, *values)

    def __repr__(self) -> str:
        return f"TableCurve({self.values[1:]})"

    def total(self, jobs: int) -> int:
        """E(jobs) by the table and its extension."""
        times, rest = divmod(jobs, len(self.values) - 1)
        return times * self.values[-1] + self.values[rest]

    @property
    def mean(self) -> Fraction:
        """E(H) / H, the slope of the extension."""
        return Fraction(self.values[-1], len(self.values) - 1)

    @property
    def floor(self) -> Fraction:
        """The least E(l) / l of the table, which may lie below the slope of the extension."""
        return min(Fraction(total, jobs) for jobs, total in enumerate(self.values) if jobs)

    def repeat(self) -> Repeat:
        """It repeats by construction."""
        return Repeat(0, len(self.values) - 1, self.values[-1])


class FramesCurve(TableCurve):
    """A multiframe task (Mok and Chen): jobs cost frame 1, 2, .. n, 1, .. starting anywhere."""

    __slots__ = ("frames",)

    def __init__(self, frames: Sequence[int]) -> None:
        if not frames or min(frames) < 0:
            raise ValueError("there is at least one frame, and none is negative")
        sums = (0, *accumulate((*frames, *frames)))
        size = len(frames)
        super().__init__([max(sums[at + n] - sums[at] for at in range(size)) for n in range(1, size + 1)])
        self.frames = tuple(frames)

    def __repr__(self) -> str:
        return f"FramesCurve({self.frames})"


class PsmCurve(Curve):
    """The workload curve of a PSM by dynamic programming over all reachable states.

    V_0 = 0, V_l(s) = max over s -c-> t of c + V_{l-1}(t), E(l) = max over s of V_l(s): O(transitions) per job. When
    V_{l+p} = V_l + K in every state, the recursion repeats for ever, which proves E(l + p) = E(l) + K; one checkpoint
    at powers of two finds that (Brent). Where it is not found before the cap H, E(kH + r) <= k E(H) + E(r) is used.
    """

    __slots__ = ("_anchor", "_anchor_at", "_cap", "_edges", "_mean", "_repeat", "_totals", "_values", "psm")

    def __init__(self, psm: Psm) -> None:
        self.psm = psm
        _, edges = reachable_edges(psm)
        # A state without a way out idles at no cost, so that every run goes on.
        self._edges = [out or [(0, state)] for state, out in enumerate(edges)]
        self._cap = min(max(EXACT_JOBS[0], EXACT_WORK // sum(map(len, self._edges))), EXACT_JOBS[1])
        self._values = [0] * len(edges)
        self._totals = [0]
        self._anchor, self._anchor_at = list(self._values), 0
        self._repeat: Repeat | None = None
        self._mean: Fraction | None = None

    def __repr__(self) -> str:
        return f"PsmCurve({self.psm!r})"

    def total(self, jobs: int) -> int:
        """E(jobs): exact up to the cap, and beyond it where the curve is proven to repeat."""
        if jobs >= len(self._totals):
            self._grow(jobs)
            if jobs >= len(self._totals):
                return self._extend(jobs)
        return self._totals[jobs]

    def _extend(self, jobs: int) -> int:
        if self._repeat is not None:
            law = self._repeat
            times, rest = divmod(jobs - law.start, law.jobs)
            return times * law.cost + self._totals[law.start + rest]
        times, rest = divmod(jobs, self._cap)
        return times * self._totals[self._cap] + self._totals[rest]

    def _grow(self, jobs: int) -> None:
        while len(self._totals) <= min(jobs, self._cap) and self._repeat is None:
            last = self._values
            values = [max([cost + last[target] for cost, target in out]) for out in self._edges]
            self._values = values
            self._totals.append(max(values))
            at = len(self._totals) - 1
            gain = values[0] - self._anchor[0]
            if [value - gain for value in values] == self._anchor:
                self._repeat = Repeat(self._anchor_at, at - self._anchor_at, gain)
            elif at & (at - 1) == 0:
                self._anchor, self._anchor_at = values, at

    @property
    def mean(self) -> Fraction:
        """The maximum cycle mean of the PSM."""
        if self._mean is None:
            law = self._repeat
            self._mean = Fraction(law.cost, law.jobs) if law else max_cycle_mean(self.psm)
        return self._mean

    def repeat(self) -> Repeat | None:
        """The law by which the curve repeats; looks for it up to the cap."""
        self._grow(self._cap)
        return self._repeat

    def estimated(self, jobs: int) -> bool:
        """Beyond the cap, unless the curve is proven to repeat."""
        return jobs > self._cap and self.repeat() is None


class AffineCurve(Curve):
    """Another curve with every cost multiplied and every job dearer: E(n) = times x base(n) + n x more."""

    __slots__ = ("base", "more", "times")

    def __init__(self, base: Curve, times: int = 1, more: int = 0) -> None:
        self.base, self.times, self.more = base, times, more

    def __repr__(self) -> str:
        return f"AffineCurve({self.base!r}, {self.times}, {self.more})"

    def total(self, jobs: int) -> int:
        """E(jobs)."""
        return self.times * self.base.total(jobs) + jobs * self.more

    @property
    def mean(self) -> Fraction:
        """The mean of the base, multiplied, and what each job adds."""
        return self.times * self.base.mean + self.more

    @property
    def floor(self) -> Fraction:
        """The floor of the base, multiplied, and what each job adds."""
        return self.times * self.base.floor + self.more

    def repeat(self) -> Repeat | None:
        """It repeats when its base does."""
        law = self.base.repeat()
        return None if law is None else Repeat(law.start, law.jobs, self.times * law.cost + law.jobs * self.more)

    def estimated(self, jobs: int) -> bool:
        """Where the base is."""
        return self.base.estimated(jobs)


class DividedCurve(Curve):
    """Another curve on a processor `speed` times as fast: E(n) = base(n) / speed, rounded up."""

    __slots__ = ("base", "speed")

    def __init__(self, base: Curve, speed: Fraction) -> None:
        self.base, self.speed = base, speed

    def __repr__(self) -> str:
        return f"DividedCurve({self.base!r}, {self.speed})"

    def total(self, jobs: int) -> int:
        """E(jobs)."""
        return -(-self.base.total(jobs) * self.speed.denominator // self.speed.numerator)

    @property
    def mean(self) -> Fraction:
        """The mean of the base over the speed."""
        return self.base.mean / self.speed

    @property
    def floor(self) -> Fraction:
        """The floor of the base over the speed: rounding up only adds to it."""
        return self.base.floor / self.speed

    def repeat(self) -> Repeat | None:
        """Rounded totals are not proven to repeat."""
        return None

    def estimated(self, jobs: int) -> bool:
        """Where the base is."""
        return self.base.estimated(jobs)


def altered(curve: Curve, times: int = 1, more: int = 0) -> Curve:
    """The curve with every cost multiplied by `times` and every job dearer by `more`."""
    if isinstance(curve, ConstantCurve):
        return ConstantCurve(times * curve.cost + more)
    return AffineCurve(curve, times, more)


def workload_curve(psm: Psm, length: int) -> tuple[int, ...]:
    """E(0) .. E(length), exact: the greatest total cost of so many consecutive transitions from any reachable state."""
    curve = PsmCurve(psm)
    curve._cap = max(curve._cap, length)
    return tuple(curve.total(jobs) for jobs in range(length + 1))


def trace(curve: Sequence[int]) -> tuple[int, ...]:
    """e_1, e_2, ...: the differences e_l = E(l) - E(l-1) of E(0), E(1), ... (equations (9) and (10))."""
    return tuple(later - earlier for earlier, later in pairwise(curve))


def approximation_of_runs(runs: Sequence[Sequence[int]]) -> tuple[int, ...]:
    """The approximation of given runs of one length, equations (9) and (10): (7,1,10), (1,10,8), (5,8,2) give (7,6,6).

    e_1 = max over runs t of t_1, e_l = max over t of (t_1 + .. + t_l) - (e_1 + .. + e_{l-1}). Raises ValueError on
    runs of unequal length.
    """
    if len({len(run) for run in runs}) != 1:
        raise ValueError("at least one run, and all of one length")
    sums = [tuple(accumulate(run, initial=0)) for run in runs]
    return trace([max(column) for column in zip(*sums, strict=True)])


def witness_run(psm: Psm, length: int) -> tuple[PsmTransition, ...]:
    """A run of the PSM that attains E(length); shorter where it ends in a state without a transition.

    Takes O(length x states) memory. Ties go to the first state and the first transition in order.
    """
    states, edges = reachable_edges(psm)
    rows = [[0] * len(states)]
    for _ in range(length):
        last = rows[-1]
        rows.append([max([cost + last[target] for cost, target in out], default=0) for out in edges])
    by_pair = {(t.source, t.target): t for t in psm.transitions}
    at = max(range(len(states)), key=lambda state: (rows[-1][state], -state))
    run = []
    for left in range(length - 1, -1, -1):
        if not edges[at]:
            break
        last = rows[left]
        _, best = max(edges[at], key=lambda edge: edge[0] + last[edge[1]])
        run.append(by_pair[states[at], states[best]])
        at = best
    return tuple(run)
