"""Random missions: 1-safe, confluent in all orders, and the direct graph has the stable states of the full one.

Forty of them here; a thousand where MAUVE_RANDOM_MISSIONS=1000 is set.
"""

from __future__ import annotations

import os
from collections import Counter

from mauve.mission.confluence import confluence
from mauve.mission.contention import contentions
from mauve.mission.graph import MarkingsGraph
from mauve.mission.markings import Explored, explore, markings_graph
from mauve.mission.plan import Mission
from tests.mission.build import graph_of
from tests.mission.random_missions import FEATURES, features, random_mission

SOME = 40
PLAIN = 1_000
"""Transient markings, up to which the full graph is compared state by state in the fast form."""


def check(plan: Mission, inside: int, plain: int, packed: int) -> bool:
    """Whether the full graph was within reach; asserts all that is asked of a sound mission.

    inside: markings in cascades, up to which all orders are followed.
    """
    assert not contentions(plan)
    graph = graph_of(plan)
    found = confluence(graph, inside)
    assert found.complete or inside < 1_000_000
    assert found.holds
    if found.complete and found.markings <= plain:
        full = explore(graph.net)
        assert isinstance(full, Explored)
        assert full.safe
        assert {full.markings[state] for state in full.stable} == set(graph.markings)
        return True
    counted = markings_graph(graph.net, packed) if packed else None
    if isinstance(counted, MarkingsGraph):
        assert counted.safe
        assert counted.stable == len(graph.markings)
    return isinstance(counted, MarkingsGraph)


def test_random_missions_are_safe_and_confluent_and_their_graphs_agree() -> None:
    wanted = int(os.environ.get("MAUVE_RANDOM_MISSIONS", SOME))
    inside, plain, packed = (3_000, PLAIN, 0) if wanted <= SOME else (5_000_000, 20_000, 3_000_000)
    found: Counter[str] = Counter()
    compared = 0
    for seed in range(wanted):
        plan = random_mission(seed)
        found.update(features(plan))
        compared += check(plan, inside, plain, packed)
    assert all(found[one] >= wanted / 10 for one in FEATURES), found
    assert compared >= (0.5 if wanted <= SOME else 0.99) * wanted
