"""The two sensor drivers: what is accepted, what is rejected, and that no byte stream leaves their buffers."""

from __future__ import annotations

import math
import random

import pytest
from robot.codels import GPS_CAPACITY, IMU_CAPACITY, TTRK, Robot, fix, gps_frame, imu_packet

UNIT = 0.0109863 * math.pi / 180


@pytest.fixture
def robot() -> Robot:
    robot = Robot(TTRK / "ttrk.elf")
    robot.open()
    return robot


def test_open_takes_the_channel_from_the_device_name(robot: Robot) -> None:
    assert robot.emulator.unpack(robot.gps + GPS_CAPACITY + 2, "<3I") == (0, 2, 0)
    robot.emulator.call("IG500_close", [robot.gps])
    robot.gps_receives(gps_frame(fix(1, 2, 3, 4)))
    assert robot.read_gps().stamp == 0


def test_a_fix_is_decoded(robot: Robot) -> None:
    robot.gps_receives(gps_frame(fix(123_456, 43.5650123, -1.4730567, -12.345)))
    position = robot.read_gps()
    assert position.latitude == pytest.approx(math.radians(43.5650123), abs=1e-12)
    assert position.longitude == pytest.approx(math.radians(-1.4730567), abs=1e-12)
    assert position.altitude == pytest.approx(-12.345, abs=1e-9)
    assert position.stamp == 123_456_000_000
    assert robot.gps_counters() == (0, 0)


@pytest.mark.parametrize("bit", [16, 30, 44, 100, 8 * 23 + 3, 8 * 25])
def test_a_flipped_bit_is_rejected(robot: Robot, bit: int) -> None:
    frame = bytearray(gps_frame(fix(9, 1, 2, 3)))
    frame[bit // 8] ^= 1 << bit % 8
    robot.gps_receives(bytes(frame) + bytes(60))
    assert robot.read_gps().stamp == 0
    assert robot.gps_counters()[1] == 1


def test_frames_are_found_wherever_they_are_cut(robot: Robot) -> None:
    stream = b"\xff\x11\x02" + gps_frame(fix(1, 1, 1, 1)) + b"\xff\xff" + gps_frame(fix(2, 2, 2, 2))
    for cut in range(len(stream) + 1):
        robot.open()
        stamps = []
        for part in (stream[:cut], stream[cut:], b"", b""):
            robot.gps_receives(part)
            stamps.append(robot.read_gps().stamp // 1_000_000)
        assert stamps[-1] == 2, cut
        assert robot.gps_counters() == (0, 0), cut


def test_other_commands_no_fix_and_long_payloads(robot: Robot) -> None:
    for frame, rejected in [
        (gps_frame(fix(1, 1, 1, 1), command=0x51), 0),
        (gps_frame(fix(1, 1, 1, 1, quality=0)), 0),
        (gps_frame(b"\0" * 10), 0),
        (gps_frame(b"\0" * 49), 1),
    ]:
        robot.open()
        robot.gps_receives(frame)
        assert robot.read_gps().stamp == 0
        assert robot.gps_counters()[1] == rejected
    robot.open()
    robot.gps_receives(gps_frame(fix(7, 1, 1, 1) + bytes(30)))
    assert robot.read_gps().stamp == 7_000_000


def test_attitude_is_decoded(robot: Robot) -> None:
    robot.imu_receives(imu_packet({0: 8192, 1: -4096, 2: 100, 5: 7, 14: -1}))
    roll, pitch, yaw, stamp = robot.read_imu()
    assert (roll, pitch, yaw) == pytest.approx((100 * UNIT, -4096 * UNIT, 8192 * UNIT), rel=1e-6)
    assert stamp == 1_000_000
    assert robot.imu_counters() == (0, 0)


def test_bad_packets_are_rejected(robot: Robot) -> None:
    good = imu_packet({0: 5, 1: 6, 2: 7})
    for at in range(len(good)):
        robot.open()
        packet = bytearray(good)
        packet[at] ^= 0x10
        robot.imu_receives(bytes(packet) + bytes(40))
        assert robot.read_imu()[2] == 0.0, at
    robot.open()
    robot.imu_receives(imu_packet({1: 6, 2: 7}))  # no yaw: valid, but not an attitude
    assert robot.read_imu()[:3] == (0.0, 0.0, 0.0)
    assert robot.imu_counters() == (0, 0)


def test_packets_are_found_wherever_they_are_cut(robot: Robot) -> None:
    stream = b"ss" + imu_packet({0: 1, 1: 1, 2: 1}) + b"s" + imu_packet({0: 2, 1: 2, 2: 2})
    for cut in range(len(stream) + 1):
        robot.open()
        for part in (stream[:cut], stream[cut:], b""):
            robot.imu_receives(part)
            yaw = robot.read_imu()[2]
        assert yaw == pytest.approx(2 * UNIT, rel=1e-6), cut
        assert robot.imu_counters() == (0, 0), cut


def test_random_bytes_stay_inside_the_buffers(robot: Robot) -> None:
    """Noise, also with counts that the driver must never leave: no write outside the inbox, and progress is made."""
    noise = random.Random(5)
    alphabet = b"\xff\x02\x03snp\x50\x00\x12" + bytes(range(40, 50))
    for capacity, inbox, out, codel in [
        (GPS_CAPACITY, robot.gps, robot.position, "IG500_read"),
        (IMU_CAPACITY, robot.imu, robot.attitude, "CHR6dm_read"),
    ]:
        for _ in range(60):
            size = noise.choice((0, 1, 7, capacity // 2, capacity))
            claimed = noise.choice((size, size, 0xFFFF_FFFF))
            robot.emulator.write(inbox, bytes(noise.choices(alphabet, k=capacity + 2)))
            robot.emulator.write(inbox + capacity + 2, claimed.to_bytes(4, "little"))
            before = robot.emulator.read(inbox - 8, 8)
            robot.emulator.call(codel, [inbox, out])
            (left,) = robot.emulator.unpack(inbox + capacity + 2, "<I")
            assert left <= capacity
            assert robot.emulator.read(inbox - 8, 8) == before


def test_the_sync_scans_run_at_most_once_per_byte(robot: Robot) -> None:
    """The flow facts of the deployment: an inbox full of noise is the worst case of the two scans."""
    robot.gps_receives(b"\xff" * GPS_CAPACITY)
    robot.imu_receives(b"s" * IMU_CAPACITY)
    gps = robot.emulator.call("IG500_read", [robot.gps, robot.position])
    imu = robot.emulator.call("CHR6dm_read", [robot.imu, robot.attitude])
    assert max(gps.counts.values()) == GPS_CAPACITY + 1
    assert max(imu.counts.values()) == IMU_CAPACITY + 1
