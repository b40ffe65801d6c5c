"""Confluence: proven where it holds, and shown with two outcomes where it does not."""

from __future__ import annotations

from mauve.mission.confluence import confluence
from mauve.mission.contention import contentions
from mauve.mission.draft import Draft
from mauve.mission.graph import AlternativesGraph
from mauve.mission.net import Event, EventKind, Level, Net
from mauve.mission.plan import Child, Mission, Parallel, Step
from mauve.mission.stable import alternatives_graph
from tests.mission.build import does, graph_of, mission, running, ways
from tests.mission.coral import coral

GO = Event("GO", EventKind.OTHER)


def rivals(shared: bool) -> Mission:
    """Two objectives side by side that both need the one camera, each with a way to do without."""
    activities = (
        ways("driver", ("h", "camera")),
        ways("a", ("camera", ""), ("", "")),
        ways("b", ("camera", ""), ("", "")),
    )
    pair = Parallel("par", (Child(Step(does("x", "a"))), Child(Step(does("y", "b")))))
    if shared:
        return mission(pair, activities=activities, shared="camera", hardware="h")
    return mission(pair, activities=activities, software="camera", hardware="h")


def test_the_coral_mission_is_confluent_in_all_orders() -> None:
    for plan in (coral(), coral(shared=True)):
        found = confluence(graph_of(plan))
        assert found.complete
        assert found.holds
        assert found.cascades > 0


def test_two_rivals_for_one_camera_have_two_outcomes() -> None:
    plan = rivals(shared=False)
    (one,) = contentions(plan)
    assert one.resource == "camera"
    assert one.first == ("par.x", "a", "camera")
    assert one.second == ("par.y", "b", "camera")
    found = confluence(graph_of(plan))
    assert not found.holds
    fired = next(one for one in found.divergences if one.event == "MISSION_EV_START" and one.state == 0)
    assert [running(view) for view in fired.outcomes] in (
        [{"driver.w1", "a.w1", "b.w2"}, {"driver.w1", "a.w2", "b.w1"}],
        [{"driver.w1", "a.w2", "b.w1"}, {"driver.w1", "a.w1", "b.w2"}],
    )
    assert fired.orders[0] != fired.orders[1]
    assert fired.orders[0][0] == "MISSION_start"


def test_random_orders_show_the_two_outcomes_where_there_is_no_budget_for_all() -> None:
    found = confluence(graph_of(rivals(shared=False)), budget=1, orders=20)
    assert not found.complete
    assert found.orders == 20
    assert found.divergences


def test_shared_the_camera_serves_both() -> None:
    plan = rivals(shared=True)
    assert not contentions(plan)
    found = confluence(graph_of(plan))
    assert found.complete
    assert found.holds


def test_contention_is_seen_through_producers_and_within_one_objective() -> None:
    activities = (
        ways("front", ("h", "s")),
        ways("back", ("h", "t")),
        ways("a", ("s", "")),
        ways("b", ("t", "")),
    )
    plan = mission(does("o", "a", "b"), activities=activities, software="s t", hardware="h")
    (one,) = contentions(plan)
    assert one.first == ("o", "a", "s", "front", "h")
    assert one.second == ("o", "b", "t", "back", "h")
    assert not contentions(mission(does("o", "a"), does("p", "b"), activities=activities, software="s t", hardware="h"))


def net_of(*steps: tuple[str, str, str], marked: str) -> AlternativesGraph:
    """A net of internal steps (name, places taken, places filled) after the event GO, which takes `go`."""
    draft = Draft("small")
    names = sorted({place for _, before, after in steps for place in (before + " " + after).split()} | {"go", "on"})
    index = {name: draft.place("", name, marked=name in marked.split()) for name in names}
    draft.fire("GO", Level.EVENT, (index["go"],), (index["on"],), event=GO)
    for name, before, after in steps:
        draft.fire(name, Level.RESOURCE, [index[one] for one in before.split()], [index[one] for one in after.split()])
    net: Net = draft.net()
    graph = alternatives_graph(net)
    assert isinstance(graph, AlternativesGraph)
    return graph


def test_a_step_that_fills_a_full_place_in_some_order_is_reported() -> None:
    steps = (("split", "on", "p q"), ("first", "q r", "s"), ("second", "p", "r"))
    assert confluence(net_of(*steps, marked="go r")).unsafe == ("r",)
    assert confluence(net_of(*steps, marked="go")).unsafe == ()


def test_an_order_that_never_ends_is_reported() -> None:
    steps = (("stop", "on", "end"), ("there", "on", "other"), ("back", "other", "on"))
    found = confluence(net_of(*steps, marked="go"))
    assert found.endless == ("GO",)
    assert not found.holds


def test_two_ends_of_one_event_are_reported() -> None:
    found = confluence(net_of(("left", "on", "l"), ("right", "on", "r"), marked="go"))
    (fired,) = found.divergences
    assert {order[-1] for order in fired.orders} == {"left", "right"}
