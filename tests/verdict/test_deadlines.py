"""Verdicts: missed deadlines with their bill, overloads, expectations."""

from __future__ import annotations

from pathlib import Path

import pytest
from written import MODELS, codes

from mauve.diagnostics.diagnostic import Report, Severity
from mauve.pipeline import Options, check
from mauve.timing.response import Method
from mauve.verdict.result import CheckResult

BOARD = """board bare {
  cpu "arm926ej-s" at 200MHz
}
"""
SLOW = """    assume IG500.read wcet 1ms
    assume CHR6dm.read wcet 350us
    assume StateFusion.fuse wcet 4.9ms
    assume Command.rotate wcet 100us
    assume Command.reach wcet 400us
    assume CICAS.send_frame wcet 100us
    assume Command.halt wcet 75us
    assume others wcet 50us
"""


def _check(
    tmp_path: Path, fusion: str = "4.9ms", head: str = "", method: Method = Method.TRACE
) -> tuple[CheckResult, Report]:
    """The robot on a board without overheads, with the times of the bill in the semantics of record."""
    text = (MODELS / "ttrk.mauve").read_text(encoding="utf-8")
    text = text[: text.index("/// Desktop trial")] + BOARD
    text += f"deployment bench of TTRK {{\n{head}\n  node base on bare {{\n{SLOW.replace('4.9ms', fusion)}  }}\n}}\n"
    path = tmp_path / "robot.mauve"
    path.write_text(text, encoding="utf-8")
    report = Report()
    return check(str(path), Options(method=method, cache=False), report), report


def test_the_bill_of_a_missed_deadline(tmp_path: Path) -> None:
    result, report = _check(tmp_path)
    (found,) = [d for d in report if d.code != "MV420"]
    assert found.message == "`command` responds within 19.5ms, its deadline is 10ms (deployment `bench`)"
    assert found.notes == (
        "by 10ms, 10.1ms of work is due:\n"
        "4.9ms  fusion      1 x 4.9ms   (priority 15)\n"
        "3.5ms  chr6dm      10 x 350us  (priority 30)\n"
        "  1ms  ig500       1 x 1ms     (priority 20)\n"
        "700us  of its own  (Reaching -> Rotating: Command.reach, CICAS.send_frame, Command.strayed, Command.halt)",
    )
    assert found.help is not None and found.help.text.startswith("it fits if `fusion` takes at most 4.8ms (now 4.9ms)")
    assert dict(found.data)["due_ps"] == 10_100_000_000
    assert not result.passes(report)


def test_what_the_help_says_makes_it_fit(tmp_path: Path) -> None:
    result, report = _check(tmp_path, fusion="4.8ms")
    assert result.passes(report) and codes(report) == []
    result, report = _check(tmp_path, fusion="4.801ms")
    assert codes(report) == ["MV601"]


def test_an_overload_names_those_who_cause_it(tmp_path: Path) -> None:
    _, report = _check(tmp_path, fusion="6ms")
    overload = next(d for d in report if d.code == "MV602")
    assert "`base` is overloaded" in overload.message
    assert [line.split()[-1] for line in overload.notes[0].split("\n")[1:]] == ["fusion", "chr6dm", "ig500"]


@pytest.mark.parametrize(
    ("fusion", "head", "expected", "passes"),
    [
        ("1ms", "", [], True),
        ("1ms", "expect unschedulable", [("MV604", Severity.ERROR)], False),
        ("4.9ms", "", [("MV601", Severity.ERROR)], False),
        ("4.9ms", "expect unschedulable", [("MV601", Severity.NOTE)], True),
    ],
)
def test_an_expectation_inverts_the_verdict(
    tmp_path: Path, fusion: str, head: str, expected: list[tuple[str, Severity]], passes: bool
) -> None:
    result, report = _check(tmp_path, fusion, head)
    assert [(d.code, d.severity) for d in report if d.code != "MV420"] == expected
    assert result.passes(report) == passes


def test_the_papers_method_warns_where_it_may_be_too_small(tmp_path: Path) -> None:
    _, report = _check(tmp_path, method=Method.PAPER)
    assert "MV603" in codes(report)
    _, report = _check(tmp_path, fusion="1ms", method=Method.PAPER)
    assert codes(report) == []


def test_an_incomplete_deployment_is_neither_schedulable_nor_as_expected(tmp_path: Path) -> None:
    text = (MODELS / "ttrk.mauve").read_text(encoding="utf-8").replace("    assume others wcet 10us ", "    //")
    path = tmp_path / "robot.mauve"
    path.write_text(text.replace("deployment bench of TTRK {", "deployment bench of TTRK {\n  expect unschedulable"))
    report = Report()
    result = check(str(path), Options(cache=False), report)
    (deployment,) = result.deployments
    assert not deployment.complete and not deployment.holds and not deployment.as_expected
    assert set(codes(report)) == {"MV520"}
    assert deployment.nodes[0].analysis is None or deployment.nodes[0].tasks.tasks == ()


WAITING = """mauve 1
package waiting
struct Pose { x, y: f32 }
component Mapper {
  var grid: Pose
  operation locate(): Pose = locate_now runs in owner
  codel integrate writes grid wcet 1ms
  codel locate_now reads grid returns Pose wcet 1ms
  behaviour { initial state Map { method locate_now run integrate } }
}
component Planner {
  method locate(): Pose
  var pose: Pose
  codel plan writes pose wcet 4ms
  behaviour { initial state Plan { run pose = locate() then plan } }
}
architecture Robot {
  instance mapper: Mapper { period 20ms priority 2 deadline 20ms }
  instance planner: Planner { period 20ms priority 1 deadline 60ms }
  connect planner.locate -> mapper.locate
}
board bare {
  cpu "arm926ej-s" at 200MHz
}
deployment d of Robot {
  node base on bare {
  }
}
"""


def test_a_wait_that_is_too_long_says_what_would_bound_it(tmp_path: Path) -> None:
    path = tmp_path / "waiting.mauve"
    path.write_text(WAITING, encoding="utf-8")
    report = Report()
    assert not check(str(path), Options(cache=False), report).passes(report)
    (found,) = [d for d in report if d.code == "MV605"]
    assert found.message == "the response of `planner` has no bound (deployment `d`)"
    assert found.help is not None and found.help.text.startswith("run the owner of the operation more often")
    for remedy in (("period 20ms priority 2 deadline 20ms", "period 5ms priority 2"), ("in owner", "in caller")):
        path.write_text(WAITING.replace(*remedy), encoding="utf-8")
        mended = Report()
        check(str(path), Options(cache=False), mended)
        assert "MV605" not in [d.code for d in mended]
