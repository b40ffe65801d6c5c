"""Local graphs show of each objective what the graph of the whole mission shows."""

from __future__ import annotations

import pytest

from mauve.mission.cones import Wiring
from mauve.mission.graph import BudgetExceeded, StateView
from mauve.mission.local import local_graphs, local_missions, too_many
from mauve.mission.plan import Child, Mission, Parallel, Retry, Sequence, Step
from tests.mission.build import does, graph_of, mission, ways
from tests.mission.coral import coral
from tests.mission.random_missions import random_mission


def seen(view: StateView, activities: set[str], hardware: set[str]) -> tuple[object, ...]:
    """A view without what is none of these."""
    running = tuple(one for one in view.running if one[0] in activities)
    failed = tuple(one for one in view.failed if one in activities)
    return running, failed, tuple(one for one in view.lost if one in hardware)


@pytest.mark.parametrize("plan", [coral(), coral(shared=True), *(random_mission(seed) for seed in range(2, 9))])
def test_what_runs_for_an_objective_in_the_whole_runs_in_its_local_graph(plan: Mission) -> None:
    whole = graph_of(plan)
    local = local_graphs(plan)
    assert not isinstance(local, BudgetExceeded)
    views = [whole.view(state) for state in range(len(whole.markings))]
    for part, made in zip(local, local_missions(plan), strict=True):
        activities = {one.name for one in made.mission.activities}
        hardware = {one.name for one in made.mission.hardware}
        paths = {path for _, path in part.graph.net.meanings.objectives}
        inside = {
            (tuple(path for path in view.objectives if path in paths), seen(view, activities, hardware))
            for view in (part.graph.view(state) for state in range(len(part.graph.markings)))
        }
        for view in views:
            mine = tuple(path for path in view.objectives if path in paths)
            if mine:
                assert (mine, seen(view, activities, hardware)) in inside


def test_objectives_side_by_side_are_apart_unless_their_cones_overlap() -> None:
    activities = (ways("driver", ("h", "s")), ways("a", ("s", "")), ways("b", ("s", "")), ways("c", ("k", "")))
    block = Parallel("par", tuple(Child(Step(does(name, name.lower()))) for name in "ABC"))
    plan = mission(block, activities=activities, shared="s", hardware="h k")
    parts = local_missions(plan)
    assert [(one.path, [h.name for h in one.mission.hardware]) for one in parts] == [("par", ["h"]), ("par.C", ["k"])]


def test_a_mission_with_thirty_hardware_resources_is_within_reach() -> None:
    local = local_graphs(coral(copies=10))
    assert not isinstance(local, BudgetExceeded)
    assert len(local) == 70
    assert sum(len(one.graph.markings) for one in local) == 1_880
    names = {event.name for one in local for event in one.graph.net.events}
    assert {"Filming_1_EV_OK", "GoingUp_10_EV_FAIL", "gps_3_sensor_EV_OOS"} <= names


def test_a_budget_is_for_all_local_graphs_together() -> None:
    assert isinstance(local_graphs(coral(), budget=100), BudgetExceeded)


def test_a_local_mission_has_the_cone_of_its_objective() -> None:
    plan = coral()
    filming = next(one.mission for one in local_missions(plan) if one.path.endswith("Filming"))
    assert [one.name for one in filming.activities] == ["filming"]
    assert not filming.hardware
    assert not filming.software
    diving = next(one.mission for one in local_missions(plan) if one.path.endswith("Diving"))
    assert {one.name for one in diving.activities} == set(Wiring(plan).closure(["diving"]))


def test_devices_and_retries_never_promise_more_states_than_there_are() -> None:
    for seed in range(40):
        plan = random_mission(seed)
        assert too_many(plan, len(graph_of(plan).markings)) is None, seed


def nested(times: int) -> Mission:
    """An objective tried again and again, in two blocks that are, too."""
    inner = Sequence("b", (Step(does("free"), Retry(times)), Step(does("a", "user"), Retry(times))))
    return mission(
        Step(Sequence("c", (Step(inner, Retry(times)),)), Retry(times)),
        activities=(ways("user", ("h", "")),),
        hardware="h",
    )


def test_nested_retries_multiply_the_states_and_are_named() -> None:
    found = too_many(nested(3), 2 * 4**3 - 1)
    assert found is not None
    assert found.factors == (("h", 2_000), ("c", 4_000), ("c.b", 4_000), ("c.b.free", 4_000))
    assert too_many(nested(3), 2 * 4**3) is None
    assert len(graph_of(nested(3)).markings) > 2 * 4**3
    assert too_many(nested(100), 1_000_000) is not None
