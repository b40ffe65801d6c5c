"""From a flow to the chain of tasks that the deployment makes of it.

Each activation of a component hands on what it read: a flow passes one activation of the region that reads where it
comes in and writes where it goes out. Where no region does both, it passes one activation of each. Where several do,
the slowest counts. A component that hands data on after several activations only is not covered.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.model.calls import serves, steps_of
from mauve.model.model import CallMethod, Deployment, Flow, FlowStep, Instance, Region, RegionId, RunCodel, State
from mauve.model.threads import region_ids
from mauve.model.wakeups import waking
from mauve.records import record
from mauve.timing.chains import Hop
from mauve.timing.response import Analysis


@record
class Passage:
    """A task that a flow passes: the hop of the chain, or None where its response has no bound."""

    task: str
    hop: Hop | None


@record
class _Seat:
    """A region of an instance and the task that executes it."""

    region: RegionId
    period: int | None
    placed: PlacedTask
    analysis: Analysis


def flow_hops(
    flow: Flow, deployment: Deployment, nodes: Sequence[tuple[NodeTasks, Analysis | None]]
) -> tuple[Passage, ...]:
    """The tasks that a flow passes in a deployment, in order; one that passes through none of its tasks is empty."""
    instances = {instance.name: instance for instance in deployment.architecture.instances}
    return tuple(
        passage
        for place, step in enumerate(flow.steps)
        for passage in _passages(step, place == 0, instances, deployment, nodes)
    )


def _passages(
    step: FlowStep,
    first: bool,
    instances: Mapping[str, Instance],
    deployment: Deployment,
    nodes: Sequence[tuple[NodeTasks, Analysis | None]],
) -> Iterator[Passage]:
    instance = instances[step.instance]
    seats = list(_seats(instance, nodes))
    reading = touching(instance, step.enters) if step.enters else None
    writing = touching(instance, step.leaves) if step.leaves else None
    comes_in = [seat for seat in seats if not reading or seat.region in reading]
    goes_out = [seat for seat in seats if not writing or seat.region in writing]
    both = [seat for seat in comes_in if seat in goes_out]
    woken = instance.sporadic and (step.woken or first)
    several = len(waking(instance, deployment.architecture.data)) > 1
    if both:
        yield _passage(both, instance, woken, several)
    elif comes_in and goes_out:
        yield _passage(comes_in, instance, woken, several)
        yield _passage(goes_out, instance, False, several)


def _seats(instance: Instance, nodes: Sequence[tuple[NodeTasks, Analysis | None]]) -> Iterator[_Seat]:
    for node, analysis in nodes:
        for placed in node.tasks if analysis is not None else ():
            for one in placed.machines:
                if one.region.instance == instance.name and analysis is not None:
                    own = one.period or (instance.period.value if instance.period else placed.task.period)
                    yield _Seat(one.region, None if instance.sporadic else own, placed, analysis)


def _passage(seats: Sequence[_Seat], instance: Instance, woken: bool, several: bool) -> Passage:
    tasks = list(dict.fromkeys(seat.placed.task.name for seat in seats))
    name = instance.name if tasks == [instance.name] else f"{instance.name} ({', '.join(tasks)})"
    results = [seat.analysis.result(seat.placed.task.name) for seat in seats]
    responses = [result.wcrt for result in results]
    worst = max((response for response in responses if response is not None), default=0)
    if None in responses:
        return Passage(name, None)
    released = [result.from_release for result in results if result.from_release is not None]
    periods = [seat.period for seat in seats]
    known = max((period for period in periods if period is not None), default=None)
    return Passage(
        name,
        Hop(
            name,
            period=None if None in periods else known,
            response=worst,
            # With several wakers the arrivals are not those of the hop before it: the earlier, nominal ones count.
            from_release=worst if several or len(released) < len(results) else max(released),
            woken=woken,
        ),
    )


def touching(instance: Instance, name: str) -> set[RegionId]:
    """The regions that read or write a port, call a method, or serve an operation."""
    return {id_ for id_, region in region_ids(instance) if _touches(region, instance, name)}


def _touches(region: Region, instance: Instance, name: str) -> bool:
    component = instance.component
    operation = next((o for o in component.operations if o.name == name), None)
    for state in region.states:
        if operation is not None and serves(state, component, operation):
            return True
        for step in (*_own_steps(region, state), *(guard for t in state.transitions for guard in t.guards)):
            match step:
                case RunCodel(codel=codel):
                    used = component.codel(codel)
                    if name in used.reads or name in used.writes:
                        return True
                case CallMethod(method=method, arguments=arguments, result=result):
                    if name in (method, result, *arguments):
                        return True
    return False


def _own_steps(region: Region, state: State) -> Iterator[RunCodel | CallMethod]:
    nested = {id(step) for inner in state.regions for step in steps_of(inner)}
    yield from (step for step in steps_of(region) if id(step) not in nested)
