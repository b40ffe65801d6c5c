"""Missions whose activities need each other's products: where they get stuck, the verdicts say so."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from mauve.cli import main

BOTH = """mauve 1
hardware H: x may fail, may recover
hardware G: x may fail, may recover
resource sa: T shared
resource sb: T shared
activity a { produces sa  alternative v { consumes H } alternative w { consumes sb } on recovery upgrade }
activity b { produces sb  alternative v { consumes G } alternative w { consumes sa } on recovery upgrade }
activity u { consumes sa }
activity v { consumes sb }
objective O { does u }
objective P { does v }
mission M { parallel { mandatory O mandatory P } }
"""
RUN = ["H_EV_OOS", "G_EV_OOS", "MISSION_EV_START", "H_EV_RD", "H_EV_OOS", "H_EV_RD"]
"""H is back, a serves b; H goes, each waits for the other; H is back again, and a asks for what it waits for."""


@pytest.fixture
def cyclic(tmp_path: Path) -> str:
    path = tmp_path / "cyclic.mauve"
    path.write_text(BOTH, encoding="utf-8")
    return str(path)


def test_a_cascade_that_breaks_the_net_is_a_verdict(cyclic: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mission", cyclic, "--format", "json"]) == 1
    out, err = capsys.readouterr()
    (found,) = json.loads(out)["missions"]
    assert found["alternatives_graph"] == {"states": None, "transitions": None}
    holds = {one["name"]: one["holds"] for one in found["properties"]}
    assert holds == {"bounded": False, "deterministic": None, "live": None, "success_reachable": None}
    assert found["properties"][0]["witness"] == RUN
    assert "a needs b needs a" in found["properties"][0]["note"]
    assert "MV704" in err and "`bounded` does not hold" in err


def test_it_has_no_graph_to_write_and_the_check_fails(cyclic: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["mission", cyclic, "--emit", "dot"]) == 1
    assert "it has no graph" in capsys.readouterr().err
    assert main(["check", cyclic]) == 1
    assert "no graph: the mission is not sound" in capsys.readouterr().out


def test_the_simulation_refuses_the_event(cyclic: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    script = tmp_path / "events"
    script.write_text("\n".join(RUN), encoding="utf-8")
    assert main(["mission", cyclic, "--simulate", "--events", str(script)]) == 1
    assert "H_EV_RD: refused, activities that need each other's products" in capsys.readouterr().out


def test_bytes_that_are_no_text_are_refused_events(cyclic: str) -> None:
    command = [sys.executable, "-m", "mauve", "mission", cyclic, "--simulate"]
    environment = {"PYTHONIOENCODING": "utf-8:strict", "PYTHONPATH": ":".join(sys.path)}
    done = subprocess.run(command, input=b"\xff\xfe\nstart\n", capture_output=True, env=environment, check=False)
    assert done.returncode == 1
    assert b"there is no such event" in done.stdout and b"MISSION_EV_START" in done.stdout
