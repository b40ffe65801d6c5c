"""Activities through the graph: alternatives, products, sharing, loss, recovery, failure."""

from __future__ import annotations

from tests.mission.build import after, does, graph_of, mission, possible, running, ways

START = "MISSION_EV_START"


def test_the_first_alternative_with_all_its_resources_runs() -> None:
    graph = graph_of(
        mission(does("o", "a"), activities=(ways("a", ("h k", ""), ("k", ""), ("h", "")),), hardware="h k")
    )
    assert running(after(graph, START)) == {"a.w1"}
    assert running(after(graph, f"h_EV_OOS {START}")) == {"a.w2"}
    assert running(after(graph, f"k_EV_OOS {START}")) == {"a.w3"}
    assert running(after(graph, f"{START} h_EV_OOS")) == {"a.w2"}


def test_without_an_alternative_the_objective_waits_for_its_failure() -> None:
    graph = graph_of(mission(does("o", "a"), activities=(ways("a", ("h", "")),), hardware="h"))
    stranded = after(graph, f"{START} h_EV_OOS")
    assert (stranded.failed, stranded.running, stranded.objectives) == (("a",), (), ("o",))
    assert possible(graph, f"{START} h_EV_OOS") == {"o_EV_FAIL", "h_EV_RD"}
    assert after(graph, f"{START} h_EV_OOS h_EV_RD").failed == ("a",)
    assert after(graph, f"{START} h_EV_OOS o_EV_FAIL").outcome == "failure"


def test_a_producer_starts_on_demand_and_stops_with_its_last_consumer() -> None:
    activities = (ways("driver", ("h", "s")), ways("a", ("s", "")), ways("b", ("", "")))
    graph = graph_of(
        mission(does("first", "a"), does("second", "b"), activities=activities, software="s", hardware="h")
    )
    assert running(after(graph, START)) == {"driver.w1", "a.w1"}
    assert running(after(graph, f"{START} first_EV_OK")) == {"b.w1"}


def test_consumers_notice_nothing_where_another_alternative_of_the_producer_takes_over() -> None:
    activities = (ways("driver", ("h", "s"), ("k", "s")), ways("a", ("s", ""), ("", "")))
    graph = graph_of(mission(does("o", "a"), activities=activities, software="s", hardware="h k"))
    assert running(after(graph, f"{START} h_EV_OOS")) == {"driver.w2", "a.w1"}
    assert running(after(graph, f"{START} h_EV_OOS k_EV_OOS")) == {"a.w2"}


def test_keep_stays_with_the_lesser_alternative_and_upgrade_goes_back() -> None:
    for upgrade, expected in ((False, {"driver.w2", "a.w1"}), (True, {"driver.w1", "a.w1"})):
        activities = (ways("driver", ("h", "s"), ("k", "s"), upgrade=upgrade), ways("a", ("s", "")))
        graph = graph_of(mission(does("o", "a"), activities=activities, software="s", hardware="h k"))
        assert running(after(graph, f"{START} h_EV_OOS h_EV_RD")) == expected


def test_an_upgrade_reaches_through_producers_which_come_first() -> None:
    activities = (
        ways("driver", ("h", "s"), ("k", "t"), upgrade=True),
        ways("a", ("s", ""), ("t", ""), upgrade=True),
    )
    graph = graph_of(mission(does("o", "a"), activities=activities, software="s t", hardware="h k"))
    assert running(after(graph, f"{START} h_EV_OOS")) == {"driver.w2", "a.w2"}
    assert running(after(graph, f"{START} h_EV_OOS h_EV_RD")) == {"driver.w1", "a.w1"}


def test_an_upgrade_that_is_not_possible_ends_where_it_began() -> None:
    activities = (ways("a", ("h k", ""), ("", ""), upgrade=True),)
    graph = graph_of(mission(does("o", "a"), activities=activities, hardware="h k"))
    assert running(after(graph, f"{START} h_EV_OOS k_EV_OOS h_EV_RD")) == {"a.w2"}
    assert running(after(graph, f"{START} h_EV_OOS k_EV_OOS h_EV_RD k_EV_RD")) == {"a.w1"}


def test_a_product_that_the_running_alternative_does_not_offer_is_refused() -> None:
    activities = (ways("driver", ("h", "s t"), ("k", "s")), ways("a", ("t", ""), ("s", "")))
    graph = graph_of(mission(does("o", "a"), activities=activities, software="s t", hardware="h k"))
    assert running(after(graph, START)) == {"driver.w1", "a.w1"}
    assert running(after(graph, f"{START} h_EV_OOS")) == {"driver.w2", "a.w2"}
    assert running(after(graph, f"h_EV_OOS {START}")) == {"driver.w2", "a.w2"}


def test_a_shared_resource_serves_all_its_consumers_until_the_last_stops() -> None:
    activities = (ways("driver", ("h", "s")), ways("a", ("s", "")), ways("b", ("s", "")), ways("c", ("", "")))
    plan = mission(does("o", "a", "b"), does("p", "c"), activities=activities, shared="s", hardware="h")
    graph = graph_of(plan)
    assert running(after(graph, START)) == {"driver.w1", "a.w1", "b.w1"}
    assert after(graph, f"{START} h_EV_OOS").failed == ("a", "b")
    assert running(after(graph, f"{START} o_EV_OK")) == {"c.w1"}


def test_resources_taken_before_a_refusal_are_given_back() -> None:
    activities = (ways("driver", ("k", "s")), ways("a", ("h s", ""), ("h", "")))
    graph = graph_of(mission(does("o", "a"), activities=activities, software="s", hardware="h k"))
    assert running(after(graph, f"k_EV_OOS {START}")) == {"a.w2"}
    assert running(after(graph, f"{START} k_EV_OOS")) == {"a.w2"}
    assert after(graph, f"{START} k_EV_OOS h_EV_OOS").failed == ("a",)
