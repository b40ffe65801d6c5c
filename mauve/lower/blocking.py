"""Critical sections and the blocking they cause (immediate ceiling protocol; semantics of record, section 4).

An operation that runs in its caller executes inside a critical section of its provider. The ceiling of a provider
is the highest priority among its callers' tasks. A task is blocked at most once, by the longest section of a less
urgent task whose ceiling reaches the task's own priority.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from mauve.lower.calls import services, uses
from mauve.model.model import CodelId, Deployment, Instance


@dataclass(frozen=True, slots=True)
class Section:
    """The longest stay of an instance's task in the critical section of `resource`, in picoseconds."""

    resource: str
    holder: str
    operation: str
    length: int


def sections(
    instances: Iterable[Instance], deployment: Deployment, times: Mapping[CodelId, int]
) -> tuple[Section, ...]:
    """The critical sections that the task of these instances enters, one per provider, the longest of each."""
    connected = services(deployment.architecture)
    longest: dict[str, Section] = {}
    for instance in instances:
        for use in uses(instance, connected):
            length = times.get(use.codel)
            if not use.provider or length is None:
                continue
            known = longest.get(use.provider)
            if known is None or length > known.length:
                longest[use.provider] = Section(use.provider, instance.name, use.codel.codel, length)
    return tuple(longest.values())


def blocking(priority: int, tasks: Sequence[tuple[int, tuple[Section, ...]]]) -> Section | None:
    """The section that blocks a task of this priority longest; None where nothing can. `tasks` are (priority,
    sections).
    """
    ceilings: dict[str, int] = {}
    for other, held in tasks:
        for section in held:
            ceilings[section.resource] = max(ceilings.get(section.resource, other), other)
    candidates = [
        section
        for other, held in tasks
        for section in held
        if other < priority and ceilings[section.resource] >= priority
    ]
    return max(candidates, key=lambda section: section.length, default=None)
