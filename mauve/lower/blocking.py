"""Critical sections and the blocking they cause (immediate ceiling protocol; semantics of record, section 4).

Sections are the operations of a provider that run in their callers, the accesses to shared data under a lock, and the
exchange of a port's data. The ceiling of a resource is the highest priority among the tasks that use it. A task is
blocked at most once, by the longest section of a less urgent task whose ceiling reaches the task's own priority.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from mauve.records import record


@record
class Section:
    """A stay of `holder` in the critical section of `resource`: `length` picoseconds at most. `what` it does there, in
    words."""

    resource: str
    holder: str
    what: str
    length: int


def longest(sections: Iterable[Section]) -> tuple[Section, ...]:
    """The longest section of each resource."""
    found: dict[str, Section] = {}
    for section in sections:
        known = found.get(section.resource)
        if known is None or section.length > known.length:
            found[section.resource] = section
    return tuple(found.values())


def blockers(tasks: Sequence[tuple[int, tuple[Section, ...]]]) -> list[Section | None]:
    """Per (priority, sections) of a task the section that blocks it longest; None where nothing can."""
    ceilings: dict[str, int] = {}
    for priority, held in tasks:
        for section in held:
            ceilings[section.resource] = max(ceilings.get(section.resource, priority), priority)
    contended = [
        (priority, ceilings[section.resource], section)
        for priority, held in tasks
        for section in held
        if section.length and priority < ceilings[section.resource]
    ]
    result: dict[int, Section | None] = {}
    for priority in {priority for priority, _ in tasks}:
        candidates = (section for below, ceiling, section in contended if below < priority <= ceiling)
        result[priority] = max(candidates, key=lambda section: section.length, default=None)
    return [result[priority] for priority, _ in tasks]
