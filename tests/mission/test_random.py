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
PLAIN = 2_000
"""Markings, up to which the full graph is compared state by state in the fast form."""


def check(plan: Mission, inside: int, plain: int, packed: int) -> tuple[bool, bool]:
    """Whether all orders could be followed, and whether the full graph was within reach.

    Asserts all that is asked of a sound mission. inside: markings in cascades, up to which all orders are followed;
    plain and packed: markings up to which the full graph is compared state by state, and by the number of states.
    """
    assert not contentions(plan)
    graph = graph_of(plan)
    found = confluence(graph, inside)
    assert found.holds
    full = explore(graph.net, plain)
    if isinstance(full, Explored):
        assert full.safe
        assert {full.markings[state] for state in full.stable} == set(graph.markings)
        return found.complete, True
    counted = markings_graph(graph.net, packed) if packed else None
    if isinstance(counted, MarkingsGraph):
        assert counted.safe
        assert counted.stable == len(graph.markings)
    return found.complete, isinstance(counted, MarkingsGraph)


def test_random_missions_are_safe_and_confluent_and_their_graphs_agree() -> None:
    wanted = int(os.environ.get("MAUVE_RANDOM_MISSIONS", SOME))
    long = wanted > SOME
    inside, plain, packed = (300_000, 20_000, 2_000_000) if long else (10_000, PLAIN, 0)
    found: Counter[str] = Counter()
    proven = compared = 0
    for seed in range(wanted):
        plan = random_mission(seed)
        found.update(features(plan))
        complete, full = check(plan, inside, plain, packed)
        proven, compared = proven + complete, compared + full
    counts = f"{wanted} missions, {proven} in all orders, {compared} with the full graph, {dict(found)}"
    print(counts)
    assert all(found[one] >= wanted / 10 for one in FEATURES), counts
    assert proven >= (0.98 if long else 0.5) * wanted, counts
    assert compared >= (0.95 if long else 0.4) * wanted, counts
