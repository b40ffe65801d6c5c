"""A task set as it was written: exact times in its own unit, and where each thing stands in the file."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from fractions import Fraction
from typing import Protocol

from mauve.model.priorities import rate_monotonic
from mauve.records import record
from mauve.source import SourceFile, Span
from mauve.tasksets.numbers import common_scale
from mauve.timing.psm import PsmTransition, make_psm
from mauve.timing.task import (
    Interrupt,
    Platform,
    Section,
    Task,
    Workload,
    constant,
    frames,
    machine,
    on_platform,
    table,
)

SCHEMA = "mauve.taskset/1"

MOST_TASKS = 10_000
"""A larger set is refused: its analysis would take minutes, and no processor runs so many tasks."""

Path = tuple[str | int, ...]
"""The way to a thing in a file: ("tasks", 2, "T")."""


class Scheduler(Enum):
    """Whether a more urgent task preempts one that runs."""

    PREEMPTIVE = "preemptive"
    NON_PREEMPTIVE = "non-preemptive"


class Spans(Protocol):
    """Where the things of a file stand."""

    @property
    def file(self) -> SourceFile:
        """The file."""

    def of(self, path: Path) -> Span:
        """The span of a thing, or of the nearest one around it that is known."""


class KnownSpans:
    """Spans that were noted while the file was read."""

    __slots__ = ("file", "known")

    def __init__(self, file: SourceFile, known: dict[Path, Span]) -> None:
        self.file, self.known = file, known

    def of(self, path: Path) -> Span:
        """The span of a thing, or of the nearest one around it that is known."""
        for length in range(len(path), -1, -1):
            if path[:length] in self.known:
                return self.known[path[:length]]
        return Span(self.file, 0, 0)


@record
class Edge:
    """A transition of a machine and its cost."""

    source: str
    target: str
    cost: Fraction


@record
class Machine:
    """A periodic state machine."""

    initial: str
    edges: tuple[Edge, ...]


@record
class Work:
    """What jobs cost: exactly one of a constant, frames that cycle, the greatest cost of 1, 2, .. jobs, a machine."""

    constant: Fraction | None = None
    frames: tuple[Fraction, ...] = ()
    curve: tuple[Fraction, ...] = ()
    machine: Machine | None = None

    def values(self) -> Iterator[Fraction]:
        """Every cost in it."""
        if self.constant is not None:
            yield self.constant
        yield from self.frames
        yield from self.curve
        if self.machine is not None:
            yield from (edge.cost for edge in self.machine.edges)

    @property
    def dearest(self) -> Fraction:
        """The cost of the dearest job."""
        return self.curve[0] if self.curve else max(self.values())


@record
class Entry:
    """A task: times in the set's unit; None where the file does not say (deadline: the period; priority: by rate).

    `sections` are stays in resources; `unpreempted` the longest stretch that no other task preempts (its end only, for
    `tail`); `path` where it stands in the file.
    """

    name: str
    period: Fraction
    work: Work
    path: Path
    deadline: Fraction | None = None
    priority: int | None = None
    jitter: Fraction = Fraction(0)
    blocking: Fraction = Fraction(0)
    sections: tuple[tuple[str, Fraction], ...] = ()
    unpreempted: Fraction = Fraction(0)
    tail: Fraction = Fraction(0)
    preemptive: bool = True

    def values(self) -> Iterator[Fraction]:
        """Every time in it."""
        yield from (self.period, self.jitter, self.blocking, self.unpreempted, self.tail)
        if self.deadline is not None:
            yield self.deadline
        yield from (length for _, length in self.sections)
        yield from self.work.values()


@record
class Handler:
    """An interrupt or a tick above all tasks."""

    name: str
    period: Fraction
    cost: Fraction


@record
class TaskSet:
    """The tasks of one processor. `unit` is a label; `name` is for messages and may be empty."""

    name: str
    scheduler: Scheduler
    unit: str
    tasks: tuple[Entry, ...]
    spans: Spans
    path: Path = ()
    context_switch: Fraction = Fraction(0)
    interrupts: tuple[Handler, ...] = ()

    @property
    def scale(self) -> int:
        """Ticks per unit: all times are whole numbers of ticks."""
        values = [self.context_switch, *(v for one in self.interrupts for v in (one.period, one.cost))]
        return common_scale([*values, *(value for entry in self.tasks for value in entry.values())])


@record
class Document:
    """What a file holds: a set or a list of them, None for one that is in error."""

    sets: tuple[TaskSet | None, ...]
    listed: bool = False


UNREADABLE = Document((None,))


def priorities(taskset: TaskSet) -> tuple[int, ...]:
    """The priorities, those that are missing by rate monotonic order around those that are written."""
    scale = taskset.scale
    return rate_monotonic([(_order(entry.period, scale), entry.priority) for entry in taskset.tasks])


def _order(value: Fraction, scale: int) -> int:
    return value.numerator * (scale // value.denominator)


def timing_tasks(taskset: TaskSet, finer: int = 1) -> tuple[tuple[Task, ...], int]:
    """The tasks in ticks, with context switches, interrupts and ticks of the platform; and the ticks per unit, which
    are `finer` times as many as the times of the set need."""
    scale = taskset.scale * finer

    def ticks(value: Fraction) -> int:
        return _order(value, scale)

    rigid = taskset.scheduler is Scheduler.NON_PREEMPTIVE
    tasks = []
    for entry, priority in zip(taskset.tasks, priorities(taskset), strict=True):
        sections = [
            Section(resource, entry.name, f"`{resource}`", ticks(length)) for resource, length in entry.sections
        ]
        if entry.unpreempted:
            sections.append(Section("", entry.name, "a stretch without preemption", ticks(entry.unpreempted), "", True))
        period = ticks(entry.period)
        tasks.append(
            Task(
                name=entry.name,
                priority=priority,
                period=period,
                deadline=period if entry.deadline is None else ticks(entry.deadline),
                work=(_workload(entry, scale),),
                jitter=ticks(entry.jitter),
                blocking=ticks(entry.blocking),
                sections=tuple(sections),
                preemptive=entry.preemptive and not rigid,
                tail=ticks(entry.tail),
            )
        )
    handlers = tuple(Interrupt(one.name, ticks(one.period), ticks(one.cost)) for one in taskset.interrupts)
    return on_platform(tasks, Platform(ticks(taskset.context_switch), handlers)), scale


def _workload(entry: Entry, scale: int) -> Workload:
    work = entry.work
    if work.machine is not None:
        arrows = [PsmTransition(edge.source, edge.target, _order(edge.cost, scale)) for edge in work.machine.edges]
        return machine(make_psm(entry.name, work.machine.initial, arrows))
    if work.frames:
        return frames(entry.name, [_order(cost, scale) for cost in work.frames])
    if work.curve:
        return table(entry.name, [_order(cost, scale) for cost in work.curve])
    return constant(entry.name, _order(work.constant or Fraction(0), scale))
