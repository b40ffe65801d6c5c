"""Critical sections and the blocking they cause (immediate ceiling protocol; semantics of record, section 4).

The ceiling of a resource is the highest priority among the tasks that use it. A task is blocked at most once, by the
longest section of a less urgent task whose ceiling reaches the task's own priority: B_i = max { length : prio < P_i <=
ceiling }. A section without preemption has a ceiling above all tasks; a task that is never preempted once it runs is
one such section as long as its dearest job. A section of a task whose end is not preempted may reach into that end.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from mauve.records import changed
from mauve.timing.task import Kind, Section, Task


def longest(sections: Iterable[Section]) -> tuple[Section, ...]:
    """The longest section of each resource."""
    found: dict[tuple[str, bool], Section] = {}
    for section in sections:
        key = section.resource, section.above_all
        known = found.get(key)
        if known is None or section.length > known.length:
            found[key] = section
    return tuple(found.values())


def blockers(tasks: Sequence[tuple[int, tuple[Section, ...]]]) -> list[Section | None]:
    """Per (priority, sections) of a task the section that blocks it longest; None where nothing can."""
    ceilings: dict[str, int] = {}
    for priority, held in tasks:
        for section in held:
            ceilings[section.resource] = max(ceilings.get(section.resource, priority), priority)
    top = max((priority for priority, _ in tasks), default=0)
    contended = [
        (priority, top if section.above_all else ceilings[section.resource], section)
        for priority, held in tasks
        for section in held
        if section.length
    ]
    contended = [one for one in contended if one[0] < one[1]]
    contended.sort(key=lambda one: -one[2].length)
    result: dict[int, Section | None] = {}
    for priority in {priority for priority, _ in tasks}:
        candidates = (section for below, ceiling, section in contended if below < priority <= ceiling)
        result[priority] = next(candidates, None)
    return [result[priority] for priority, _ in tasks]


def held_by(task: Task) -> tuple[Section, ...]:
    """All sections in which a task delays more urgent ones: its own, its last one, or its whole job."""
    if task.kind is not Kind.TASK:
        return ()
    if not task.preemptive:
        whole = Section("", task.name, f"the whole of `{task.name}`", task.demand(1), above_all=True)
        return (*task.sections, whole)
    if task.tail:
        end = Section("", task.name, f"the end of `{task.name}`", task.tail, above_all=True)
        return (*(_up_to_the_end(section, task) for section in task.sections), end)
    return task.sections


def _up_to_the_end(section: Section, task: Task) -> Section:
    """A section as long as it may last with the end of the job that nothing preempts: nothing says where it lies, and
    one that is left within the end, or right before it, is followed by the rest of that."""
    length = max(section.length, min(section.length + task.tail, task.demand(1)))
    if not section.length or length == section.length:
        return section
    return changed(section, length=length, what=f"{section.what} and the end of `{task.name}`")


def blocking_sections(tasks: Sequence[Task]) -> list[Section | None]:
    """Per task the section of a less urgent one that blocks it longest; None where nothing can."""
    return blockers([(task.priority, held_by(task)) for task in tasks])


def with_blocking(tasks: Sequence[Task]) -> list[Task]:
    """The tasks with the blocking that all their sections cause, where that is more than what they were given."""
    if not any(task.sections or task.tail or not task.preemptive for task in tasks):
        return list(tasks)
    found = blocking_sections(tasks)
    return [
        changed(task, blocking=section.length) if section and section.length > task.blocking else task
        for task, section in zip(tasks, found, strict=True)
    ]
