"""The alternatives graph, its rules and its budget, on the coral mission."""

from __future__ import annotations

import pytest

from mauve.mission.cascades import Unsafe, cascade, masks
from mauve.mission.graph import AlternativesGraph, BudgetExceeded
from mauve.mission.markings import Explored, explore
from mauve.mission.net import Level
from mauve.mission.stable import alternatives_graph
from mauve.mission.templates import build_net
from mauve.mission.verify import faults, verify
from tests.mission.build import does, graph_of, mission, ways
from tests.mission.coral import coral
from tests.mission.random_missions import random_mission


def test_the_coral_mission_has_the_states_that_one_counts_by_hand() -> None:
    """Each motion objective has, over 8 sets of lost hardware, 4 ways to run and 8 of waiting for its failure."""
    motion = 4 + 8
    before, ended = 8, 2 * 8
    first = 2 * (motion + 8 + 8)  # filming: advancing goes on, or has ended well or badly; the temperature is out or in
    second = 2 * 2 * motion  # filming has ended well or badly, advancing goes on
    third = 2 * 8  # only the temperature is out, and the block will succeed or fail
    graph = graph_of(coral())
    assert len(graph.markings) == before + ended + 4 * motion + first + second + third
    assert (len(graph.net.places), len(graph.net.transitions)) == (222, 248)
    assert (len(graph.markings), len(graph.targets)) == (192, 992)


def test_direct_generation_finds_the_stable_states_of_the_graph_of_all_markings() -> None:
    for plan in (coral(), random_mission(6)):
        graph = graph_of(plan)
        full = explore(graph.net)
        assert isinstance(full, Explored)
        assert full.safe
        assert {full.markings[state] for state in full.stable} == set(graph.markings)


def test_each_edge_is_what_its_cascade_does_without_memory() -> None:
    for plan in (coral(), random_mission(8)):
        graph = graph_of(plan)
        net, table = graph.net, masks(graph.net)
        starts = [index for index, one in enumerate(net.transitions) if one.level is Level.EVENT]
        for state, marking in enumerate(graph.markings):
            direct = {
                net.transitions[start].event: cascade(table, marking, start).result
                for start in starts
                if not table.before[start] & ~marking
            }
            kept = {net.events[event].name: graph.markings[target] for event, target in graph.successors(state)}
            assert kept == direct


def test_one_rule_holds_for_each_event_that_can_happen_and_none_for_others() -> None:
    for plan in (coral(), coral(sensors=2), random_mission(21)):
        graph = graph_of(plan)
        for state, marking in enumerate(graph.markings):
            holding = [
                (rule.event, graph.markings.index(marking & ~rule.cleared | rule.filled))
                for rule in graph.rules
                if marking & rule.tested == rule.value
            ]
            assert sorted(holding) == sorted(graph.successors(state))
        assert len(graph.rules) < len(graph.targets)
        used = set(graph.rules_used)
        assert used == set(range(len(graph.rules)))


def test_more_hardware_multiplies_the_states_but_hardly_the_rules() -> None:
    small, large = graph_of(coral()), graph_of(coral(sensors=2))
    assert len(large.markings) == 928
    assert len(large.markings) / len(small.markings) > 1.5 * len(large.rules) / len(small.rules)


def test_a_budget_names_the_resources_that_multiply_the_states() -> None:
    found = alternatives_graph(build_net(coral(sensors=4)), budget=5_000)
    assert isinstance(found, BudgetExceeded)
    assert found.budget == 5_000
    assert {name for name, _ in found.factors} == {one.name for one in coral(sensors=4).hardware}
    assert all(factor > 1_000 for _, factor in found.factors[:5])
    exact = alternatives_graph(build_net(coral()), budget=192)
    assert isinstance(exact, AlternativesGraph)


def test_the_net_of_a_mission_has_the_shape_it_should() -> None:
    for plan in (coral(), coral(shared=True), *(random_mission(seed) for seed in range(25))):
        assert not faults(plan)
        assert not verify(build_net(plan))


def test_the_exception_carries_a_shortest_run() -> None:
    plan = mission(
        does("O", "u"),
        does("P", "u"),
        activities=(ways("a", ("H", "s"), ("t", "s"), upgrade=True), ways("b", ("s", "t")), ways("u", ("s t", ""))),
        software="",
        shared="s t",
        hardware="H",
    )
    with pytest.raises(Unsafe) as caught:
        alternatives_graph(build_net(plan))
    assert caught.value.run[0] in ("MISSION_EV_START", "H_EV_OOS")
