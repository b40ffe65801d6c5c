"""Each diagnostic of missions appears where it should, and nowhere near."""

from __future__ import annotations

from pathlib import Path

import pytest
from missions.cases import GOOD, HEAD

from mauve.diagnostics.diagnostic import Report
from mauve.diagnostics.rules import RULES
from mauve.pipeline import Options, check
from mauve.records import record


@record
class Case:
    """A diagnostic, a text with it, and one as near as possible without it."""

    code: str
    bad: str
    good: str


def _mission(steps: str, extra: str = "", checks: str = "", head: str = HEAD) -> str:
    return f"{head}{extra}mission M {{\n  {steps}\n{checks}}}\n"


COMPONENTS = """
struct Pose { x, y: f64 }
struct Position { x, y: f64 }
struct Attitude { a, b: f64 }
component Mover {
  in port pose: %s
  codel step reads pose wcet 1ms
  behaviour {
    initial state Slow { run step }
  }
}
"""
TIED = HEAD.replace("move { consumes place }", "move { consumes place runs Mover mode a = state %s }")
SHARE = """resource tool: Tool%s
activity tooling { produces tool }
activity a { consumes tool }
activity b { consumes tool }
"""
SPEED = """resource speed: f64
activity odometry {
  alternative gps priority 2 { consumes Gps produces speed }
  alternative imu priority 1 { consumes Imu }
}
activity use { consumes speed }
objective Use { does use }
"""
PAIR = "objective A { does a }\nobjective B { does b }\n"
BOTH = "parallel P {\n    mandatory A\n    mandatory B\n  }"

CASES = (
    Case(
        "MV701",
        _mission("parallel P { optional Film }"),
        _mission("parallel P {\n    mandatory Film\n    optional Move\n  }"),
    ),
    Case("MV702", _mission("Move", "activity x { consumes nothing_there }\n"), GOOD),
    Case(
        "MV702",
        _mission("X", "resource r: T\nactivity x { consumes r }\nobjective X { does x }\n"),
        _mission("X", "resource r: T\nactivity y { produces r }\nactivity x { consumes r }\nobjective X { does x }\n"),
    ),
    Case("MV703", _mission("Move", "activity other { produces place }\n"), GOOD),
    Case(
        "MV704",
        _mission("X", "resource r, s: T\n".replace(", s", "") + "resource s: T\nactivity x { consumes r produces s }\n"
                 "activity y { consumes s produces r }\nobjective X { does x }\n"),
        _mission("X", "resource r: T\nresource s: T\nactivity x { consumes r produces s }\n"
                 "activity y { produces r }\nobjective X { does x }\n"),
    ),
    Case(
        "MV704",
        _mission("X", "resource r: T\nresource s: T\nactivity x { consumes r produces s }\nactivity y {\n  produces r\n"
                 "  alternative fine priority 2 { consumes s }\n  alternative coarse priority 1 { consumes Gps }\n}\n"
                 "objective X { does x }\n"),
        GOOD,
    ),
    Case("MV705", GOOD.replace("priority 1", "priority 2"), GOOD),
    Case("MV706", GOOD.replace("{ consumes attitude }", "{ consumes attitude, position }"), GOOD),
    Case("MV706", GOOD.replace("{ consumes position }", "{ consumes Clock }"), GOOD),
    Case("MV707", GOOD.replace("{ consumes attitude }", "{ consumes position }"), GOOD),
    Case("MV708", GOOD.replace("position: Position", "position: Position may fail"), GOOD),
    Case("MV708", _mission("Move", "activity x { produces Clock }\n"), GOOD),
    Case(
        "MV709",
        _mission(BOTH, SHARE % "" + PAIR),
        _mission(BOTH, SHARE % " shared" + PAIR),
    ),
    Case("MV709", _mission(BOTH, "activity a { consumes Arm }\nactivity b { consumes Arm }\n" + PAIR),
         _mission("A ; B", "activity a { consumes Arm }\nactivity b { consumes Arm }\n" + PAIR)),
    Case(
        "MV710",
        _mission("X", "resource r: T\nactivity y { consumes r }\nobjective X { does y }\n"),
        _mission("X", "resource r: T\nactivity y {\n  alternative a { consumes r }\n  alternative b { }\n}\n"
                 "objective X { does y }\n"),
    ),
    Case(
        "MV710",
        _mission("X", "resource r: T\nactivity y { consumes Clock produces r }\nactivity x { consumes Clock, r }\n"
                 "objective X { does x }\n"),
        _mission("X", "resource r: T\nactivity y { consumes Clock produces r }\nactivity x { consumes r }\n"
                 "objective X { does x }\n"),
    ),
    Case("MV711", _mission("Move ; Look ; Grip"), GOOD),
    Case(
        "MV712",
        _mission("A", "objective A { Move ; B }\nobjective B { Look ; A }\n"),
        _mission("A", "objective A { Move ; B }\nobjective B { Look ; Grip }\n"),
    ),
    Case(
        "MV713",
        _mission("Move", "", "  check success reachable with at most 2 of Gps, Imu out of service\n"),
        _mission("Move", "", "  check success reachable with at most 1 of Gps, Imu out of service\n"),
    ),
    Case("MV714", _mission("Grip"), _mission("Grip", "", "  accepts single failure of Arm\n")),
    Case("MV714", _mission("Grip"), _mission("Grip on failure continue")),
    Case(
        "MV715",
        _mission("parallel P {\n    mandatory Move\n    optional X\n  }", "objective X { does localisation }\n"),
        _mission("parallel P {\n    mandatory Move\n    optional Look\n  }"),
    ),
    Case("MV716", _mission("Move", COMPONENTS % "Position", head=TIED % "Slow"),
         _mission("Move", COMPONENTS % "Pose", head=TIED % "Slow")),
    Case("MV303", _mission("Move", COMPONENTS % "Pose", head=TIED % "Fast"),
         _mission("Move", COMPONENTS % "Pose", head=TIED % "Slow")),
    Case(
        "MV717",
        _mission("Where ; Use", SPEED + "objective Where { does odometry }\n"),
        _mission("Use", SPEED),
    ),
    Case("MV718", _mission("Grip on failure recover { Grip }"), _mission("Grip on failure recover { Move }")),
    Case("MV719", _mission("Grip on failure retry 2"), _mission("Move on failure retry 2")),
    Case("MV721", _mission("Move", "", "  check ltl never: always not success\n"),
         _mission("Move", "", "  check ltl never: always not (success and failure)\n")),
    Case("MV722", GOOD.replace("{ consumes Arm }", "{ consumes Arm runs Gripper }"), GOOD),
)  # fmt: skip


def codes(text: str, folder: Path) -> set[str]:
    path = folder / "robot.mauve"
    path.write_text(text, encoding="utf-8")
    report = Report()
    check(str(path), Options(cache=False), report)
    for diagnostic in report:
        assert diagnostic.code in RULES and diagnostic.primary is not None and diagnostic.primary.span.text
    return {diagnostic.code for diagnostic in report}


@pytest.mark.parametrize("case", CASES, ids=[f"{case.code}-{index}" for index, case in enumerate(CASES)])
def test_a_diagnostic_appears_where_it_should_and_not_next_to_it(case: Case, tmp_path: Path) -> None:
    assert case.code in codes(case.bad, tmp_path)
    assert case.code not in codes(case.good, tmp_path)


def test_a_good_mission_has_no_message(tmp_path: Path) -> None:
    assert codes(GOOD, tmp_path) == set()
