"""C globals that codels of two tasks reach are told; what one section or one task keeps apart is not."""

from __future__ import annotations

from pathlib import Path

import pytest

from mauve.diagnostics.diagnostic import Report
from mauve.pipeline import Options, check
from mauve.records import changed
from mauve.verdict.globals import check_globals
from mauve.verdict.result import DeploymentResult
from mauve.wcet.result import GlobalUse

ROBOT = Path(__file__).resolve().parents[2] / "examples" / "ttrk" / "ttrk.mauve"


@pytest.fixture(scope="module")
def robot() -> DeploymentResult:
    (result,) = check(str(ROBOT), Options(deployment="on_robot"), Report()).deployments
    return result


def told(robot: DeploymentResult, uses: dict[str, tuple[GlobalUse, ...]]) -> list[tuple[str, str, str]]:
    codels = [
        codel
        if codel.result is None
        else changed(codel, result=changed(codel.result, globals=uses.get(str(codel.plan.id), ())))
        for codel in robot.codels
    ]
    report = Report()
    check_globals([node.tasks for node in robot.nodes], codels, report)
    found = []
    for one in report:
        assert one.code == "MV217" and one.primary is not None
        found.append((one.message.split("`")[1], one.primary.text, one.labels[0].text))
    return found


READ, WRITE = GlobalUse("state", True, False), GlobalUse("state", False, True)


def test_a_write_in_one_task_and_a_read_in_another(robot: DeploymentResult) -> None:
    assert told(robot, {"IG500.read": (READ,), "CHR6dm.read": (WRITE,)}) == [
        ("state", "`CHR6dm.read` writes it in task `chr6dm`", "`IG500.read` reads it in task `ig500`")
    ]


@pytest.mark.parametrize(
    "uses",
    [
        {"IG500.read": (READ,), "CHR6dm.read": (READ,)},
        {"Command.rotate": (WRITE,), "Command.reach": (WRITE, READ)},
        {"IG500.read": (WRITE,), "CHR6dm.read": (GlobalUse("other", True, True),)},
        {},
    ],
)
def test_reads_alone_and_one_task_are_no_race(robot: DeploymentResult, uses: dict[str, tuple[GlobalUse, ...]]) -> None:
    assert told(robot, uses) == []


def test_many_objects_are_counted(robot: DeploymentResult) -> None:
    many = tuple(GlobalUse(f"g{n:02}", True, True) for n in range(11))
    found = told(robot, {"IG500.read": many, "CHR6dm.read": many})
    assert [symbol for symbol, _, _ in found] == [f"g{n:02}" for n in range(8)]


def test_the_robot_shares_no_globals(robot: DeploymentResult) -> None:
    report = Report()
    check_globals([node.tasks for node in robot.nodes], robot.codels, report)
    assert not list(report)
