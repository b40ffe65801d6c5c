"""What is not proven is not told as if it were: contention, an objective beyond the budget, files without missions."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from mauve.cli import main

RIVALS = """mauve 1
hardware H: x
hardware G: x
activity u { consumes H }
activity v { consumes H }
activity w { consumes G }
objective O { does u }
objective P { does v }
objective Q { does w }
mission M {
  parallel {
    mandatory O
    optional P
  } ; Q
  check ltl always_true: always true
  check ltl never_w: always not running(w)
}
"""


def answered(text: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> tuple[int, list[Any], str]:
    path = tmp_path / "robot.mauve"
    path.write_text(text, encoding="utf-8")
    code = main(["mission", str(path), "--format", "json"])
    out, err = capsys.readouterr()
    return code, json.loads(out)["missions"], err


def test_one_order_of_several_proves_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, (mission,), err = answered(RIVALS, tmp_path, capsys)
    assert code == 1 and "MV709" in err and "MV713" not in err
    assert {one["name"]: one["holds"] for one in mission["properties"]} == {
        "bounded": True,
        "deterministic": False,
        "live": None,
        "success_reachable": True,
        "always_true": None,
        "never_w": False,
    }


def test_an_objective_with_thirty_devices_is_undecided_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    devices = [f"H{number}" for number in range(30)]
    text = "mauve 1\n" + "".join(f"hardware {one}: x may fail, may recover\n" for one in devices)
    text += f"activity u {{ consumes {', '.join(devices)} }}\nobjective O {{ does u }}\nmission M {{ O }}\n"
    code, (mission,), err = answered(text, tmp_path, capsys)
    assert code == 1 and "MV720" in err and "MV725" in err
    assert all(one["holds"] is None for one in mission["properties"])
    assert mission["cuts"] == [[one] for one in devices]
    assert mission["seconds"] < 2
    assert main(["mission", str(tmp_path / "robot.mauve")]) == 1
    assert "mission M is not decided" in capsys.readouterr().out


def test_a_file_without_missions_has_a_document(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code, missions, err = answered("mauve 1\nhardware H: x\n", tmp_path, capsys)
    assert (code, missions) == (1, []) and "has no mission" in err
