"""Modes and switches of a mission as modes of its architecture: deadlines, reactions, messages."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from referencing import Registry, Resource

from mauve.cli import main

ROOT = Path(__file__).resolve().parents[2]
SCHEMAS = ROOT / "docs" / "schema"
MS = 1_000_000_000

MODEL = """\
mauve 1
component Sensor {{
  codel read wcet 1ms
  behaviour {{
    initial state Reading {{ run read }}
  }}
}}
component Nav {{
  event ToCoarse, ToFine
  codel fine wcet {fine}
  codel coarse wcet 2ms
  behaviour {{
    initial state Fine {{
      run fine
      -> Coarse {leave}
    }}
    state Coarse {{
      run coarse
      -> Fine on ToFine
    }}
  }}
}}
component Watch {{
  codel look wcet 500us
  behaviour {{
    initial state Looking {{ run look }}
  }}
}}
architecture Robot {{
  instance gps: Sensor {{ period 10ms priority 9 }}
  instance imu: Sensor {{ period 10ms priority 8 }}
  instance nav: Nav {{ period 20ms priority 5 deadline {deadline} }}
  instance watch: Watch {{ period 5ms priority 20 }}
{more}}}
deployment desk of Robot {{
  node n on "generic-arm926ej-s" {{ }}
}}
hardware G: gps may fail, may recover
hardware I: imu may fail
resource g
resource i
activity gps_driver {{ consumes G produces g runs gps }}
activity imu_driver {{ consumes I produces i runs imu }}
activity navigate {{
  runs {nav}
  alternative fine priority 2 {{ consumes g mode a = state Fine }}
  alternative coarse priority 1 {{ consumes i mode b = state Coarse }}
}}
objective Go {{ does navigate }}
mission M {{
  Go
  generate controller{controller}
}}
"""
TASK = " { period 4ms priority 30 wcet 100us }"


def text(**changes: str) -> str:
    usual = {"fine": "6ms", "deadline": "20ms", "controller": TASK, "leave": "on ToCoarse", "more": "", "nav": "nav"}
    return MODEL.format(**(usual | changes))


def checked(source: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, dict[str, Any]]:
    """The exit code and the document, which follows its schema."""
    path = tmp_path / "robot.mauve"
    path.write_text(source, encoding="utf-8")
    code = main(["check", str(path), "--format", "json", "--no-cache"])
    document = json.loads(capsys.readouterr().out)
    schemas = {one.name: json.loads(one.read_text(encoding="utf-8")) for one in SCHEMAS.glob("*.json")}
    registry = Registry().with_resources((name, Resource.from_contents(one)) for name, one in schemas.items())
    jsonschema.Draft202012Validator(schemas["check-1.schema.json"], registry=registry).validate(document)
    return code, document


def responses(modes: dict[str, Any]) -> dict[str, int | None]:
    return {one["name"]: one["wcrt_ps"] for one in modes["components"]}


# ------------------------------------------------------------------------------------------------ modes and switches
def test_only_tasks_of_running_activities_are_active(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, document = checked(text(), tmp_path, capsys)
    assert code == 0 and document["holds"]
    (deployment,) = document["deployments"]
    (modes,) = deployment["mission_modes"]
    # what always runs; gps, and nav in Fine; imu, and nav in Coarse
    assert modes["mode_task_sets"] == 3 and modes["holds"] and not modes["failing"]
    # in the switch: 6ms of nav + 1ms of gps + 1ms of imu + 2 x 0.5ms of watch + 3 x 0.1ms of the controller
    assert responses(modes)["nav"] == 9_300_000_000


def test_old_and_new_tasks_together_are_checked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Alone each mode holds a deadline of 8.6ms; in the switch, with both drivers, nav takes longer."""
    code, document = checked(text(deadline="8600us"), tmp_path, capsys)
    (modes,) = document["deployments"][0]["mission_modes"]
    assert code == 1 and not modes["holds"]
    assert all(one["switch"] for one in modes["failing"]) and modes["failing"][0]["missed"] == ["nav"]
    assert {d["code"] for d in document["diagnostics"] if d["severity"] == "error"} == {"MV724"}
    (told,) = (d for d in document["diagnostics"] if d["code"] == "MV724")
    assert "in a switch of the mission `M`, `nav` responds within" in told["message"]
    assert any("MISSION_EV_START" in note for note in told["notes"])


def test_a_set_of_tasks_that_no_mode_runs_need_not_hold(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A camera and a sensor never work at one time: together they would overload the processor."""
    more = "  instance cam: Camera { period 20ms priority 4 }\n"
    camera = "component Camera {\n  codel shoot wcet 12ms\n  behaviour {\n    initial state On { run shoot }\n  }\n}\n"
    film = "activity film { runs cam }\nobjective Film { does film }\n"
    source = text(more=more).replace("architecture", camera + "architecture")
    source = source.replace("objective Go", film + "objective Go")
    alone = source.replace("  Go\n", "  Go ; Film\n")
    code, document = checked(alone, tmp_path, capsys)
    assert code == 1  # the switch from Go to Film has both
    slow = alone.replace("shoot wcet 12ms", "shoot wcet 8ms")
    code, document = checked(slow, tmp_path, capsys)
    together = sum(one["load"] for one in document["deployments"][0]["nodes"][0]["components"])
    assert code == 0 and together > 1


def test_a_missed_deadline_of_a_mode_is_told_with_its_bill(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, document = checked(text(deadline="7ms"), tmp_path, capsys)
    (told,) = (d for d in document["diagnostics"] if d["code"] == "MV724")
    assert code == 1 and "in a mode of the mission" in told["message"]
    assert any("of work is due" in note for note in told["notes"])
    assert document["deployments"][0]["schedulable"] is False


# ------------------------------------------------------------------------------------------------ states of a mode
def test_a_state_that_is_left_by_itself_does_not_restrict(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """In Coarse nav takes 2ms; where Fine is left without an event, it can be in either state in either mode."""
    held = checked(text(), tmp_path, capsys)[1]["deployments"][0]["mission_modes"][0]
    free = checked(text(leave=""), tmp_path, capsys)[1]["deployments"][0]["mission_modes"][0]
    assert held["mode_task_sets"] == 3 and free["mode_task_sets"] == 3
    assert responses(free)["nav"] == responses(held)["nav"]


def test_a_mode_costs_its_state_and_a_switch_the_machine(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    from mauve.diagnostics.diagnostic import Report
    from mauve.lower.modes import ANY, active, during, switched, tasks_of, tie
    from mauve.pipeline import Options, analyse_deployment, read_model

    path = tmp_path / "robot.mauve"
    path.write_text(text(), encoding="utf-8")
    report = Report()
    _, model = read_model(str(path), report)
    assert model is not None and model.missions is not None and not report.has_errors
    (mission,), (deployment,) = model.missions.missions, model.deployments
    ties = tie(mission, deployment, report)
    assert ties is not None and ties.tied == {"gps", "imu", "nav"}
    fine = active(ties, [("navigate", "fine"), ("gps_driver", "only")])
    coarse = active(ties, [("navigate", "coarse"), ("imu_driver", "only")])
    assert fine == {("nav", "nav", "Fine"), ("gps", ANY, ANY)}
    assert switched(fine, coarse) == ("gps", "imu", "nav")
    assert during(fine, coarse) == {("nav", ANY, ANY), ("gps", ANY, ANY), ("imu", ANY, ANY)}
    assert during(fine, fine) == fine
    nodes = [node.tasks for node in analyse_deployment(deployment, Options(cache=False), report).nodes]
    costs = {placed.task.name: placed.task.demand(1) for node in tasks_of(nodes, ties, coarse) for placed in node.tasks}
    assert costs == {"imu": MS, "nav": 2 * MS, "watch": MS // 2}


# ------------------------------------------------------------------------------------------------ reactions
def test_a_reaction_is_detector_controller_and_switched(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (modes,) = checked(text(), tmp_path, capsys)[1]["deployments"][0]["mission_modes"]
    reactions = {one["event"]: one for one in modes["reactions"]}
    lost = reactions["G_EV_OOS"]
    assert lost["detector"]["task"] == "gps" and lost["detector"]["wait_ps"] == 10 * MS
    assert lost["controller"] == {"task": "controller of M", "wait_ps": 4 * MS, "response_ps": MS // 10}
    assert lost["switched"]["task"] == "nav" and lost["switched"]["wait_ps"] == 20 * MS
    legs = [lost[part] for part in ("detector", "controller", "switched")]
    assert lost["bound_ps"] == sum(leg["wait_ps"] + leg["response_ps"] for leg in legs)
    start = reactions["MISSION_EV_START"]
    assert start["detector"] is None
    assert start["bound_ps"] == sum(start[p]["wait_ps"] + start[p]["response_ps"] for p in ("controller", "switched"))


def test_a_controller_that_is_woken_does_not_poll(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    woken = TASK.replace("period", "sporadic")
    (modes,) = checked(text(controller=woken), tmp_path, capsys)[1]["deployments"][0]["mission_modes"]
    assert modes["reactions"][0]["controller"]["wait_ps"] == 0


def test_a_controller_can_be_an_instance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (modes,) = checked(text(controller=" runs watch"), tmp_path, capsys)[1]["deployments"][0]["mission_modes"]
    assert modes["reactions"][0]["controller"]["task"] == "watch"
    assert modes["reactions"][0]["controller"]["wait_ps"] == 5 * MS


def test_without_a_task_of_the_controller_there_is_no_bound(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (modes,) = checked(text(controller=""), tmp_path, capsys)[1]["deployments"][0]["mission_modes"]
    assert modes["reactions"] == [] and modes["holds"]


@pytest.mark.parametrize("task", [" { period 4ms wcet 1ms }", " { priority 3 wcet 1ms }", " runs watch { wcet 1ms }"])
def test_a_task_of_the_controller_is_whole(task: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, document = checked(text(controller=task), tmp_path, capsys)
    assert code == 1 and {d["code"] for d in document["diagnostics"]} >= {"MV401"}


# ------------------------------------------------------------------------------------------------ instances
def test_an_activity_runs_one_instance(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert "MV723" not in _codes(text(nav="Nav"), tmp_path, capsys)
    second = "  instance spare: Nav { period 20ms priority 2 }\n"
    assert "MV723" in _codes(text(nav="Nav", more=second), tmp_path, capsys)
    assert "MV723" not in _codes(text(nav="nav", more=second), tmp_path, capsys)
    none = text(nav="Nav").replace("  instance nav: Nav { period 20ms priority 5 deadline 20ms }\n", "")
    assert "MV723" in _codes(none, tmp_path, capsys)


def _codes(source: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> set[str]:
    return {d["code"] for d in checked(source, tmp_path, capsys)[1]["diagnostics"]}


def test_what_only_another_mission_runs_rests(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A heavy component of a mission of its own disturbs neither the other mission nor the deployment."""
    heavy = "component Heavy {\n  codel grind wcet 8ms\n  behaviour {\n    initial state On { run grind }\n  }\n}\n"
    more = "  instance heavy: Heavy { period 10ms priority 7 }\n"
    other = "activity grind { runs heavy }\nobjective Grind { does grind }\nmission N { Grind }\n"
    source = text(more=more).replace("architecture", heavy + "architecture") + other
    code, document = checked(source, tmp_path, capsys)
    first, second = document["deployments"][0]["mission_modes"]
    assert code == 0 and "heavy" not in responses(first) and set(responses(second)) >= {"heavy", "watch"}
    assert "nav" not in responses(second)


# ------------------------------------------------------------------------------------------------ the example
def test_a_flow_takes_the_worst_responses_of_any_mode(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """All tasks together overload the processor, so with all of them the flow would have no bound."""
    source = (ROOT / "examples" / "ulysse" / "robot.mauve").read_text(encoding="utf-8")
    flow = "  flow blind: location.pose -> surface.command within 300ms\n"
    code, document = checked(source.replace("  connect gps", flow + "  connect gps", 1), tmp_path, capsys)
    (deployment,) = document["deployments"]
    worst = {one["name"]: one["wcrt_ps"] for one in deployment["mission_modes"][0]["components"]}
    assert code == 0 and deployment["schedulable"]
    assert deployment["flows"][0]["reaction_ps"] == 100 * MS + worst["location"] + worst["surface"]


def test_the_robot_of_the_example_holds_in_each_mode(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["check", str(ROOT / "examples" / "ulysse" / "robot.mauve"), "--no-cache"]) == 0
    out = capsys.readouterr().out
    assert "every deadline holds in each mode" in out and "GPS_sensor_EV_OOS" in out
    assert main(["mission", str(ROOT / "examples" / "ulysse" / "ulysse.mauve")]) == 0
