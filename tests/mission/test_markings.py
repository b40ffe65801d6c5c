"""The graph of all markings: the packed search against the plain one."""

from __future__ import annotations

import pytest

from mauve.mission.graph import BudgetExceeded, MarkingsGraph
from mauve.mission.markings import Explored, explore, markings_graph
from mauve.mission.templates import build_net
from tests.mission.coral import coral
from tests.mission.random_missions import random_mission


@pytest.mark.parametrize("seed", [2, 6, 8, 13])
def test_the_packed_search_counts_what_the_plain_one_finds(seed: int | None) -> None:
    net = build_net(coral() if seed is None else random_mission(seed))
    full = explore(net)
    assert isinstance(full, Explored)
    packed = markings_graph(net, plain=0)
    assert packed == MarkingsGraph(len(full.markings), len(full.edges), len(full.stable), full.safe)


def test_the_coral_mission_has_so_many_markings() -> None:
    assert markings_graph(build_net(coral())) == MarkingsGraph(9_596, 13_619, 192, True)


def test_both_searches_keep_a_budget() -> None:
    net = build_net(coral())
    assert isinstance(explore(net, 1_000), BudgetExceeded)
    assert isinstance(markings_graph(net, 1_000), BudgetExceeded)
    assert isinstance(markings_graph(net, 1_000, plain=0), BudgetExceeded)
