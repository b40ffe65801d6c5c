"""Objectives through the graph: order, failure, retries, recovery, blocks in parallel, places of one objective."""

from __future__ import annotations

import pytest

from mauve.mission.plan import Child, Continue, Elementary, Parallel, Recover, Retry, Sequence, Step
from tests.mission.build import after, does, graph_of, mission, possible, running, ways

START = "MISSION_EV_START"
ANY = (ways("a", ("", "")), ways("b", ("", "")), ways("c", ("", "")))


def test_steps_follow_one_another_and_a_failure_ends_the_mission() -> None:
    graph = graph_of(mission(does("one", "a"), does("two", "b"), activities=ANY))
    assert after(graph, f"{START} one_EV_OK").objectives == ("two",)
    assert after(graph, f"{START} one_EV_OK two_EV_OK").outcome == "success"
    assert after(graph, f"{START} one_EV_FAIL").outcome == "failure"


def test_a_failure_that_is_continued_counts_as_success() -> None:
    graph = graph_of(mission(Step(does("one", "a"), Continue()), does("two", "b"), activities=ANY))
    assert after(graph, f"{START} one_EV_FAIL").objectives == ("two",)


def test_a_step_is_tried_again_as_often_as_it_says() -> None:
    graph = graph_of(mission(Step(does("one", "a"), Retry(2)), does("two", "b"), activities=ANY))
    assert after(graph, f"{START} one_EV_FAIL one_EV_FAIL").objectives == ("one",)
    assert after(graph, f"{START} one_EV_FAIL one_EV_FAIL one_EV_FAIL").outcome == "failure"
    assert after(graph, f"{START} one_EV_FAIL one_EV_FAIL one_EV_OK").objectives == ("two",)


@pytest.mark.parametrize("resume", [False, True])
def test_recovery_runs_and_then_the_block_fails_or_goes_on(resume: bool) -> None:
    rescue = Recover(Sequence("rescue", (Step(does("up", "c")),)), resume)
    graph = graph_of(mission(Step(does("one", "a"), rescue), does("two", "b"), activities=ANY))
    assert after(graph, f"{START} one_EV_FAIL").objectives == ("rescue.up",)
    assert after(graph, f"{START} one_EV_FAIL up_EV_FAIL").outcome == "failure"
    done = after(graph, f"{START} one_EV_FAIL up_EV_OK")
    assert (done.outcome, done.objectives) == (("", ("two",)) if resume else ("failure", ()))


def test_a_time_limit_is_an_event_that_fails_the_objective() -> None:
    graph = graph_of(mission(Elementary("one", ("a",), 10**12), activities=ANY))
    assert possible(graph, START) == {"one_EV_OK", "one_EV_FAIL", "one_EV_TIMEOUT"}
    assert after(graph, f"{START} one_EV_TIMEOUT").outcome == "failure"


def test_a_parallel_block_waits_for_all_and_succeeds_if_the_mandatory_do() -> None:
    children = (Child(Step(does("x", "a"))), Child(Step(does("y", "b"))), Child(Step(does("z", "c")), mandatory=False))
    graph = graph_of(mission(Parallel("par", children), activities=ANY))
    assert after(graph, START).objectives == ("par.x", "par.y", "par.z")
    assert after(graph, START).pursued == {"par", "x", "y", "z"}
    for order in ("x y z", "z y x", "y z x"):
        for failed in ("", "x", "y", "z", "y z", "x z"):
            ends = " ".join(f"{name}_EV_{'FAIL' if name in failed.split() else 'OK'}" for name in order.split())
            outcome = after(graph, f"{START} {ends}").outcome
            assert outcome == ("failure" if {"x", "y"} & set(failed.split()) else "success")
    assert after(graph, f"{START} x_EV_FAIL y_EV_OK").outcome == ""


def test_an_objective_at_two_places_has_two_names() -> None:
    rescue = Recover(Sequence("rescue", (Step(does("up", "a")),)))
    graph = graph_of(mission(Step(does("one", "b"), rescue), does("up", "a"), activities=ANY))
    assert [event.name for event in graph.net.events if event.subject.endswith("up")] == [
        "rescue.up_EV_OK",
        "rescue.up_EV_FAIL",
        "up_EV_OK",
        "up_EV_FAIL",
    ]
    twice = graph_of(mission(does("up", "a"), does("up", "a"), activities=ANY))
    assert after(twice, f"{START} up_EV_OK").objectives == ("up#2",)
    assert after(twice, f"{START} up_EV_OK").pursued == {"up"}
    assert after(twice, f"{START} up_EV_OK up#2_EV_OK").outcome == "success"


def test_an_activity_of_two_parallel_objectives_runs_until_both_end() -> None:
    children = (Child(Step(does("x", "a"))), Child(Step(does("y", "a", "b"))))
    graph = graph_of(mission(Parallel("par", children), activities=ANY))
    assert running(after(graph, f"{START} x_EV_OK")) == {"a.w1", "b.w1"}
    assert running(after(graph, f"{START} y_EV_OK")) == {"a.w1"}


def test_an_objective_without_activities_and_an_empty_block() -> None:
    graph = graph_of(mission(Sequence("nothing", ()), does("one"), activities=()))
    assert after(graph, START).objectives == ("one",)
    assert after(graph, f"{START} one_EV_OK").outcome == "success"
