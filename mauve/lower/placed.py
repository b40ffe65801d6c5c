"""The tasks of a deployment: what each stands for, and which processor it shares."""

from __future__ import annotations

from mauve.lower.machines import Machine
from mauve.model.model import Instance, Node, Setting
from mauve.records import record
from mauve.source import Span
from mauve.timing.task import Section, Task


@record
class PlacedTask:
    """A task with what it stands for: its machines, its instances (not all of their regions need be its own), and the
    span that its messages point at. `locked` says that its process protects shared data by immediate ceilings;
    `blocker` is the section that delays it longest."""

    task: Task
    machines: tuple[Machine, ...]
    instances: tuple[Instance, ...]
    span: Span
    priority: Setting
    deadline: Setting
    locked: bool = False
    blocker: Section | None = None


@record
class NodeTasks:
    """The tasks that share one processor. `complete` is False when a task is missing because a codel has no time."""

    node: Node
    tasks: tuple[PlacedTask, ...]
    complete: bool
