"""Tasks that suspend themselves: they wait, in the middle of a job, for an answer that another task gives.

To itself such a task is busy while it waits: each wait counts as work of its own, and with each resumption comes one
more blocking, for a less urgent task may have entered a critical section meanwhile. Both are costs of the transition
that waits, so `with_waits` takes them as workloads.

To others its jobs do not come apart as its releases do: a job that waited still has all of its work to do when the
next one is released. Let a window of length w begin at t, and job 0 of the task be the first with work in it, x of it
inside. That job ends within R of its arrival a_0, so a_0 >= t + x - R. With C = E(1), J = R - C and
N = ceil((w + J) / T), the jobs after the first N arrive from a_0 + N T >= t + w - (C - x) on, so that no more than
C - x of their work is inside. With x of job 0 and E(N - 1) of the N - 1 jobs after it, that is all. Hence

    in any window of length w a task that suspends itself executes at most C + E(ceil((w + R - C) / T) - 1)

which for one C is the rule of the literature, n C with n = ceil((w + R - C) / T) (Chen et al., "Many suspensions, many
problems", Real-Time Systems 55, 2019). A jitter of 0 is too small: C = 5, T = 10 that waits up to 4 makes a task of 5
below it take 15, not 10. So is the longest wait alone, without what delays the task itself: of (C = 1, T = 5) above
(2, 11) that waits 6 above (2, 53), the last would respond in 5; it takes 6.
"""

from __future__ import annotations

from fractions import Fraction

from mauve.records import changed
from mauve.timing.task import Task, Workload
from mauve.timing.traces import Curve


class CarryInCurve(Curve):
    """C + E(n - 1) for n jobs of a task: a whole job carried into the window, and n - 1 in a row."""

    __slots__ = ("task",)

    def __init__(self, task: Task) -> None:
        self.task = task

    def __repr__(self) -> str:
        return f"CarryInCurve({self.task.name})"

    def total(self, jobs: int) -> int:
        """E(1) + E(jobs - 1)."""
        return self.task.demand(1) + self.task.demand(jobs - 1) if jobs > 0 else 0

    @property
    def mean(self) -> Fraction:
        """The long-run cost per job of the task."""
        return self.task.load * self.task.period

    @property
    def floor(self) -> Fraction:
        """E(l) >= f l of the task, which the curve is never below."""
        parts = (part.curve.floor / (part.period or self.task.period) for part in self.task.work)
        return sum(parts, Fraction(self.task.overhead, self.task.period)) * self.task.period

    def repeat(self) -> None:
        """Not looked for."""

    def estimated(self, jobs: int) -> bool:
        """Whether a part of the work is extended beyond its computed part."""
        task = self.task
        return any(part.curve.estimated(task.activations(part, jobs)) for part in task.work)


def with_waits(task: Task, own: tuple[Workload, ...], response: int) -> Task:
    """The task as one that suspends itself.

    `task` is what it executes, `own` the same work with its waits and a blocking at each resumption, and `response`
    bounds how long after its arrival each of its jobs ends; it is iterated to a fixed point by the caller.
    """
    cost = task.demand(1)
    curve = Workload(task.name, CarryInCurve(task))
    outside = changed(task, work=(curve,), overhead=0, jitter=max(task.jitter, response - cost))
    return changed(task, work=own, outside=outside)
