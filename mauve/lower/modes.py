"""Which tasks run in a mode of a mission, and as what: an alternative's switch is a mode change of the architecture.

The instances that activities run are *tied*: such an instance is active only while one of its activities runs, and
never in a mission that does not use them. All others, and the controller, always are. An instance whose alternative
says `mode M = state S` has in this mode only the steps that stay in S, where nothing but an event from outside can make
it leave; else, and while it is started, stopped or switched, it has all of its machine.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.model.missions import Controller, Mission, Mode
from mauve.model.model import Component, Deployment, Instance, Region, State
from mauve.records import changed, record
from mauve.timing.psm import Psm, make_psm
from mauve.timing.task import Task, Workload, constant, machine
from mauve.timing.traces import PsmCurve

ANY = ""
"""The state of an instance that has all of its machine."""


@record
class Ties:
    """The instance that each activity runs, and the state that each of its alternatives asks for, as the name of a
    machine and a state of it (`ANY` without one). `tied` are the instances that are active only while one of their
    activities runs, those of activities that the mission does not use included."""

    instances: Mapping[str, str]
    states: Mapping[tuple[str, str], tuple[str, str]]
    tied: frozenset[str]


Active = frozenset[tuple[str, str, str]]
"""The tied instances that are active: instance, machine and state, the latter `ANY` for the whole component."""


def tie(mission: Mission, deployment: Deployment, report: Report) -> Ties | None:
    """What the activities of a mission run in a deployment; None where nothing does, or after MV723."""
    instances: dict[str, str] = {}
    states: dict[tuple[str, str], tuple[str, str]] = {}
    clear = True
    for activity in mission.activities:
        if activity.runs is None or activity.runs.component is None:
            continue
        found = _instances(activity.runs.instance, activity.runs.component, deployment)
        if len(found) != 1:
            clear = False
            report.add(_unclear(activity.name, activity.runs.component, activity.runs.span, found, deployment))
            continue
        instances[activity.name] = found[0].name
        for one in activity.alternatives:
            state = ANY if one.mode is None else kept_state(found[0].component, one.mode)
            if state and one.mode is not None:
                name = ".".join((found[0].name, *one.mode.region))
                states[activity.name, one.name or "only"] = (name, state)
    tied = {*instances.values(), *_idle(mission, deployment)}
    return Ties(instances, states, frozenset(tied)) if clear and tied else None


def _idle(mission: Mission, deployment: Deployment) -> Iterable[str]:
    """The instances that only activities of other missions run, where it is clear which."""
    for activity in mission.others:
        if activity.runs is not None and activity.runs.component is not None:
            found = _instances(activity.runs.instance, activity.runs.component, deployment)
            if len(found) == 1:
                yield found[0].name


def _instances(name: str, component: Component, deployment: Deployment) -> list[Instance]:
    every = deployment.architecture.instances
    named = [instance for instance in every if instance.name == name]
    return named or [instance for instance in every if not name and instance.component == component]


def _unclear(
    activity: str, component: Component, span: object, found: Sequence[Instance], deployment: Deployment
) -> Diagnostic:
    from mauve.source import Span

    assert isinstance(span, Span)
    where = f"`{deployment.architecture.name}` (deployment `{deployment.name}`)"
    if found:
        message = f"`{component.name}` has {len(found)} instances in {where}: which one does `{activity}` run"
        names = ", ".join(f"`{instance.name}`" for instance in found)
        labels = tuple(Label(instance.span, "an instance") for instance in found)
        return Diagnostic("MV723", message, Label(span), labels=labels, help=Fix(f"write one of {names}"))
    message = f"`{component.name}`, which `{activity}` runs, has no instance in {where}"
    return Diagnostic("MV723", message, Label(span), help=Fix(f"add `instance NAME: {component.name}`"))


def kept_state(component: Component, mode: Mode) -> str:
    """The state of a mode, where the component cannot leave it by itself; `ANY` otherwise."""
    state = _state(component, mode)
    if state is None:
        return ANY
    emitted = {event for each in _states(component.regions) for one in each.transitions for event in one.emit}
    leaving = [one for one in state.transitions if one.target != state.name]
    if any(one.event is None or one.event in emitted for one in leaving):
        return ANY
    return state.name


def _state(component: Component, mode: Mode) -> State | None:
    regions, found = component.regions, None
    for name in mode.region or ("",):
        region = next((each for each in regions if each.name == name), None)
        if region is None:
            return None
        found = next((state for state in region.states if state.name == mode.state), None)
        regions = tuple(nested for state in region.states for nested in state.regions)
    return found


def _states(regions: Iterable[Region]) -> list[State]:
    found, open_ = [], list(regions)
    while open_:
        region = open_.pop()
        for state in region.states:
            found.append(state)
            open_ += state.regions
    return found


# ------------------------------------------------------------------------------------------------ active tasks
def active(ties: Ties, running: Iterable[tuple[str, str]]) -> Active:
    """The tied instances that running alternatives need; one that two need in different states has them all."""
    found: dict[str, tuple[str, str]] = {}
    for activity, alternative in running:
        instance = ties.instances.get(activity)
        if instance is not None:
            state = ties.states.get((activity, alternative), (ANY, ANY))
            found[instance] = state if found.get(instance, state) == state else (ANY, ANY)
    return frozenset((instance, *state) for instance, state in found.items())


def during(before: Active, after: Active) -> Active:
    """The tied instances of a switch: those of both modes; one that is not the same in both has all of its machine."""
    changing = {instance for instance, _, _ in before ^ after}
    return frozenset({*(before & after), *((instance, ANY, ANY) for instance in changing)})


def switched(before: Active, after: Active) -> tuple[str, ...]:
    """The instances that a switch starts, stops, or brings into another state."""
    return tuple(sorted({instance for instance, _, _ in before ^ after}))


def tasks_of(nodes: Sequence[NodeTasks], ties: Ties, chosen: Active) -> tuple[NodeTasks, ...]:
    """The tasks of each node that run while these tied instances are active."""
    here = {instance for instance, _, _ in chosen}
    resting = ties.tied - here
    states = {name: state for _, name, state in chosen if state}
    return tuple(
        changed(
            node,
            tasks=tuple(
                _reduced(placed, resting, states)
                for placed in node.tasks
                if not placed.instances or any(instance.name not in resting for instance in placed.instances)
            ),
        )
        for node in nodes
    )


def _reduced(placed: PlacedTask, resting: frozenset[str], states: Mapping[str, str]) -> PlacedTask:
    """A task without the regions of resting instances, and with machines that stay in a state."""
    held = {instance.name for instance in placed.instances}
    if not held & resting and not any(name.partition(".")[0] in held for name in states):
        return placed
    return changed(placed, task=_with_work(placed.task, resting, states))


def _with_work(task: Task, resting: frozenset[str], states: Mapping[str, str]) -> Task:
    work = tuple(_stays(part, states) for part in task.work if part.name.partition(".")[0] not in resting)
    outside = _with_work(task.outside, resting, states) if task.outside is not None else None
    return changed(task, work=work or task.work, outside=outside)


def _stays(part: Workload, states: Mapping[str, str]) -> Workload:
    """The work of a machine that stays in a state, where it is one and can stay there."""
    state = states.get(part.name)
    if state is None or not isinstance(part.curve, PsmCurve):
        return part
    psm = staying(part.curve.psm, state)
    return machine(psm, part.period) if psm is not None else part


def staying(psm: Psm, state: str) -> Psm | None:
    """The machine of the steps that stay in a state; None where there is no such step."""
    loops = [one for one in psm.transitions if one.source == one.target == state]
    return make_psm(psm.name, state, loops) if loops else None


# ------------------------------------------------------------------------------------------------ controllers
def controller_name(mission: Mission) -> str:
    """What the task of a mission's controller is called."""
    return f"controller of {mission.name}"


def with_controllers(
    nodes: Sequence[NodeTasks], missions: Sequence[Mission], report: Report
) -> tuple[NodeTasks, ...]:
    """The tasks with those of controllers that have one of their own; MV723 where the processor is not clear."""
    placed = []
    for mission in missions:
        controller = mission.controller
        if controller is None or controller.wcet is None or controller.period is None or controller.priority is None:
            continue
        if len(nodes) > 1:
            message = f"it is not said on which of {len(nodes)} nodes the controller of `{mission.name}` runs"
            help_ = Fix("let it run an instance: `generate controller runs INSTANCE`")
            report.add(Diagnostic("MV723", message, Label(controller.span), help=help_))
            continue
        placed.append(_controller_task(mission, controller))
    if not placed or len(nodes) != 1:
        return tuple(nodes)
    return (changed(nodes[0], tasks=(*nodes[0].tasks, *placed)),)


def _controller_task(mission: Mission, controller: Controller) -> PlacedTask:
    period, priority = controller.period, controller.priority
    assert period is not None and priority is not None and controller.wcet is not None
    deadline = controller.deadline or changed(period, default="the period")
    work = (constant("controller", controller.wcet),)
    task = Task(controller_name(mission), priority.value, period.value, deadline.value, work)
    return PlacedTask(task, (), (), controller.span, priority, deadline)
