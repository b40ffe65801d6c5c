"""Short ways to write missions in tests, and to walk through their graphs."""

from __future__ import annotations

from mauve.mission.graph import AlternativesGraph, StateView
from mauve.mission.plan import (
    Activity,
    Alternative,
    Block,
    Elementary,
    Hardware,
    Mission,
    OnRecovery,
    Sequence,
    Software,
    Step,
)
from mauve.mission.stable import alternatives_graph
from mauve.mission.templates import build_net
from mauve.mission.verify import faults, verify


def ways(name: str, *alternatives: tuple[str, str], upgrade: bool = False) -> Activity:
    """An activity; each alternative as the resources it takes, and those it offers, separated by blanks."""
    made = tuple(
        Alternative(f"w{number + 1}", tuple(taken.split()), tuple(offered.split()))
        for number, (taken, offered) in enumerate(alternatives)
    )
    return Activity(name, made, OnRecovery.UPGRADE if upgrade else OnRecovery.KEEP)


def does(name: str, *activities: str) -> Elementary:
    return Elementary(name, activities)


def mission(
    *steps: Step | Block, activities: tuple[Activity, ...], software: str = "", shared: str = "", hardware: str = ""
) -> Mission:
    made = tuple(step if isinstance(step, Step) else Step(step) for step in steps)
    soft = [Software(name) for name in software.split()] + [Software(name, shared=True) for name in shared.split()]
    hard = tuple(Hardware(name) for name in hardware.split())
    return Mission("m", Sequence("m", made), activities, tuple(soft), hard)


def graph_of(plan: Mission) -> AlternativesGraph:
    """The graph of a mission that has no faults."""
    assert not faults(plan)
    net = build_net(plan)
    assert not verify(net)
    graph = alternatives_graph(net)
    assert isinstance(graph, AlternativesGraph)
    return graph


def after(graph: AlternativesGraph, events: str) -> StateView:
    """What is seen after these events, each of which must be possible in its turn."""
    state = graph.initial
    for name in events.split():
        possible = {graph.net.events[event].name: target for event, target in graph.successors(state)}
        assert name in possible, f"{name} is not among {sorted(possible)}"
        state = possible[name]
    return graph.view(state)


def possible(graph: AlternativesGraph, events: str) -> set[str]:
    """The events possible after these."""
    state = graph.initial
    for name in events.split():
        state = {graph.net.events[event].name: target for event, target in graph.successors(state)}[name]
    return {graph.net.events[event].name for event, _ in graph.successors(state)}


def running(view: StateView) -> set[str]:
    """Activities and alternatives, as `activity.alternative`."""
    return {f"{activity}.{alternative}" for activity, alternative in view.running}
