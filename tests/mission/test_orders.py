"""Cascades followed in parts against cascades followed as a whole: small nets, and missions that are not sound."""

from __future__ import annotations

import os
from collections import Counter
from random import Random

from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.mission.confluence import _all_orders
from mauve.mission.graph import AlternativesGraph
from mauve.mission.net import Event, EventKind, Level, Net, Transition
from mauve.mission.orders import Orders, OverBudget, Unusual
from mauve.mission.stable import Masks, Unsound, alternatives_graph, armed, masks
from mauve.mission.templates import build_net
from tests.mission.random_missions import random_mission

GO = Event("GO", EventKind.OTHER)
SMALL = 3_000
WANTED = int(os.environ.get("MAUVE_RANDOM_MISSIONS", 20))


def net_of(random: Random, size: int) -> tuple[Net, int]:
    """A net of a few levels with one event, its places in pairs that mostly pass a token on, and a stable marking."""
    places = range(2 * size)
    state = random.getrandbits(2 * size) | 1
    steps: list[Transition] = []
    for index in range(random.randint(size, 2 * size)):
        before = random.sample(places, random.choice((1, 1, 2, 2, 3)))
        reads = [one for one in before[1:] if random.random() < 0.3]
        after = [one ^ 1 if random.random() < 0.6 else random.choice(places) for one in before if one not in reads]
        after += random.sample(places, random.choice((0, 0, 1)))
        filled = tuple(dict.fromkeys((*reads, *after)))
        if all(state >> one & 1 for one in before) or set(before) <= set(filled):
            continue
        level = Level(random.choice((1, 2, 2, 4, 4, 4)))
        steps.append(Transition(f"t{index}", tuple(before), filled, level))
    free = [one for one in places if not state >> one & 1]
    chosen = random.sample(free, min(len(free), random.randint(1, 4)))
    steps.append(Transition("go", (0,), tuple(chosen), Level.EVENT, "GO"))
    initial = tuple(one for one in places if state >> one & 1)
    return Net("small", tuple(f"p{one}" for one in places), tuple(steps), initial, (GO,)), state


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


def stable(table: Masks, state: int) -> bool:
    live = armed(table, state)
    return not any(live >> index & 1 and not needed & ~state for index, needed in enumerate(table.before))


@settings(max_examples=200, deadline=None)
@given(st.integers(0, 2**64), st.integers(2, 9))
def test_parts_of_small_nets_find_what_the_whole_does(seed: int, size: int) -> None:
    random = Random(seed)
    net, state = net_of(random, size)
    table = masks(net)
    event = len(net.transitions) - 1
    parts = Orders(table)
    if compared(parts, table, state, event) != "confluent":
        return
    end, looks = Orders(table).cascade(state, event, SMALL)
    other = state & looks | random.getrandbits(2 * size) & ~looks
    if stable(table, other):
        again = _all_orders(table, other, [event], SMALL)
        assert list(again.ends) == [end & looks | other & ~looks]
        assert not again.unsafe
        assert not again.endless
        assert compared(parts, table, other, event) == "confluent"


def test_small_nets_are_of_all_kinds() -> None:
    found: Counter[str] = Counter()
    for seed in range(300):
        net, state = net_of(Random(seed), 3 + seed % 6)
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
