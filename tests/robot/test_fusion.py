"""The fusion filter: it follows the motion, weighs its sources, and keeps a proper covariance."""

from __future__ import annotations

import math
import struct

import pytest
from robot.codels import TTRK, Position, Robot

EARTH = 6_371_000.0
ORIGIN = (math.radians(43.565), math.radians(1.473))


@pytest.fixture
def robot() -> Robot:
    robot = Robot(TTRK / "ttrk.elf")
    robot.open()
    return robot


def fix_at(east: float, north: float, stamp: int) -> Position:
    latitude, longitude = ORIGIN
    return Position(latitude + north / EARTH, longitude + east / (EARTH * math.cos(latitude)), 0.0, stamp)


def test_reset(robot: Robot) -> None:
    covariance = robot.covariance()
    assert [covariance[i][i] for i in range(4)] == [25.0, 25.0, 1.0, 0.25]
    assert robot.estimate().x == robot.estimate().speed == 0.0


def test_first_fix_is_the_origin(robot: Robot) -> None:
    robot.fuse(fix_at(0.0, 0.0, 10), [])
    estimate = robot.estimate()
    assert (estimate.x, estimate.y) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert robot.covariance()[0][0] < 25.0


def test_follows_a_straight_drive(robot: Robot) -> None:
    """0.5 m/s to the north-east, noise-free: after 2 s position, heading and speed are right."""
    heading, speed = math.pi / 4, 0.5
    for step in range(1, 201):
        way = 0.01 * step * speed
        robot.fuse(fix_at(way * math.cos(heading), way * math.sin(heading), step), [heading] * 10)
    estimate = robot.estimate()
    assert estimate.heading == pytest.approx(heading, abs=0.01)
    assert estimate.speed == pytest.approx(speed, abs=0.05)
    assert estimate.x == pytest.approx(2 * speed * math.cos(heading), abs=0.05)
    assert estimate.y == pytest.approx(2 * speed * math.sin(heading), abs=0.05)


def test_turning_across_the_half_turn_gives_the_yaw_rate(robot: Robot) -> None:
    robot.fuse(Position(), [math.pi - 0.004])
    robot.fuse(Position(), [math.pi - 0.002, -math.pi + 0.002])  # 6 mrad in one period
    assert robot.estimate().yaw_rate == pytest.approx(0.6, abs=1e-3)


def test_a_fix_counts_once(robot: Robot) -> None:
    robot.fuse(fix_at(0, 0, 5), [])
    once = robot.covariance()[0][0]
    robot.fuse(fix_at(0, 0, 5), [])
    assert robot.covariance()[0][0] > once
    robot.fuse(fix_at(0, 0, 6), [])
    assert robot.covariance()[0][0] < once


def test_a_larger_weight_trusts_the_fix_more(robot: Robot) -> None:
    results = []
    for weight in (0.0, 0.01, 0.2, 1.0):
        robot.open()
        robot.emulator.write(robot.weight, struct.pack("<d", weight))
        robot.fuse(fix_at(0, 0, 1), [])
        robot.fuse(fix_at(3, 0, 2), [])
        results.append(robot.estimate().x)
    assert results[0] == results[1] < results[2] < results[3] < 3.0


def test_covariance_stays_symmetric_and_positive(robot: Robot) -> None:
    for step in range(60):
        robot.fuse(fix_at(math.sin(step), step * 0.1, step // 3), [0.3 * step] * (step % 17))
        covariance = robot.covariance()
        for i in range(4):
            assert covariance[i][i] > 0.0
            for j in range(4):
                assert covariance[i][j] == pytest.approx(covariance[j][i], abs=1e-9)
                assert covariance[i][j] ** 2 <= covariance[i][i] * covariance[j][j] * (1 + 1e-9)


def test_more_samples_than_the_connection_holds_are_not_read(robot: Robot) -> None:
    robot.fuse(Position(), [0.0] * 16 + [1.0] * 4)
    assert robot.estimate().yaw_rate == 0.0
