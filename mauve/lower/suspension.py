"""Calls that wait: which tasks give the answer, what may not be waited for, and how long it takes at most.

A request is taken up at the owner's next activation and answered when that job ends, at most T + R later: the request
may come just after an activation, the next one is nominally T after that one, and its job ends within R. T is the
period of the region that serves it, R the response of the task that executes it, which counts the requests of all that
may wait (`machines.py`). The caller is then analysed as a task that suspends itself (`timing/suspension.py`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.lower.calls import Services, Use
from mauve.lower.machines import Machine, wait_label
from mauve.lower.placed import PlacedTask, Wait
from mauve.lower.sharing import Shared, task_uses
from mauve.model.calls import serves
from mauve.model.model import Endpoint, Instance, Role
from mauve.model.reachability import components, reversed_graph
from mauve.model.threads import region_ids
from mauve.records import changed
from mauve.timing.psm import CostPart, PsmTransition, map_costs
from mauve.timing.suspension import with_waits
from mauve.timing.task import Task, Workload, machine
from mauve.timing.traces import PsmCurve


def with_calls(
    tasks: Sequence[PlacedTask], connected: Services, shared: Shared, report: Report
) -> tuple[list[PlacedTask], bool]:
    """The tasks with what each waits for, and whether all of it can be analysed: MV312 where threads wait for each
    other, MV313 where one waits for itself, MV314 where one waits in a critical section."""
    if not connected.asked:
        return list(tasks), True
    sound = True
    found: list[PlacedTask] = []
    for placed in tasks:
        waits: dict[str, Wait] = {}
        for instance, use in task_uses(placed, connected):
            if use.waits:
                servers = tuple(_servers(use, tasks))
                label = wait_label(f"{use.provider}.{use.operation}")
                waits.setdefault(label, Wait(label, f"{use.provider}.{use.operation}", servers, use.span))
                sound = _check(placed, instance, use, servers, shared, report) and sound
        found.append(changed(placed, waits=tuple(waits.values())))
    sound = sound and _check_circles(found, report)
    return (found if sound else list(tasks)), sound


def _servers(use: Use, tasks: Sequence[PlacedTask]) -> Iterator[tuple[str, int]]:
    """The tasks that serve an operation, each with the longest time between two activations that do."""
    for placed in tasks:
        owner = next((instance for instance in placed.instances if instance.name == use.provider), None)
        for one in placed.machines if owner is not None else ():
            if owner is not None and one.region.instance == owner.name:
                period = _serving_period(one, owner, use.operation)
                if period is not None:
                    yield placed.task.name, period


def _serving_period(one: Machine, owner: Instance, name: str) -> int | None:
    region = next(region for id_, region in region_ids(owner) if id_ == one.region)
    operation = next(o for o in owner.component.operations if o.name == name)
    states = [state for state in region.states if serves(state, owner.component, operation)]
    own = one.period or (owner.period.value if owner.period else 0)
    every = [a.every or 0 for state in states for a in state.activities if a.role is Role.METHOD]
    return max([own, *every]) if states else None


def _check(
    placed: PlacedTask,
    instance: Instance,
    use: Use,
    servers: Sequence[tuple[str, int]],
    shared: Shared,
    report: Report,
) -> bool:
    called = f"{use.provider}.{use.operation}"
    if any(task == placed.task.name for task, _ in servers):
        message = f"`{placed.task.name}` waits for `{called}`, which it would have to carry out itself"
        help_ = Fix(f"give `{instance.name}` and `{use.provider}` threads of their own, or let it run in its caller")
        report.add(Diagnostic("MV313", message, Label(use.span), labels=(Label(placed.span, "this task"),), help=help_))
        return False
    if not placed.task.preemptive or placed.task.tail:
        message = f"`{placed.task.name}` waits for `{called}`, which is not analysed without preemption"
        help_ = Fix("write `schedule fixed_priority preemptive`")
        report.add(Diagnostic("MV407", message, Label(use.span), help=help_))
        return False
    held = next((n for n in (*use.reads, *use.writes) if Endpoint(instance.name, n) in shared), None)
    if held is not None and placed.locked:
        message = f"`{placed.task.name}` waits for `{called}` while it holds the lock of `{instance.name}.{held}`"
        other = next(a for a in shared[Endpoint(instance.name, held)] if a.task != placed.task.name)
        labels = (Label(other.span, f"task `{other.task}` uses it too"),)
        help_ = Fix(f"copy `{held}` to a variable that only this task uses, and call with that")
        report.add(Diagnostic("MV314", message, Label(use.span), labels=labels, help=help_))
        return False
    return True


def _check_circles(tasks: Sequence[PlacedTask], report: Report) -> bool:
    after = {one.task.name: [task for wait in one.waits for task, _ in wait.servers] for one in tasks}
    spans = {one.task.name: one.waits[0].span for one in tasks if one.waits}
    for circle in components(tuple(after), after, reversed_graph(after)):
        if len(circle) > 1:
            names = "`" + "`, `".join(circle) + "`"
            message = f"the tasks {names} call each other in a circle: each may wait for the other for ever"
            first, *others = (spans[name] for name in circle)
            labels = tuple(Label(span, "and this one") for span in others[:3])
            help_ = Fix("place the components in other threads, or let an operation run in its caller")
            report.add(Diagnostic("MV312", message, Label(first, "this call"), labels=labels, help=help_))
            return False
    return True


def wait_times(placed: PlacedTask, jitters: Mapping[str, int], responses: Mapping[str, int | None]) -> dict[str, int]:
    """How long each wait of a task lasts at most, by its label, given the responses of the tasks that serve it.

    Where several regions serve, another than the one that surely does may take up a request, as late as that one is
    released.
    """
    found: dict[str, int] = {}
    for wait in placed.waits:
        period = max((period for _, period in wait.servers), default=0)
        response = max((responses.get(task) or 0 for task, _ in wait.servers), default=0)
        late = max(jitters.get(task, 0) for task, _ in wait.servers) if len(wait.servers) > 1 else 0
        found[wait.label] = period + late + response
    return found


def suspended(task: Task, waits: Mapping[str, int], blocking: int, response: int) -> Task:
    """A task that waits, as it runs on its platform: with each wait comes a blocking when it resumes."""

    def waiting(one: PsmTransition) -> PsmTransition:
        parts = tuple(p for part in one.parts for p in _resumed(part, waits, blocking))
        return changed(one, cost=one.cost + sum(p.cost for p in parts) - sum(p.cost for p in one.parts), parts=parts)

    def work(part: Workload) -> Workload:
        if not isinstance(part.curve, PsmCurve):
            return part
        return changed(machine(map_costs(part.curve.psm, waiting), part.period), name=part.name)

    return with_waits(task, tuple(work(part) for part in task.work), response)


def _resumed(part: CostPart, waits: Mapping[str, int], blocking: int) -> Iterator[CostPart]:
    if part.label not in waits:
        yield part
        return
    yield changed(part, cost=part.count * waits[part.label])
    if blocking:
        yield CostPart("blocking when it resumes", part.count * blocking, part.count)
