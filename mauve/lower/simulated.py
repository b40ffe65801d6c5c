"""From the tasks of a node to what is simulated: the same tasks, and where in their jobs they hold resources.

The sections are those that the blocking comes from (`tasks.py`): a codel is in the critical section of its provider and
of the shared data that it touches, each handled message anew; a copy of ports holds the connections of its instance.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from mauve.lower.calls import Services, services
from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.lower.sharing import Shared, shared_data, task_uses
from mauve.lower.threads import exchange_cost
from mauve.model.model import CodelId, Deployment, Node
from mauve.timing.simulation.system import Hold, Locked, Processor, SimTask, executed
from mauve.timing.task import Task

EXCHANGE = "port exchange"
"""The name of the workload of a task that copies port data."""


def simulated_processors(
    deployment: Deployment, nodes: Sequence[tuple[NodeTasks, Sequence[Task]]], times: Mapping[CodelId, int]
) -> tuple[Processor, ...]:
    """A processor per node, given its tasks as placed and as analysed (with interrupts, ticks and overheads)."""
    connected = services(deployment.architecture)
    instances = {instance.name: instance for instance in deployment.architecture.instances}
    every = [placed for node, _ in nodes for placed in node.tasks]
    shared = shared_data(every, connected, instances)
    found = []
    for node, tasks in nodes:
        placed = {one.task.name: one for one in node.tasks}
        simulated = [
            _task(task, placed[task.name], node.node, deployment, connected, shared, times)
            if task.name in placed
            else SimTask(task, sporadic=True)
            for task in tasks
        ]
        found.append(Processor(node.node.name, tuple(simulated)))
    return tuple(found)


def _task(
    task: Task,
    placed: PlacedTask,
    node: Node,
    deployment: Deployment,
    connected: Services,
    shared: Shared,
    times: Mapping[CodelId, int],
) -> SimTask:
    held = _held(placed, connected, shared)
    locked = [*_codels(held, times), *_exchange(placed, node, deployment)]
    sporadic = any(instance.sporadic for instance in placed.instances)
    waits = tuple((wait.label, wait.time) for wait in placed.waits)
    return SimTask(executed(task), locked=tuple(locked), sporadic=sporadic, waits=waits)


def _held(placed: PlacedTask, connected: Services, shared: Shared) -> dict[CodelId, list[str]]:
    """Per codel the resources that this task holds while it executes it."""
    found: dict[CodelId, list[str]] = {}
    for _, use in task_uses(placed, connected):
        if use.provider:
            found.setdefault(use.codel, []).append(use.provider)
    for datum, accesses in shared.items():
        for access in accesses:
            if access.task == placed.task.name:
                found.setdefault(access.codel, []).append(str(datum))
    return found


def _codels(held: Mapping[CodelId, list[str]], times: Mapping[CodelId, int]) -> Iterator[Locked]:
    for codel, resources in held.items():
        yield Locked(str(codel), (Hold(tuple(dict.fromkeys(resources)), times[codel]),))


def _exchange(placed: PlacedTask, node: Node, deployment: Deployment) -> Iterator[Locked]:
    sections = []
    for instance in placed.instances:
        sources = [
            f"port {connection.source}"
            for connection in deployment.architecture.data
            if instance.name in (connection.source.instance, connection.target.instance)
        ]
        cost = exchange_cost(node, instance)
        if sources and cost:
            sections.append(Hold(tuple(sources), cost))
    if sections:
        yield Locked(EXCHANGE, tuple(sections))
