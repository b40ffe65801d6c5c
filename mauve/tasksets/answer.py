"""A task set to its response times, and to what may change: the composition of the timing room for plain sets."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction

from mauve.records import record
from mauve.tasksets.numbers import format_number
from mauve.tasksets.taskset import Entry, TaskSet, timing_tasks
from mauve.timing.blocking import blocking_sections
from mauve.timing.priorities import Assignment, Policy, PriorityRange, assign, priority_ranges, with_priorities
from mauve.timing.response import Analysis, Method, ResponseResult, analyse
from mauve.timing.sensitivity import Sensitivity, lowest_speed, sensitivity
from mauve.timing.task import Kind, Section, Task


@record
class Request:
    """What to do with a set."""

    method: Method = Method.TRACE
    policy: Policy = Policy.GIVEN
    sensitivity: bool = False


@record
class TaskAnswer:
    """One task of a set with its response; `blocker` is the section that delays it longest."""

    entry: Entry
    task: Task
    result: ResponseResult
    blocker: Section | None
    range: PriorityRange | None


MOST_VARIED = 100
"""Of larger sets only the speed of the processor is varied: the rest takes time that grows with the cube."""

FINER = 1000
"""What may change is searched for in steps so many times finer than the times of the set."""


@record
class Answer:
    """The responses of a set. Times are in ticks, `scale` of them to a unit; those of `sensitivity` in FINER ticks.

    `tasks` are in the order of the set; `assignment` has no priorities where none that holds was found, and the set was
    analysed with those it came with.
    """

    taskset: TaskSet
    method: Method
    policy: Policy
    scale: int
    analysis: Analysis
    tasks: tuple[TaskAnswer, ...]
    handlers: tuple[Task, ...]
    assignment: Assignment
    sensitivity: Sensitivity | None

    @property
    def holds(self) -> bool:
        """Whether every deadline is proven to hold."""
        return self.analysis.schedulable

    @property
    def load(self) -> Fraction:
        """The part of the processor that all of it needs."""
        return sum((task.load for task in self.analysis.tasks), Fraction(0))

    def time(self, ticks: int) -> Fraction:
        """Ticks in the set's unit."""
        return Fraction(ticks, self.scale)

    def varied(self, ticks: int) -> Fraction:
        """The ticks of `sensitivity` in the set's unit."""
        return Fraction(ticks, self.scale * FINER)

    def show(self, ticks: int) -> str:
        """Ticks as text with the unit."""
        unit = self.taskset.unit
        return format_number(self.time(ticks)) + (unit if unit != "1" else "")


def answer(taskset: TaskSet, request: Request) -> Answer:
    """Give priorities, analyse, and vary."""
    given, scale = timing_tasks(taskset)
    assignment = assign(given, request.policy)
    tasks = list(given) if assignment.priorities is None else with_priorities(given, assignment)
    if request.policy is Policy.GIVEN:
        tasks = list(given)
    analysis = analyse(tasks, request.method)
    blockers: Mapping[str, Section | None] = {
        task.name: section for task, section in zip(tasks, blocking_sections(tasks), strict=True)
    }
    seen = {task.name: task for task in analysis.tasks}
    results = {result.task: result for result in analysis.results}
    varied = request.sensitivity and len(taskset.tasks) <= MOST_VARIED
    ranges = {one.task: one for one in priority_ranges(tasks)} if varied else {}
    answers = tuple(
        TaskAnswer(
            entry,
            seen[entry.name],
            results[entry.name],
            _named(blockers[entry.name], seen[entry.name]),
            ranges.get(entry.name),
        )
        for entry in taskset.tasks
    )
    return Answer(
        taskset=taskset,
        method=request.method,
        policy=request.policy,
        scale=scale,
        analysis=analysis,
        tasks=answers,
        handlers=tuple(task for task in analysis.tasks if task.kind is not Kind.TASK),
        assignment=assignment,
        sensitivity=_vary(taskset, assignment, request.policy) if request.sensitivity else None,
    )


def _vary(taskset: TaskSet, assignment: Assignment, policy: Policy) -> Sensitivity:
    given, _ = timing_tasks(taskset, FINER)
    tasks: Sequence[Task] = given
    if policy is not Policy.GIVEN and assignment.priorities is not None:
        tasks = with_priorities(given, assignment)
    if len(taskset.tasks) > MOST_VARIED:
        return Sensitivity((), (), lowest_speed(tasks))
    return sensitivity(tasks)


def _named(section: Section | None, task: Task) -> Section | None:
    """The section, where it is what the task's blocking comes from."""
    return section if section is not None and section.length == task.blocking else None
