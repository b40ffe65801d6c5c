"""Properties of missions against their definitions, followed word for word on small graphs."""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from random import Random

import pytest

from mauve.mission.cuts import minimal_hitting_sets, mission_cuts, objective_cuts
from mauve.mission.formula import (
    Active,
    Binary,
    Failure,
    Formula,
    Infix,
    Ltl,
    OutOfService,
    Prefix,
    Running,
    Success,
    SuccessReachable,
    Truth,
    Unary,
)
from mauve.mission.graph import AlternativesGraph, Confluence, Edge, Fired
from mauve.mission.liveness import check_live, dead_states
from mauve.mission.ltl import STILL, check_ltl, counterexample
from mauve.mission.net import EventKind
from mauve.mission.never import never_firing
from mauve.mission.noreturn import lost_success
from mauve.mission.properties import analyse, check_bounded, check_deterministic
from mauve.mission.stable import alternatives_graph
from mauve.mission.success import check_success
from mauve.mission.survey import survey
from mauve.mission.templates import build_net

from .coral import coral
from .graphs import HARDWARE, random_graph
from .test_buchi import truths

GRAPHS = [random_graph(Random(seed)) for seed in range(400)]


Picture = dict[int, set[int]]


def drawn(graph: AlternativesGraph, wanted: Callable[[Edge], bool] = lambda edge: True) -> Picture:
    picture: Picture = {state: set() for state in range(len(graph.markings))}
    for edge in graph.edges():
        if wanted(edge):
            picture[edge.source].add(edge.target)
    return picture


def among(picture: Picture, states: set[int]) -> Picture:
    return {state: picture[state] & states for state in states}


def distances(picture: Picture, start: int) -> dict[int, int]:
    """How many steps away each state is that can be reached."""
    found = {start: 0}
    for _ in picture:
        for state, steps in list(found.items()):
            for target in picture[state]:
                found[target] = min(found.get(target, steps + 1), steps + 1)
    return found


def kind_of(graph: AlternativesGraph, edge: Edge) -> EventKind:
    return next(event.kind for event in graph.net.events if event.name == edge.event)


def ends(graph: AlternativesGraph, outcome: str) -> set[int]:
    return {state for state in range(len(graph.markings)) if graph.view(state).outcome == outcome}


def follow(graph: AlternativesGraph, events: tuple[str, ...]) -> int:
    state = graph.initial
    for name in events:
        state = next(edge.target for edge in graph.edges() if edge.source == state and edge.event == name)
    return state


def sees(graph: AlternativesGraph, state: int, goals: set[int], picture: Picture) -> bool:
    return not goals.isdisjoint(distances(picture, state))


def coral_graph() -> AlternativesGraph:
    graph = alternatives_graph(build_net(coral()))
    assert isinstance(graph, AlternativesGraph)
    return graph


# -------------------------------------------------------------------------------------------------- random graphs
def test_dead_states_are_those_where_recoveries_do_not_help() -> None:
    dead = 0
    for graph in GRAPHS:
        own = {
            edge.source for edge in graph.edges() if kind_of(graph, edge) not in (EventKind.LOST, EventKind.RECOVERED)
        }
        fine = own | ends(graph, "success") | ends(graph, "failure")
        recovering = drawn(graph, lambda edge, graph=graph: kind_of(graph, edge) is EventKind.RECOVERED)
        expected = tuple(s for s in range(len(graph.markings)) if not sees(graph, s, fine, recovering))
        seen = survey(graph)
        assert dead_states(seen) == expected
        verdict = check_live(seen)
        assert verdict.holds is not bool(expected)
        if expected:
            dead += 1
            assert follow(graph, verdict.witness) in expected
            assert len(verdict.witness) == min(distances(drawn(graph), 0)[one] for one in expected)
    assert dead > 20


def test_success_is_lost_where_no_path_leads_to_it() -> None:
    entered = 0
    for graph in GRAPHS:
        picture, goals = drawn(graph), ends(graph, "success")
        hope = {state for state in picture if sees(graph, state, goals, picture)}
        found = lost_success(survey(graph))
        assert set(found.states) == set(picture) - hope - ends(graph, "failure")
        entries = {t for s in hope for t in picture[s] if t in found.states}
        assert found.entries == len(entries) or 0 not in hope
        lengths = distances(among(picture, hope), 0) if 0 in hope else {}
        for point in found.points:
            assert follow(graph, point.events) == point.state
            entered += 1
            if point.events:
                before = [steps for s, steps in lengths.items() if point.state in picture[s]]
                assert len(point.events) == min(before) + 1
    assert entered > 50


def test_success_with_few_losses_is_what_its_definition_says() -> None:
    answers = set()
    for graph in GRAPHS:
        goals = ends(graph, "success")
        reach = check_success(survey(graph), SuccessReachable())
        assert reach.holds == sees(graph, 0, goals, drawn(graph))
        for number, names in ((0, ()), (1, ("R", "S")), (2, ()), (3, HARDWARE)):
            calm = (EventKind.LOST, EventKind.RECOVERED)
            later = drawn(graph, lambda edge, graph=graph, calm=calm: kind_of(graph, edge) not in calm)

            def first(
                edge: Edge, graph: AlternativesGraph = graph, number: int = number, names: tuple[str, ...] = names
            ) -> bool:
                lost = graph.view(edge.target).lost
                subject = edge.event.rpartition("_EV_")[0]
                possible = {one.event for one in graph.edges() if one.source == edge.source}
                chosen = kind_of(graph, edge) is EventKind.FAIL and f"{subject}_EV_OK" in possible
                fits = len(lost) <= number and set(lost) <= set(names or HARDWARE)
                return kind_of(graph, edge) is not EventKind.RECOVERED and not chosen and fits

            reached = set(distances(drawn(graph, first), 0))
            expected = all(sees(graph, state, goals, later) for state in reached)
            verdict = check_success(survey(graph), SuccessReachable(number, names))
            assert verdict.holds == expected
            answers.add((number, expected))
            if not expected:
                assert not sees(graph, follow(graph, verdict.witness), goals, later)
    assert len(answers) == 8


def subsets(names: tuple[str, ...]) -> list[frozenset[str]]:
    return [frozenset(one) for size in range(len(names) + 1) for one in combinations(names, size)]


def minimal(sets: list[frozenset[str]]) -> set[frozenset[str]]:
    return {one for one in sets if not any(other < one for other in sets)}


def test_cuts_are_the_smallest_sets_whose_loss_forces_failure() -> None:
    several = 0
    for graph in GRAPHS:
        seen, goals = survey(graph), ends(graph, "success")
        lost = [frozenset(graph.view(state).lost) for state in range(len(graph.markings))]
        early = drawn(graph, lambda edge, graph=graph: "_OOS" in edge.event or "_RD" in edge.event)
        starts = set(distances(early, 0))
        cuts = []
        for gone in subsets(HARDWARE):
            kept = among(drawn(graph), {state for state in range(len(lost)) if gone <= lost[state]})
            if not any(state in kept and sees(graph, state, goals, kept) for state in starts):
                cuts.append(gone)
        found = mission_cuts(seen)
        assert found is not None
        assert {frozenset(one) for one in found} == minimal(cuts)
        several += len(found) > 1
        for one in objective_cuts(seen):
            done = [lost[edge.source] for edge in graph.edges() if edge.event == f"{one.path}_EV_OK"]
            cuts = [gone for gone in subsets(HARDWARE) if not any(gone <= state for state in done)]
            assert {frozenset(cut) for cut in one.cuts} == minimal(cuts)
    assert several > 5


def test_hitting_sets_hit_everything_and_are_minimal() -> None:
    random = Random(3)
    for _ in range(100):
        sets = [random.getrandbits(6) for _ in range(random.randrange(5))]
        hitting = [one for one in range(64) if all(one & other for other in sets)]
        expected = {one for one in hitting if not any(other != one and other & ~one == 0 for other in hitting)}
        assert set(minimal_hitting_sets(sets)) == expected


ATOMS: list[Formula] = [Running("drive"), Running("drive", "slow"), OutOfService("R"), Active("B"), Active("A"),
                        Success(), Failure(), Truth(True)]  # fmt: skip


def random_formula(random: Random, size: int) -> Formula:
    if size <= 1:
        return random.choice(ATOMS)
    if random.random() < 0.4:
        return Prefix(random.choice(list(Unary)), random_formula(random, size - 1))
    left = random.randrange(1, size)
    return Infix(random_formula(random, left), random.choice(list(Binary)), random_formula(random, size - left))


def letter(graph: AlternativesGraph, state: int) -> frozenset[Formula]:
    """The atoms that hold of a state, told from its view."""
    view = graph.view(state)
    true: set[Formula] = {Active(part) for path in view.objectives for part in path.split(".")}
    for activity, alternative in view.running:
        true |= {Running(activity), Running(activity, alternative)}
    true |= {OutOfService(name) for name in view.lost}
    true |= {Success()} if view.outcome == "success" else {Failure()} if view.outcome == "failure" else set()
    return frozenset(true)


def random_lasso(random: Random, graph: AlternativesGraph) -> tuple[list[int], int]:
    """States of a random run that came back to one of its own, and the place of that one."""
    run = [0]
    while True:
        nexts = [target for _, target in graph.successors(run[-1])] or [run[-1]]
        if random.random() < 0.3 and set(nexts) & set(run):
            return run, run.index(random.choice([one for one in nexts if one in run]))
        run.append(random.choice(nexts))


def test_logic_agrees_with_the_runs_themselves() -> None:
    random, violated = Random(11), 0
    for graph in GRAPHS[::2]:
        for _ in range(4):
            formula = random_formula(random, random.randrange(1, 8))
            found = counterexample(graph, formula)
            verdict = check_ltl(graph, Ltl("it", formula))
            assert verdict.holds is (found is None)
            if found is None:
                for _ in range(5):
                    run, back = random_lasso(random, graph)
                    word = [letter(graph, state) for state in run]
                    assert truths(formula, (word[:back], word[back:]))[0]
                continue
            violated += 1
            names = (*found.prefix, *found.cycle)
            assert len(found.states) == len(names) + 1
            for at, name in enumerate(names):
                source, target = found.states[at], found.states[at + 1]
                ways = {(graph.net.events[event].name, to) for event, to in graph.successors(source)}
                assert (name, target) in (ways or {(STILL, source)})
            word = [letter(graph, state) for state in found.states]
            if found.cycle:
                assert found.states[-1] == found.states[len(found.prefix)]
                assert not truths(formula, (word[: len(found.prefix)], word[len(found.prefix) : -1]))[0]
            else:  # any continuation: here one of them
                state, more = found.states[-1], []
                while state not in more:
                    more.append(state)
                    state = next((to for _, to in graph.successors(state)), state)
                run = [*found.states[:-1], *more]
                back = len(found.states) - 1 + more.index(state)
                word = [letter(graph, one) for one in run]
                assert not truths(formula, (word[:back], word[back:]))[0]
    assert 150 < violated < 700


# ---------------------------------------------------------------------------------------------- the coral mission
MOTION = (("thruster_actuator",), ("gps_sensor", "imu_sensor"))


def test_the_coral_mission_has_the_cuts_of_its_paper() -> None:
    seen = survey(coral_graph())
    cuts = {one.path.rpartition(".")[2]: {frozenset(cut) for cut in one.cuts} for one in objective_cuts(seen)}
    assert mission_cuts(seen) == MOTION
    for name in ("ManualMoving", "Isospheric", "Diving", "Advancing", "GoingUp"):
        assert cuts[name] == {frozenset(cut) for cut in MOTION}
    assert cuts["Filming"] == cuts["MeasuringTemperature"] == set()


def test_the_coral_mission_bears_the_loss_of_one_sensor() -> None:
    seen = survey(coral_graph())
    sensors = ("gps_sensor", "imu_sensor")
    assert check_success(seen, SuccessReachable(1, sensors)).holds
    both = check_success(seen, SuccessReachable(2, sensors))
    assert (both.holds, both.witness) == (False, ("gps_sensor_EV_OOS", "imu_sensor_EV_OOS"))
    assert not check_success(seen, SuccessReachable(1)).holds


def always(left: Formula, right: Formula) -> Formula:
    return Prefix(Unary.ALWAYS, Infix(left, Binary.IMPLIES, right))


def test_the_coral_mission_never_drives_blind() -> None:
    graph = coral_graph()
    gone = OutOfService("thruster_actuator")
    assert check_ltl(graph, Ltl("no_blind_drive", always(Running("thruster_driver"), Prefix(Unary.NOT, gone)))).holds
    verdict = check_ltl(graph, Ltl("by_gps", always(Active("Transect"), Running("localisation", "gps"))))
    assert verdict.holds is False
    assert len(verdict.witness) == 4 and verdict.witness[-1] == "Isospheric_EV_OK"
    assert check_ltl(graph, Ltl("end", Prefix(Unary.EVENTUALLY, Success()))).note.startswith("then for ever:")
    many: Formula = Prefix(Unary.EVENTUALLY, Active("x1"))
    for at in range(2, 14):
        many = Infix(many, Binary.OR, Prefix(Unary.ALWAYS, Active(f"x{at}")))
    assert check_ltl(graph, Ltl("huge", many)).holds is None


def test_the_answers_to_all_come_in_the_order_asked() -> None:
    graph = coral_graph()
    shown = Confluence(True, 100, 1000, 3, (), (), ())
    answers = analyse(graph, shown, (SuccessReachable(1, ("gps_sensor",)), SuccessReachable()))
    assert [(one.name, one.holds) for one in answers.verdicts] == [
        ("bounded", True),
        ("deterministic", True),
        ("live", True),
        ("success_reachable", True),
        ("success_reachable_with_1_lost_of_gps_sensor", True),
    ]
    assert answers.verdicts[3].witness[0] == "MISSION_EV_START"
    assert answers.cuts == MOTION
    assert answers.lost.points[0].events == ("thruster_actuator_EV_OOS", "MISSION_EV_START")


def test_confluence_gives_the_verdicts_on_order() -> None:
    graph = coral_graph()
    seen = survey(graph)
    partly = Confluence(False, 100, 1000, 3, (), (), ())
    assert check_bounded(partly).holds is check_deterministic(seen, partly).holds is None
    assert check_bounded(Confluence(True, 1, 1, 3, (), ("gps.free",), ())).holds is False
    fired = Fired(1, "MISSION_EV_START", (("a",), ("b",)), (graph.view(1), graph.view(2)), (0, 1))
    verdict = check_deterministic(seen, Confluence(True, 1, 1, 3, (fired,), (), ()))
    assert verdict.holds is False and verdict.witness[-1] == "MISSION_EV_START" and " or in " in verdict.note
    stuck = analyse(graph, Confluence(True, 1, 1, 3, (), (), (5,))).verdicts[2]
    assert (stuck.name, stuck.holds, follow(graph, stuck.witness)) == ("live", False, 5)


def test_an_event_transition_that_never_fires_is_named() -> None:
    never = never_firing(survey(coral_graph()))
    net = coral_graph().net
    assert never.events == ()
    assert set(never.transitions) <= {one.name for one in net.transitions}
    empty = random_graph(Random(0))
    happened = {edge.event for edge in empty.edges()}
    assert set(never_firing(survey(empty)).events) == {event.name for event in empty.net.events} - happened


@pytest.mark.slow
def test_a_hundred_thousand_states_are_analysed_in_seconds() -> None:
    from time import process_time

    graph = alternatives_graph(build_net(coral(sensors=5)))
    assert isinstance(graph, AlternativesGraph) and len(graph.markings) > 50_000
    start = process_time()
    seen = survey(graph)
    cuts, objectives, lost = mission_cuts(seen), objective_cuts(seen), lost_success(seen)
    assert process_time() - start < 6  # well below 2 s on a quiet machine
    assert cuts is not None and len(cuts) == 2 and len(objectives) == 7 and lost.states
