"""The templates against the documents: random events lead the net and a direct interpreter to the same states."""

from __future__ import annotations

import os
from random import Random

from mauve.mission.graph import AlternativesGraph, StateView
from mauve.mission.stable import alternatives_graph
from mauve.mission.templates import build_net
from tests.mission.interpreter import Interpreter
from tests.mission.random_missions import random_mission

SOME = 50


def seen(view: StateView) -> StateView:
    """The same, each list sorted."""
    return StateView(
        tuple(sorted(view.objectives)),
        tuple(sorted(view.running)),
        tuple(sorted(view.lost)),
        view.outcome,
        tuple(sorted(view.failed)),
    )


def test_the_graph_does_what_the_documents_say() -> None:
    wanted = int(os.environ.get("MAUVE_RANDOM_MISSIONS", SOME))
    steps = 0
    for seed in range(wanted):
        plan = random_mission(seed + 10_000)
        graph = alternatives_graph(build_net(plan))
        assert isinstance(graph, AlternativesGraph)
        random = Random(seed)
        for _ in range(6):
            direct, state, run = Interpreter(plan), graph.initial, []
            for _ in range(25):
                here = {graph.net.events[event].name: target for event, target in graph.successors(state)}
                assert set(here) == set(direct.possible()), (seed, run)
                assert seen(graph.view(state)) == direct.view(), (seed, run)
                if not here:
                    break
                ahead = [name for name in sorted(here) if random.random() < 0.5 or not name.endswith(("_OOS", "_RD"))]
                run.append(random.choice(ahead or sorted(here)))
                direct.step(run[-1])
                state = here[run[-1]]
                steps += 1
    assert steps > 70 * wanted
