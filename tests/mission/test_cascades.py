"""Cascades with what was seen of them before against firing one transition after the other."""

from __future__ import annotations

from random import Random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.mission import cascades
from mauve.mission.cascades import EndlessCascade, Runs, Unsafe, Unsound, masks
from mauve.mission.graph import AlternativesGraph
from mauve.mission.net import Level, Net
from mauve.mission.stable import alternatives_graph
from mauve.mission.templates import build_net
from tests.mission.random_missions import random_mission
from tests.mission.random_nets import random_net

MOST = 200


def fired(net: Net, state: int, event: int) -> tuple[int, tuple[int, ...]] | type[Unsound]:
    """The marking after a cascade and what fires in it, by the definition."""
    marked = {place for place in range(len(net.places)) if state >> place & 1}
    order: list[int] = []
    chosen: int | None = event
    while chosen is not None:
        one = net.transitions[chosen]
        if marked & (set(one.after) - set(one.before)):
            return Unsafe
        marked = marked - set(one.before) | set(one.after)
        order.append(chosen)
        if len(order) > MOST:
            return EndlessCascade
        enabled = [
            (-one.level, index)
            for index, one in enumerate(net.transitions)
            if one.level is not Level.EVENT and marked.issuperset(one.before)
        ]
        chosen = min(enabled)[1] if enabled else None
    return sum(1 << place for place in marked), tuple(order)


@settings(max_examples=100, deadline=None)
@given(st.integers(0, 2**64), st.integers(2, 9))
def test_cascades_of_small_nets_fire_in_the_order_of_levels_and_names(seed: int, size: int) -> None:
    net, state = random_net(Random(seed), size)
    event = len(net.transitions) - 1
    expected = fired(net, state, event)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(cascades, "LONGEST", MOST)
        if isinstance(expected, tuple):
            done = Runs(masks(net)).cascade(state, event)
            assert (done.result, done.fired) == expected
        else:
            with pytest.raises(expected):
                Runs(masks(net)).cascade(state, event)


def test_cascades_of_missions_are_the_same_whatever_was_seen_before() -> None:
    compared = 0
    for seed in range(7):
        net = build_net(random_mission(seed, contended=seed % 2 > 0))
        try:
            graph = alternatives_graph(net, 3_000)
        except Unsound:
            continue
        if not isinstance(graph, AlternativesGraph):
            continue
        runs, met = Runs(masks(net)), set[int]()
        for state, marking in enumerate(graph.markings):
            for edge in range(graph.first[state], graph.first[state + 1]):
                if graph.rules_used[edge] in met:
                    continue
                met.add(graph.rules_used[edge])
                event = net.events[graph.events[edge]].name
                start = next(
                    at
                    for at, one in enumerate(net.transitions)
                    if one.event == event and all(marking >> place & 1 for place in one.before)
                )
                done = runs.cascade(marking, start)
                assert (done.result, done.fired) == fired(net, marking, start)
                rule = graph.rules[graph.rules_used[edge]]
                assert marking & rule.tested == rule.value
                assert done.result == marking & ~rule.cleared | rule.filled == graph.markings[graph.targets[edge]]
                compared += 1
    assert compared > 100
