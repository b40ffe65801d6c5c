"""The hardware resource alone: the markings of the mission paper's figures 10 and 11."""

from __future__ import annotations

import pytest

from mauve.mission.graph import AlternativesGraph
from mauve.mission.markings import Explored, explore
from mauve.mission.net import Net, marked
from mauve.mission.plan import Hardware
from mauve.mission.stable import alternatives_graph
from mauve.mission.templates import hardware_alone

FIGURE_10 = [
    ("available free", {"TAKE": 1, "oos_free": 2}),
    ("free take", {"take!": 3}),
    ("available failingF", {"fail_free": 4}),
    ("answer busy", {"RELEASE": 5, "oos_busy": 6}),
    ("OOS", {"rd": 0}),
    ("busy release", {"release!": 0}),
    ("answer failingB", {"fail_busy": 7}),
    ("OOS answer error", {"ERROROK": 4}),
]


def explored(net: Net) -> Explored:
    found = explore(net)
    assert isinstance(found, Explored)
    return found


def graph_of(net: Net) -> AlternativesGraph:
    graph = alternatives_graph(net)
    assert isinstance(graph, AlternativesGraph)
    return graph


def words(net: Net, marking: int) -> str:
    return " ".join(sorted(name.removeprefix("R.") for name in marked(net, marking)))


def test_the_eight_markings_of_figure_10_in_its_numbering() -> None:
    net = hardware_alone(Hardware("R"))
    found = explored(net)
    rows = [
        (words(net, marking), {net.transitions[t].name.removeprefix("R."): to for at, t, to in found.edges if at == n})
        for n, marking in enumerate(found.markings)
    ]
    assert rows == FIGURE_10
    assert found.stable == (0, 3, 4)
    assert len(found.edges) == 10
    assert found.safe


def test_the_three_states_of_figure_11() -> None:
    net = hardware_alone(Hardware("R"))
    graph = graph_of(net)
    names = [words(net, marking) for marking in graph.markings]
    edges = {(names[edge.source], edge.event, names[edge.target]) for edge in graph.edges()}
    assert edges == {
        ("available free", "R_EV_TAKE", "answer busy"),
        ("answer busy", "R_EV_RELEASE", "available free"),
        ("available free", "R_EV_OOS", "OOS"),
        ("answer busy", "R_EV_OOS", "OOS"),
        ("OOS", "R_EV_RD", "available free"),
    }


@pytest.mark.parametrize(
    ("resource", "states", "events"),
    [
        (Hardware("R", may_fail=False, may_recover=False), 2, {"R_EV_TAKE", "R_EV_RELEASE"}),
        (Hardware("R", may_recover=False), 3, {"R_EV_TAKE", "R_EV_RELEASE", "R_EV_OOS"}),
    ],
)
def test_hardware_that_never_fails_or_never_recovers_has_no_such_event(
    resource: Hardware, states: int, events: set[str]
) -> None:
    graph = graph_of(hardware_alone(resource))
    assert len(graph.markings) == states
    assert {edge.event for edge in graph.edges()} == events
