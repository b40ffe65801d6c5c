"""Deadlines and reactions of a mission's modes (semantics of record, section 6).

Checked is every stable mode with the tasks of its running activities, and every edge of the alternatives graph with
the tasks of both its modes. Many modes share their tasks, so each set of tasks is analysed once. The reaction to an
event is bounded, for each instance that a switch touches, by

    [T + R of the detector] + R_controller (+ T_controller if it polls) + T_switched + R_switched

with the responses R of the switch's own set of tasks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from mauve.diagnostics.diagnostic import Report
from mauve.lower.modes import Active, Ties, active, controller_name, during, switched, tasks_of, tie
from mauve.lower.placed import NodeTasks
from mauve.mission.graph import AlternativesGraph
from mauve.mission.net import Event, EventKind
from mauve.mission.survey import survey, trace
from mauve.model.mission_tree import elementary
from mauve.model.missions import Mission
from mauve.model.model import Deployment
from mauve.records import changed, record
from mauve.timing.response import Analysis, ResponseResult
from mauve.timing.task import Kind
from mauve.verdict.missions import MissionResult

Respond = Callable[[Sequence[NodeTasks]], tuple[tuple[NodeTasks, Analysis | None], ...]]
"""The response-time analysis of the tasks of all nodes."""


@record
class Leg:
    """A part of a reaction: a task, how long until it runs (0 where it is woken), and its response."""

    task: str
    wait: int
    response: int

    @property
    def time(self) -> int:
        """Both together."""
        return self.wait + self.response


@record
class Reaction:
    """The bound on the reaction to an event, the largest of all switches that it can cause. `detector` is None where
    the event comes from outside of the model; `bound` is None where a part of it has none (`unbounded` says which)."""

    event: str
    detector: Leg | None
    controller: Leg | None
    switched: Leg | None
    bound: int | None
    unbounded: str = ""


@record
class Failing:
    """A set of tasks in which a deadline is missed: the events that lead to it, whether it is that of a switch, its
    active tied instances, and the results of each node."""

    events: tuple[str, ...]
    switch: bool
    instances: tuple[str, ...]
    nodes: tuple[tuple[NodeTasks, Analysis | None], ...]


@record
class ModesResult:
    """What was found for a mission on a deployment: how many stable modes and switches have how many sets of tasks,
    in which of these a deadline is missed, the reactions, event by event, and the worst result of each task that runs
    in any of them."""

    mission: Mission
    modes: int
    switches: int
    mode_sets: int
    switch_sets: int
    failing: tuple[Failing, ...]
    reactions: tuple[Reaction, ...]
    worst: tuple[ResponseResult, ...]

    @property
    def holds(self) -> bool:
        """Whether each deadline holds in each mode and each switch."""
        return not self.failing


def check_modes(
    result: MissionResult, deployment: Deployment, nodes: Sequence[NodeTasks], respond: Respond, report: Report
) -> ModesResult | None:
    """The modes of a mission on a deployment; None where they are not known, or nothing is tied."""
    ties = tie(result.mission, deployment, report)
    if ties is None or result.graph is None:
        return None
    return _Modes(result, result.graph, ties, nodes, respond).check()


def worst_responses(modes: Iterable[ModesResult]) -> dict[str, ResponseResult]:
    """The worst result of each task over the modes and switches of all missions."""
    found: dict[str, ResponseResult] = {}
    for one in modes:
        for result in one.worst:
            known = found.get(result.task)
            size, least = ((one is None, one or 0) for one in (result.wcrt, known.wcrt if known else 0))
            if known is None or size > least:
                found[result.task] = result
    return found


def in_modes(
    nodes: Iterable[tuple[NodeTasks, Analysis | None]], modes: Sequence[ModesResult]
) -> list[tuple[NodeTasks, Analysis | None]]:
    """The analyses of all tasks together with the worst responses of any mode in place of their own. A response from
    the release is then not known: the one from the nominal arrival is no shorter."""
    worst = worst_responses(modes)
    found: list[tuple[NodeTasks, Analysis | None]] = []
    for node, analysis in nodes:
        if analysis is not None:
            results = tuple(changed(worst.get(r.task, r), from_release=None) for r in analysis.results)
            analysis = changed(analysis, results=results)
        found.append((node, analysis))
    return found


class _Modes:
    """One mission on one deployment; analyses are kept by set of tasks."""

    def __init__(
        self, result: MissionResult, graph: AlternativesGraph, ties: Ties, nodes: Sequence[NodeTasks], respond: Respond
    ) -> None:
        self.mission = result.mission
        self.graph = graph
        self.ties = ties
        self.nodes = nodes
        self.respond = respond
        self.analysed: dict[Active, tuple[tuple[NodeTasks, Analysis | None], ...]] = {}

    def check(self) -> ModesResult:
        """Every stable mode, every edge, every reaction."""
        sets = self._sets()
        first: dict[Active, int] = {}
        for state, chosen in enumerate(sets):
            first.setdefault(chosen, state)
        edges: dict[tuple[Active, Active, int], int] = {}
        for state in range(len(self.graph.markings)):
            for event, target in self.graph.successors(state):
                edges.setdefault((sets[state], sets[target], event), state)
        crossing = {(a, b): (state, event) for (a, b, event), state in reversed(edges.items())}
        seen = survey(self.graph)
        failing = [
            Failing(trace(seen, state), False, _names(chosen), self._analyse(chosen))
            for chosen, state in first.items()
            if not self._holds(chosen)
        ]
        switch_sets = {during(a, b) for a, b in crossing}
        told = set(first)
        for (a, b), (state, event) in crossing.items():
            both = during(a, b)
            if both not in told and not self._holds(both):
                told.add(both)
                events = (*trace(seen, state), self.graph.net.events[event].name)
                failing.append(Failing(events, True, _names(both), self._analyse(both)))
        failing.sort(key=lambda one: len(one.events))
        reactions = self._reactions(edges)
        counts = len(self.graph.markings), len(self.graph.events), len(first), len(switch_sets)
        return ModesResult(self.mission, *counts, tuple(failing), reactions, self._worst())

    def _sets(self) -> list[Active]:
        """The active instances of each state; states that run the same share one."""
        running = self.graph.net.meanings.running
        relevant = sum(1 << place for place in {place for place, _, _ in running})
        known: dict[int, Active] = {}
        interned: dict[Active, Active] = {}
        sets = []
        for marking in self.graph.markings:
            key = marking & relevant
            if key not in known:
                chosen = active(self.ties, [(name, one) for place, name, one in running if key >> place & 1])
                known[key] = interned.setdefault(chosen, chosen)
            sets.append(known[key])
        return sets

    def _analyse(self, chosen: Active) -> tuple[tuple[NodeTasks, Analysis | None], ...]:
        if chosen not in self.analysed:
            self.analysed[chosen] = self.respond(tasks_of(self.nodes, self.ties, chosen))
        return self.analysed[chosen]

    def _holds(self, chosen: Active) -> bool:
        return all(analysis is None or analysis.schedulable for _, analysis in self._analyse(chosen))

    def _worst(self) -> tuple[ResponseResult, ...]:
        """The longest response of each task in any set, None before all others."""
        found: dict[str, ResponseResult] = {}
        for results in self.analysed.values():
            for node, analysis in results:
                for placed in node.tasks if analysis is not None else ():
                    assert analysis is not None
                    result = analysis.result(placed.task.name)
                    known = found.get(result.task)
                    if known is None or _longer(result.wcrt, known.wcrt):
                        found[result.task] = result
        return tuple(found.values())

    # ---------------------------------------------------------------------------------------- reactions
    def _reactions(self, edges: Iterable[tuple[Active, Active, int]]) -> tuple[Reaction, ...]:
        """The worst reaction to each event that switches something, where the controller has a task."""
        controller = self.mission.controller
        if controller is None or (controller.wcet is None and controller.instance is None):
            return ()
        worst: dict[int, Reaction] = {}
        known: dict[tuple[Active, Active, tuple[str, ...]], Reaction | None] = {}
        for before, after, number in edges:
            touched = switched(before, after)
            if not touched:
                continue
            event = self.graph.net.events[number]
            detectors = self._detectors(event, before)
            reaction = known.get((before, after, detectors))
            if reaction is None:
                both = during(before, after)
                reaction = known[before, after, detectors] = self._reaction(both, touched, detectors)
            if reaction is None:
                continue
            reaction = changed(reaction, event=event.name)
            if number not in worst or _size(reaction) > _size(worst[number]):
                worst[number] = reaction
        return tuple(worst[number] for number in sorted(worst))

    def _detectors(self, event: Event, before: Active) -> tuple[str, ...]:
        """The instances that notice an event: those that use the device, or pursue the objective."""
        here = {instance for instance, _, _ in before}
        names: Iterable[str] = ()
        match event.kind:
            case EventKind.LOST | EventKind.RECOVERED:
                names = (one.name for one in self.mission.activities if event.subject in one.needs)
            case EventKind.OK | EventKind.FAIL:
                last = event.subject.rpartition(".")[2].partition("#")[0]
                pursued = (one for one in elementary(self.mission.root) if one.name == last)
                names = (ref.name for one in pursued for ref in one.activities)
            case _:
                pass
        found = {self.ties.instances[name] for name in names if name in self.ties.instances}
        return tuple(sorted(found & here))

    def _reaction(self, both: Active, touched: Sequence[str], detectors: Sequence[str]) -> Reaction | None:
        """The bound of one switch; None where nothing that it touches has a task."""
        results = self._analyse(both)
        reacting = [leg for name in touched for leg in self._legs(results, name)]
        if not reacting:
            return None
        controller = self._controller(results)
        noticed = [leg for name in detectors for leg in self._legs(results, name)]
        parts = [controller, *reacting, *noticed]
        unbounded = next((leg for leg in parts if isinstance(leg, str)), "")
        sure = [leg for leg in reacting if isinstance(leg, Leg)]
        detector = max((leg for leg in noticed if isinstance(leg, Leg)), key=lambda leg: leg.time, default=None)
        last = max(sure, key=lambda leg: leg.time, default=None)
        if unbounded or last is None or not isinstance(controller, Leg):
            return Reaction("", detector, controller if isinstance(controller, Leg) else None, last, None, unbounded)
        bound = (detector.time if detector else 0) + controller.time + last.time
        return Reaction("", detector, controller, last, bound)

    def _legs(self, results: Sequence[tuple[NodeTasks, Analysis | None]], instance: str) -> list[Leg | str]:
        """The tasks that execute an instance: its period and response, or the task's name where that has no bound."""
        legs: list[Leg | str] = []
        for node, analysis in results:
            for placed in node.tasks:
                own = next((one for one in placed.instances if one.name == instance), None)
                if own is not None and analysis is not None:
                    response = analysis.result(placed.task.name).wcrt
                    name = placed.task.name
                    bounded = response is not None and not own.sporadic
                    legs.append(Leg(name, placed.task.period, response or 0) if bounded else name)
        return legs

    def _controller(self, results: Sequence[tuple[NodeTasks, Analysis | None]]) -> Leg | str:
        """The controller's response, after a period of its own where it polls for events."""
        controller = self.mission.controller
        assert controller is not None
        for node, analysis in results:
            for placed in node.tasks:
                mine = placed.task.name == controller_name(self.mission) and placed.task.kind is Kind.TASK
                polls = not controller.sporadic
                if controller.instance is not None:
                    own = next((one for one in placed.instances if one.name == controller.instance.name), None)
                    mine, polls = own is not None, own is not None and not own.sporadic
                if mine and analysis is not None:
                    response = analysis.result(placed.task.name).wcrt
                    return placed.task.name if response is None else Leg(
                        placed.task.name, placed.task.period if polls else 0, response
                    )
        return controller_name(self.mission)


def _longer(one: int | None, other: int | None) -> bool:
    """Whether a response is longer than another one; None is without end."""
    return other is not None and (one is None or one > other)


def _size(reaction: Reaction) -> tuple[bool, int]:
    """Reactions without a bound are the largest."""
    return reaction.bound is None, reaction.bound or 0


def _names(chosen: Active) -> tuple[str, ...]:
    return tuple(sorted({instance for instance, _, _ in chosen}))
