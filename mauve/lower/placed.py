"""The tasks of a deployment: what each stands for, and which processor it shares."""

from __future__ import annotations

from mauve.lower.machines import Machine
from mauve.model.model import Instance, Node, Setting
from mauve.records import record
from mauve.source import Span
from mauve.timing.task import Section, Task


@record
class Wait:
    """What a task waits for in the middle of a job: the `operation` of its owner, the tasks that serve it, each with
    the time between two activations that do, and how long it takes at most (0 until that is known). `label` is what
    the wait is called in the task's machines."""

    label: str
    operation: str
    servers: tuple[tuple[str, int], ...]
    span: Span
    time: int = 0


@record
class PlacedTask:
    """A task with what it stands for: its machines, its instances (not all of their regions need be its own), and the
    span that its messages point at. `locked` says that its process protects shared data by immediate ceilings;
    `blocker` is the section that delays it longest; `waits` are the operations of other tasks that it waits for."""

    task: Task
    machines: tuple[Machine, ...]
    instances: tuple[Instance, ...]
    span: Span
    priority: Setting
    deadline: Setting
    locked: bool = False
    blocker: Section | None = None
    waits: tuple[Wait, ...] = ()


@record
class NodeTasks:
    """The tasks that share one processor. `complete` is False when a task is missing because a codel has no time."""

    node: Node
    tasks: tuple[PlacedTask, ...]
    complete: bool
