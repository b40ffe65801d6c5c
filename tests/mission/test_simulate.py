"""Stepping a mission: what changes, what is refused and why."""

from __future__ import annotations

from random import Random

from mauve.mission.graph import AlternativesGraph
from mauve.mission.simulate import Refused, Session, Stepped, begin, possible, script, step, told
from mauve.mission.stable import alternatives_graph
from mauve.mission.templates import build_net

from .coral import coral


def after(session: Session, *events: str) -> Session:
    for event in events:
        done = step(session, event)
        assert isinstance(done, Stepped), (event, done)
        session = done.session
    return session


def refused(session: Session, event: str) -> str:
    done = step(session, event)
    assert isinstance(done, Refused)
    assert done.possible == possible(session)
    return done.reason


START = begin(build_net(coral()))


def test_a_mission_steps_from_start_to_success() -> None:
    session = after(START, "start", "ok ManualMoving", "ok Isospheric", "Diving_EV_OK", "ok Filming", "ok Advancing")
    assert session.view.objectives == ("Transect.Survey.MeasuringTemperature",)
    session = after(session, "ok MeasuringTemperature", "ok GoingUp")
    assert (session.view.outcome, session.view.running) == ("success", ())
    assert refused(session, "start") == "the mission has been started"
    assert refused(session, "ok Diving") == "Transect.Diving is not being pursued: the mission ended in success"


def test_a_lost_sensor_switches_the_alternative() -> None:
    session = after(START, "start")
    done = step(session, "lose gps_sensor")
    assert isinstance(done, Stepped)
    assert ("localisation", "gps") in done.change.stopped and ("localisation", "imu") in done.change.started
    assert done.change.lost == ("gps_sensor",) and not done.change.begun and not done.change.ended
    assert done.fired > 5
    text = told(done)
    assert "  ~ localisation switches from gps to imu" in text and "  - gps_driver stops\n" in text
    assert "  ! gps_sensor is out of service" in text
    assert refused(done.session, "lose gps_sensor") == "gps_sensor is out of service already"
    assert refused(session, "recover gps_sensor") == "gps_sensor is in service"


def test_an_objective_in_error_can_only_fail() -> None:
    session = after(START, "lose thruster_actuator", "start")
    assert session.view.failed == ("manual_moving",)
    assert refused(session, "ok ManualMoving").endswith("manual_moving has no alternative left")
    done = step(session, "fail ManualMoving")
    assert isinstance(done, Stepped) and done.change.outcome == "failure"
    assert "mission: failure" in told(done)


def test_what_is_not_understood_is_said() -> None:
    assert refused(START, "sing") == "there is no such event"
    assert refused(START, "lose Sonar") == "nothing called Sonar has such an event"
    assert refused(START, "ok Diving") == "Transect.Diving is not being pursued"
    assert "possible: gps_sensor_EV_OOS, imu_sensor_EV_OOS" in told(step(START, "ok Diving"))


def test_a_script_passes_over_comments_and_goes_on_after_a_refusal() -> None:
    answers = script(START, ["# a run", "", "start  // now", "start", "ok ManualMoving"])
    assert [type(one) for one in answers] == [Stepped, Refused, Stepped]


def test_sessions_walk_the_alternatives_graph() -> None:
    graph = alternatives_graph(START.net)
    assert isinstance(graph, AlternativesGraph)
    random, session, state = Random(1), START, graph.initial
    for _ in range(150):
        ways = {graph.net.events[event].name: target for event, target in graph.successors(state)}
        assert possible(session) == tuple(event.name for event in graph.net.events if event.name in ways)
        name = random.choice(sorted(ways))
        session, state = after(session, name), ways[name]
        assert session.marking == graph.markings[state]
