"""Priorities: rate monotonic, deadline monotonic, Audsley's optimal assignment, and ranges that keep every deadline.

Audsley's assignment (1991) fills the levels from the lowest up: whichever task meets its deadline below all that are
left takes the level. It finds an assignment whenever one exists, as long as the response of a task depends on which
tasks are above and which below it, not on their order, and never falls when the task moves down. That is so here for
arbitrary deadlines, given jitter, ceilings (the longest section of a lower task on a resource that this or a higher
one uses) and tasks that are not preempted. It is not where jitter itself follows from responses (tasks woken by the
outputs of others, tasks that suspend themselves): the assignment then is one that holds under the jitters given, to be
analysed again. Assignments with equal priorities are not looked for: giving one of two equals the higher level never
makes the other later.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from enum import Enum

from mauve.records import changed, record
from mauve.timing.blocking import held_by, with_blocking
from mauve.timing.level import Budget, Interference
from mauve.timing.response import STEPS, meets_deadline
from mauve.timing.task import Kind, Task


class Policy(Enum):
    """Where priorities come from."""

    GIVEN = "given"
    RATE_MONOTONIC = "rm"
    DEADLINE_MONOTONIC = "dm"
    OPTIMAL = "optimal"


@record
class Assignment:
    """Distinct priorities n .. 1 of the tasks, in their order; interrupts are left out.

    `priorities` is None where no assignment is found; `stuck` then names the tasks of which none meets its deadline
    below all the others in it.
    """

    priorities: tuple[tuple[str, int], ...] | None
    stuck: tuple[str, ...] = ()


@record
class PriorityRange:
    """The priorities that a task can have, both ends included, such that all deadlines hold while the others keep
    theirs; None for an open end. Empty where there are none."""

    task: str
    now: int
    ranges: tuple[tuple[int | None, int | None], ...]

    def __contains__(self, priority: int) -> bool:
        return any((low is None or low <= priority) and (high is None or priority <= high) for low, high in self.ranges)


def rate_monotonic(periods: Sequence[int]) -> tuple[int, ...]:
    """Distinct priorities n .. 1 (MAUVE paper, IV.D): the shorter period is more urgent, ties by declaration order."""
    order = sorted(range(len(periods)), key=lambda index: (periods[index], index))
    priorities = [0] * len(periods)
    for place, index in enumerate(order):
        priorities[index] = len(periods) - place
    return tuple(priorities)


def assign(tasks: Sequence[Task], policy: Policy, steps: int = STEPS) -> Assignment:
    """The priorities of the tasks by a policy; `GIVEN` gives those they have."""
    ours = [task for task in tasks if task.kind is Kind.TASK]
    match policy:
        case Policy.GIVEN:
            values: Sequence[int] = [task.priority for task in ours]
        case Policy.RATE_MONOTONIC:
            values = rate_monotonic([task.period for task in ours])
        case Policy.DEADLINE_MONOTONIC:
            values = rate_monotonic([task.deadline for task in ours])
        case Policy.OPTIMAL:
            return optimal(tasks, steps)
    return Assignment(tuple((task.name, value) for task, value in zip(ours, values, strict=True)))


def with_priorities(tasks: Sequence[Task], assignment: Assignment) -> list[Task]:
    """The tasks with these priorities, interrupts and ticks above all of them. ValueError where there are none."""
    if assignment.priorities is None:
        raise ValueError("there is no assignment")
    given = dict(assignment.priorities)
    top = max(given.values(), default=0) + 1
    return [changed(task, priority=given.get(task.name, top)) for task in tasks]


def optimal(tasks: Sequence[Task], steps: int = STEPS) -> Assignment:
    """Audsley's assignment, by the trace method; the task with the longest deadline is tried first at each level."""
    # Ties go to the last declared, as they do in rate monotonic priorities.
    left = [task for task in reversed(tasks) if task.kind is Kind.TASK]
    left.sort(key=lambda task: task.jitter - task.deadline)
    handlers = [task for task in tasks if task.kind is not Kind.TASK]
    found: dict[str, int] = {}
    lower: list[Task] = []
    for level in range(1, len(left) + 1):
        blocking = _blocking_above(left, lower)
        for candidate in left:
            others = Interference()
            for other in (*handlers, *left):
                if other is not candidate:
                    others.add(other.interferer)
            blocked = changed(candidate, blocking=max(candidate.blocking, blocking))
            if meets_deadline(blocked, others, Budget(steps)):
                break
        else:
            return Assignment(None, tuple(task.name for task in tasks if task in left))
        found[candidate.name] = level
        left.remove(candidate)
        lower.append(candidate)
    return Assignment(tuple((task.name, found[task.name]) for task in tasks if task.name in found))


def _blocking_above(upper: Sequence[Task], lower: Sequence[Task]) -> int:
    """What a task of `upper` that is below the others of them waits for at most in sections of `lower`."""
    used = {section.resource for task in upper for section in task.sections}
    lengths = [
        section.length for task in lower for section in held_by(task) if section.above_all or section.resource in used
    ]
    return max(lengths, default=0)


Known = dict[tuple[object, ...], bool]


def priority_ranges(tasks: Sequence[Task], steps: int = STEPS) -> tuple[PriorityRange, ...]:
    """Per task the priorities that keep every deadline, by the trace method, ceilings following the priorities.

    Empty where a task suspends itself: what it is to others follows from responses, and so from priorities.
    """
    if any(task.outside is not None for task in tasks):
        return ()
    return tuple(_range(task, tasks, steps) for task in tasks if task.kind is Kind.TASK)


def _range(one: Task, tasks: Sequence[Task], steps: int) -> PriorityRange:
    levels = sorted({task.priority for task in tasks if task.kind is Kind.TASK and task is not one})
    place = next(at for at, task in enumerate(tasks) if task is one)
    known: Known = {}
    positions = [(low, high, _inside(low, high, one.priority)) for low, high in _positions(levels)]

    def in_time(at: int) -> bool:
        """Whether the task itself is in time there; higher up it never responds later."""
        return _meets(place, _moved(place, positions[at][2], tasks), known, steps)

    first = bisect_left(range(len(positions)), True, key=in_time)
    found: list[tuple[int | None, int | None]] = []
    for low, high, at in positions[first:]:
        moved = _moved(place, at, tasks)
        if all(_meets(index, moved, known, steps, place) for index in range(len(moved)) if index != place):
            if found and low is not None and found[-1][1] == low - 1:
                low = found.pop()[0]
            found.append((low, high))
    return PriorityRange(one.name, one.priority, tuple(found))


def _inside(low: int | None, high: int | None, now: int) -> int:
    """A priority of a range."""
    return low if low is not None else high if high is not None else now


def _positions(levels: Sequence[int]) -> list[tuple[int | None, int | None]]:
    """The places for one more task among those of distinct levels: below, at, between and above them."""
    if not levels:
        return [(None, None)]
    found: list[tuple[int | None, int | None]] = [(None, levels[0] - 1)]
    for at, level in enumerate(levels):
        found.append((level, level))
        above = levels[at + 1] - 1 if at + 1 < len(levels) else None
        if above is None or above > level:
            found.append((level + 1, above))
    return found


def _moved(place: int, priority: int, tasks: Sequence[Task]) -> list[Task]:
    """The tasks with that of a place at another priority, interrupts above all, and the blocking that follows."""
    moved = list(tasks)
    moved[place] = changed(moved[place], priority=priority)
    top = max(task.priority for task in moved if task.kind is Kind.TASK) + 1
    for at, task in enumerate(moved):
        if task.kind is not Kind.TASK and task.priority < top:
            moved[at] = changed(task, priority=top)
    return with_blocking(moved)


def _meets(at: int, moved: Sequence[Task], known: Known, steps: int, place: int = -1) -> bool:
    """Whether one task meets its deadline; answers that depend on the same things are kept. `place` is that of the task
    which moves: all that others see of its priority is whether it reaches theirs."""
    task = moved[at]
    if task.kind is not Kind.TASK:
        return True
    key = (at, task.priority if place < 0 else moved[place].priority >= task.priority, task.blocking)
    if key not in known:
        others = Interference()
        for other in moved:
            if other.priority >= task.priority and other is not task:
                others.add(other.interferer)
        known[key] = meets_deadline(task, others, Budget(steps))
    return known[key]
