"""The control laws, their guards, and the frames sent to the track controller."""

from __future__ import annotations

import math

import pytest
from robot.codels import TTRK, Robot, State, crc16

OK, TIMEOUT, BAD_FRAME = 0, 1, 2


@pytest.fixture
def robot() -> Robot:
    return Robot(TTRK / "ttrk.elf")


def test_rotate_turns_the_short_way_on_the_spot(robot: Robot) -> None:
    for heading, side in [(0.0, 1), (3.0, -1), (math.pi - 0.1, -1), (-1.4, 1), (-math.pi + 0.1, -1)]:
        robot.aim(State(heading=heading), (0.0, 5.0, 0.0))  # the target lies to the north
        left, right = robot.control("rotate")
        assert left == -right
        assert math.copysign(1, right) == side, heading
        assert abs(right) <= 0.4 + 1e-6


def test_rotate_is_proportional_and_damped(robot: Robot) -> None:
    robot.aim(State(heading=-0.1), (5.0, 0.0, 0.0))
    assert robot.control("rotate")[1] == pytest.approx(0.8 * 0.1, rel=1e-6)
    robot.aim(State(heading=-0.1, yaw_rate=0.5), (5.0, 0.0, 0.0))
    assert robot.control("rotate")[1] == pytest.approx(0.8 * 0.1 - 0.05 * 0.5, rel=1e-6)


def test_reach_drives_ahead_brakes_and_stops(robot: Robot) -> None:
    speeds = []
    for distance in (50.0, 1.0, 0.5, 0.25, 0.1):
        robot.aim(State(), (distance, 0.0, 0.0))
        left, right = robot.control("reach")
        assert left == pytest.approx(right, abs=1e-6)
        speeds.append(left)
    assert speeds == pytest.approx([0.8, math.sqrt(0.6), math.sqrt(0.3), math.sqrt(0.15), 0.0], abs=1e-6)


def test_reach_steers_towards_the_target(robot: Robot) -> None:
    robot.aim(State(), (10.0, 1.0, 0.0))
    left, right = robot.control("reach")
    error = math.atan2(1.0, 10.0)
    assert right - left == pytest.approx(2 * 0.6 * error, rel=1e-5)
    assert (right + left) / 2 == pytest.approx(0.8 * math.cos(error), rel=1e-5)


def test_halt(robot: Robot) -> None:
    robot.send(0.5, 0.5)
    assert robot.control("halt") == (0.0, 0.0)


def test_guards_leave_a_band_between_them(robot: Robot) -> None:
    for error, aligned, strayed in [(0.0, True, False), (0.049, True, False), (0.051, False, False),
                                    (0.29, False, False), (0.31, False, True), (3.0, False, True)]:  # fmt: skip
        for sign in (1, -1):
            robot.aim(State(heading=sign * error), (20.0, 0.0, 0.0))
            assert robot.guard("aligned") is aligned, error
            assert robot.guard("strayed") is strayed, error


def unstuff(frame: bytes) -> bytes:
    assert frame[0] == frame[-1] == 0x7E
    assert 0x7E not in frame[1:-1]
    content, escaped = bytearray(), False
    for byte in frame[1:-1]:
        if byte == 0x7D and not escaped:
            escaped = True
            continue
        content.append(byte ^ 0x20 if escaped else byte)
        escaped = False
    return bytes(content)


def test_frames_carry_the_speeds(robot: Robot) -> None:
    for number, (left, right) in enumerate([(0.0, 0.0), (0.5, -0.25), (2.0, -2.0), (0.1265, 0.125), (-0.13, 1.53)]):
        status, frame = robot.send(left, right)
        assert status == OK
        content = unstuff(frame)
        assert content[:2] == bytes([number, 0x11])
        assert int.from_bytes(content[2:4], "big", signed=True) == pytest.approx(left * 1000, abs=1)
        assert int.from_bytes(content[4:6], "big", signed=True) == pytest.approx(right * 1000, abs=1)
        assert int.from_bytes(content[6:8], "big") == crc16(content[:6])
        robot.sent()


def test_flags_in_the_content_are_escaped(robot: Robot) -> None:
    status, frame = robot.send(0.1265, 0.1255)  # 126 and 125 mm/s
    assert status == OK
    assert unstuff(frame)[2:6] == bytes([0, 0x7E, 0, 0x7D])
    assert len(frame) >= 12


def test_a_busy_line_and_bad_speeds_send_nothing(robot: Robot) -> None:
    assert robot.send(0.1, 0.1)[0] == OK
    busy = robot.send(0.2, 0.2)
    assert busy[0] == TIMEOUT
    robot.sent()
    for left, right in [(2.01, 0.0), (0.0, -2.01), (math.nan, 0.0), (0.0, math.inf)]:
        assert robot.send(left, right) == (BAD_FRAME, b"")
