"""`mauvec mission`: verdicts as text and JSON, budgets, exports, simulation, exit codes."""

from __future__ import annotations

import json
import subprocess
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from missions.cases import GOOD

from mauve.cli import main
from mauve.cli.arguments import FORMS

ROOT = Path(__file__).resolve().parents[2]
CORAL = str(ROOT / "tests" / "syntax" / "data" / "coral.mauve")
SCHEMA = ROOT / "docs" / "schema" / "mission-1.schema.json"


def document(out: str) -> dict[str, Any]:
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    found: dict[str, Any] = json.loads(out)
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.Draft202012Validator(schema).validate(found)
    return found


@pytest.fixture
def good(tmp_path: Path) -> str:
    path = tmp_path / "good.mauve"
    path.write_text(GOOD, encoding="utf-8")
    return str(path)


# ------------------------------------------------------------------------------------------------ verdicts
def test_the_coral_mission_holds_and_its_document_follows_the_schema(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mission", CORAL, "--format", "json"]) == 0
    (mission,) = document(capsys.readouterr().out)["missions"]
    assert mission["name"] == "CoralStudy" and "markings_graph" not in mission
    assert [p["name"] for p in mission["properties"][:4]] == ["bounded", "deterministic", "live", "success_reachable"]
    assert [p["name"] for p in mission["properties"][4:]] == [
        "success_reachable_with_1_lost_of_GPS_sensor_IMU_sensor", "no_blind_drive",
    ]  # fmt: skip
    assert all(p["holds"] is True for p in mission["properties"])
    assert mission["cuts"] == [["Thruster"], ["GPS_sensor", "IMU_sensor"]]
    assert mission["alternatives_graph"]["states"] > 100


def test_the_graph_of_all_markings_has_as_many_stable_states(capsys: pytest.CaptureFixture[str], good: str) -> None:
    assert main(["mission", good, "--format", "json", "--markings"]) == 0
    (mission,) = document(capsys.readouterr().out)["missions"]
    assert mission["markings_graph"]["states"] > mission["alternatives_graph"]["states"] > 10


def test_the_text_shows_properties_cuts_and_lost_success(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mission", CORAL]) == 0
    out = capsys.readouterr().out
    for piece in ("mission CoralStudy holds", "{Thruster} or {GPS_sensor, IMU_sensor}", "success is lost", "no_blind"):
        assert piece in out


def test_a_violated_formula_fails_with_a_run(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "m.mauve"
    text = GOOD.replace("  accepts", "  check ltl calm: always not running(grip)\n  accepts")
    path.write_text(text, encoding="utf-8")
    assert main(["mission", str(path), "--format", "json"]) == 1
    captured = capsys.readouterr()
    (mission,) = document(captured.out)["missions"]
    calm = mission["properties"][-1]
    assert (calm["name"], calm["holds"]) == ("calm", False)
    assert "MISSION_EV_START" in calm["witness"] and "MV721" in captured.err


def test_a_file_in_error_gives_an_empty_document(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "m.mauve"
    path.write_text("mauve 1\nmission M { Nowhere }\n", encoding="utf-8")
    assert main(["mission", str(path), "--format", "json"]) == 1
    captured = capsys.readouterr()
    assert document(captured.out)["missions"] == [] and "MV100" in captured.err


def test_a_model_without_a_mission_is_an_error(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "m.mauve"
    path.write_text("mauve 1\n", encoding="utf-8")
    assert main(["mission", str(path)]) == 1
    assert "has no mission" in capsys.readouterr().err


# ------------------------------------------------------------------------------------------------ budgets
def test_beyond_the_budget_objectives_are_analysed_alone(capsys: pytest.CaptureFixture[str], good: str) -> None:
    assert main(["mission", good, "--budget", "30", "--format", "json"]) == 0
    captured = capsys.readouterr()
    (mission,) = document(captured.out)["missions"]
    assert mission["alternatives_graph"] == {"states": None, "transitions": None}
    assert {one["objective"] for one in mission["local_graphs"]} == {"Move", "Look", "Grip", "Film"}
    assert all(p["holds"] for p in mission["properties"])
    assert "MV720" in captured.err and "multiply" in captured.err


def test_retries_in_each_other_are_beyond_the_budget_at_once(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    path = tmp_path / "m.mauve"
    path.write_text(
        """mauve 1
hardware H : sensor may fail, may recover
activity user { consumes H }
objective A { does user }
objective B { A on failure retry 100 }
objective C { B on failure retry 100 }
mission M { C on failure retry 100  accepts single failure of H }
""",
        encoding="utf-8",
    )
    main(["mission", str(path), "--format", "json"])
    captured = capsys.readouterr()
    (mission,) = document(captured.out)["missions"]
    assert mission["seconds"] < 10
    assert [one["objective"] for one in mission["local_graphs"]] == ["C.B.A"]
    assert "MV720" in captured.err
    assert "`H` by 2, `C` by 101, `C.B` by 101, `C.B.A` by 101" in captured.err


def test_a_formula_needs_the_whole_graph(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "m.mauve"
    path.write_text(GOOD.replace("  accepts", "  check ltl calm: always not failure\n  accepts"), encoding="utf-8")
    assert main(["mission", str(path), "--budget", "30"]) == 1
    captured = capsys.readouterr()
    assert "MV725" in captured.err and "is not decided" in captured.out


# ------------------------------------------------------------------------------------------------ exports
@pytest.mark.parametrize("form", FORMS)
def test_each_form_is_written(form: str, capsys: pytest.CaptureFixture[str], good: str, tmp_path: Path) -> None:
    assert main(["mission", good, "--emit", form]) == 0
    shown = capsys.readouterr().out
    path = tmp_path / f"out.{form}"
    assert main(["mission", good, "--emit", form, "-o", str(path)]) == 0
    assert len(shown) > 100 and len(path.read_text(encoding="utf-8")) > 100
    if form == "json":
        graph = json.loads(shown)
        assert len(graph["edges"]) > len(graph["states"]) > 10


def test_the_objectives_are_spread_out(capsys: pytest.CaptureFixture[str]) -> None:
    for command in ("mission", "check"):
        assert main([command, CORAL, "--emit", "objectives"]) == 0
        assert capsys.readouterr().out == OBJECTIVES


OBJECTIVES = """\
mission CoralStudy
  start
  -> LocalizedObservation.ManualMoving  does manual_moving
  -> LocalizedObservation.Isospheric  does isospheric_observation
  -> Transect.Diving  does diving  timeout 300s -> failure
  => Transect.Survey
    mandatory
      -> Transect.Survey.Filming  does filming
    mandatory
      -> Transect.Survey.Advancing  does advancing
    optional
      -> Transect.Survey.MeasuringTemp  does temperature
  <= Transect.Survey
  -> Transect.GoingUp  does go_surface
     on failure:
       -> recovery.GoingUp  does go_surface
       then fails
  success
"""


@pytest.mark.parametrize(
    ("stem", "name"), [("robot", "robot"), ("Coral-study 2", "Coral_study_2"), ("3d", "mission_3d")]
)
def test_the_controller_in_c_compiles(stem: str, name: str, good: str, tmp_path: Path) -> None:
    source = tmp_path / f"{stem}.c"
    assert main(["mission", good, "--emit", "c", "-o", str(source)]) == 0
    assert f"bool {name}_step(" in (tmp_path / f"{stem}.h").read_text(encoding="utf-8")
    command = ["gcc", "-std=c11", "-Wall", "-Wextra", "-Werror", "-c", str(source), "-o", str(tmp_path / "robot.o")]
    assert subprocess.run(command, capture_output=True, text=True, timeout=60).stderr == ""


def test_the_net_too_large_for_one_graph_has_a_controller(capsys: pytest.CaptureFixture[str], good: str) -> None:
    assert main(["mission", good, "--budget", "30", "--emit", "python"]) == 0
    assert "class Controller" in capsys.readouterr().out
    assert main(["mission", good, "--budget", "30", "--emit", "dot"]) == 1
    assert "too many states" in capsys.readouterr().err


# ------------------------------------------------------------------------------------------------ simulation
def test_a_script_is_stepped(capsys: pytest.CaptureFixture[str], good: str, tmp_path: Path) -> None:
    script = tmp_path / "events.txt"
    script.write_text("start\nlose Gps   # to the other alternative\nok Move\n", encoding="utf-8")
    assert main(["mission", good, "--simulate", "--events", str(script)]) == 0
    out = capsys.readouterr().out
    assert "localisation switches from gps to imu" in out and "out of service: Gps" in out and "objectives: Look" in out


def test_a_refused_event_of_a_script_fails(capsys: pytest.CaptureFixture[str], good: str, tmp_path: Path) -> None:
    script = tmp_path / "events.txt"
    script.write_text("ok Move\n", encoding="utf-8")
    assert main(["mission", good, "--simulate", "--events", str(script)]) == 1
    assert "refused" in capsys.readouterr().out
    assert main(["mission", good, "--simulate", "--events", str(tmp_path / "none")]) == 2


# ------------------------------------------------------------------------------------------------ usage
def test_one_of_several_missions_is_chosen(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    path = tmp_path / "m.mauve"
    path.write_text(GOOD + "mission Two { Film }\n", encoding="utf-8")
    assert main(["mission", str(path), "--emit", "net"]) == 2
    assert main(["mission", str(path), "--emit", "net", "--mission", "Twoo"]) == 2
    assert main(["mission", str(path), "--mission", "Two", "--format", "json"]) == 0
    captured = capsys.readouterr()
    assert [mission["name"] for mission in document(captured.out)["missions"]] == ["Two"]
    assert "choose one of `M`, `Two`" in captured.err and "has `Two`" in captured.err


def test_a_check_tells_what_it_found_of_missions(capsys: pytest.CaptureFixture[str], good: str) -> None:
    assert main(["check", good]) == 0
    assert "mission M holds" in capsys.readouterr().out
