"""Cuts of blocks put together from those of objectives are what the graph of the whole mission says."""

from __future__ import annotations

import pytest

from mauve.mission.blocks import block_cuts
from mauve.mission.cuts import mission_cuts, objective_cuts
from mauve.mission.formula import SuccessReachable
from mauve.mission.graph import AlternativesGraph
from mauve.mission.stable import alternatives_graph
from mauve.mission.success import check_success
from mauve.mission.survey import Survey, survey
from mauve.mission.templates import build_net

from .coral import coral
from .random_missions import random_mission


def surveyed(seed: int) -> Survey:
    graph = alternatives_graph(build_net(random_mission(seed)))
    assert isinstance(graph, AlternativesGraph)
    return survey(graph)


def test_cuts_of_random_missions_follow_from_their_objectives() -> None:
    several = 0
    for seed in range(25):
        seen = surveyed(seed)
        whole = block_cuts(random_mission(seed), objective_cuts(seen))[0]
        cuts = mission_cuts(seen)
        assert (whole.path, whole.cuts) == ("", cuts), seed
        several += len(whole.cuts) > 1
        # Losing few is losing no cut: at any time is no worse than from the start on.
        assert check_success(seen, SuccessReachable(1)).holds is all(len(cut) > 1 for cut in cuts or ()), seed
    assert several > 2


@pytest.mark.slow
def test_cuts_of_many_random_missions_follow_from_their_objectives() -> None:
    for seed in range(25, 500):
        seen = surveyed(seed)
        assert block_cuts(random_mission(seed), objective_cuts(seen))[0].cuts == mission_cuts(seen), seed


def test_each_block_of_the_coral_mission_has_its_cuts() -> None:
    graph = alternatives_graph(build_net(coral()))
    assert isinstance(graph, AlternativesGraph)
    found = {one.path: one.cuts for one in block_cuts(coral(), objective_cuts(survey(graph)))}
    motion = (("thruster_actuator",), ("gps_sensor", "imu_sensor"))
    assert found[""] == found["LocalizedObservation"] == found["Transect.Survey"] == motion
    assert found["Transect.Survey.Filming"] == ()
    with pytest.raises(KeyError):
        block_cuts(coral(), ())
