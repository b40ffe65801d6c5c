"""Cascades followed in parts against cascades followed as a whole: small nets, and missions that are not sound."""

from __future__ import annotations

import os
from collections import Counter
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.mission.cascades import Masks, Unsound, masks
from mauve.mission.confluence import _all_orders
from mauve.mission.graph import AlternativesGraph
from mauve.mission.orders import Orders, OverBudget, Unusual
from mauve.mission.stable import alternatives_graph
from mauve.mission.templates import build_net
from tests.mission.random_missions import random_mission
from tests.mission.random_nets import is_stable, random_net

SMALL = 3_000
WANTED = int(os.environ.get("MAUVE_RANDOM_MISSIONS", 12))


def compared(parts: Orders, table: Masks, state: int, event: int) -> str:
    """What a cascade is, as a whole; asserts that in parts nothing else was found.

    "refused": a part has two ends, which come together again later; such a cascade is left to the whole.
    """
    try:
        whole = _all_orders(table, state, [event], SMALL)
    except OverBudget:
        return "large"
    sound = len(whole.ends) == 1 and not whole.unsafe and not whole.endless
    try:
        end, looks = parts.cascade(state, event, 10 * SMALL)
    except (Unusual, OverBudget):
        return "refused" if sound else "unsound"
    assert sound
    assert [end] == list(whole.ends)
    assert (end ^ state) & ~looks == 0
    return "confluent"


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 2**64), st.integers(2, 9))
def test_parts_of_small_nets_find_what_the_whole_does(seed: int, size: int) -> None:
    random = Random(seed)
    net, state = random_net(random, size)
    table = masks(net)
    event = len(net.transitions) - 1
    parts = Orders(table)
    if compared(parts, table, state, event) != "confluent":
        return
    end, looks = Orders(table).cascade(state, event, SMALL)
    other = state & looks | random.getrandbits(2 * size) & ~looks
    if is_stable(table, other):
        again = _all_orders(table, other, [event], SMALL)
        assert list(again.ends) == [end & looks | other & ~looks]
        assert not again.unsafe
        assert not again.endless
        assert compared(parts, table, other, event) == "confluent"


def test_small_nets_are_of_all_kinds() -> None:
    found: Counter[str] = Counter()
    for seed in range(300):
        net, state = random_net(Random(seed), 3 + seed % 6)
        table = masks(net)
        found[compared(Orders(table), table, state, len(net.transitions) - 1)] += 1
    assert found["confluent"] >= 60, found
    assert found["unsound"] >= 60, found


def test_parts_find_every_mistake_of_missions_whose_activities_want_the_same() -> None:
    found: Counter[str] = Counter()
    for seed in range(WANTED):
        net = build_net(random_mission(seed, contended=True))
        table = masks(net)
        try:
            graph = alternatives_graph(net, 3_000)
        except Unsound:
            found["no graph"] += 1
            continue
        if isinstance(graph, AlternativesGraph):
            found.update(_every_rule(graph, table))
    assert found["confluent"] > 20 * WANTED, found
    assert found["unsound"] > WANTED / 2, found
    assert found["refused"] < found["confluent"] / 50, found


def _every_rule(graph: AlternativesGraph, table: Masks) -> Counter[str]:
    """What the cascades of a graph are; each of its rules once, where it was needed first."""
    parts, kinds = Orders(table), Counter[str]()
    starts = {
        name: [index for index, one in enumerate(graph.net.transitions) if one.event == name]
        for name in (event.name for event in graph.net.events)
    }
    met: set[int] = set()
    for state, marking in enumerate(graph.markings):
        for edge in range(graph.first[state], graph.first[state + 1]):
            if graph.rules_used[edge] in met:
                continue
            met.add(graph.rules_used[edge])
            name = graph.net.events[graph.events[edge]].name
            enabled = [index for index in starts[name] if not table.before[index] & ~marking]
            kinds.update(compared(parts, table, marking, index) for index in enabled)
    return kinds
