"""The robot's own elementary functions agree with the host's, and are total."""

from __future__ import annotations

import math
from collections.abc import Iterator

import pytest
from emulator import Emulator
from robot.codels import TTRK, crc16

ANGLES = [k * 0.0511 for k in range(-140, 141)] + [k * math.pi / 4 for k in range(-9, 10)] + [1e3, -12345.6, 9.9e5]
NOT_ANGLES = [math.nan, math.inf, -math.inf, 1.1e6, -1e300]


@pytest.fixture(scope="module")
def emulator() -> Iterator[Emulator]:
    yield Emulator(TTRK / "ttrk.elf", "arm926ej-s")


def test_sine_and_cosine(emulator: Emulator) -> None:
    for angle in ANGLES:
        assert emulator.call("real_sin", [angle]).float64 == pytest.approx(math.sin(angle), abs=1e-9), angle
        assert emulator.call("real_cos", [angle]).float64 == pytest.approx(math.cos(angle), abs=1e-9), angle


def test_wrap_is_the_same_angle_within_half_a_turn(emulator: Emulator) -> None:
    for angle in ANGLES:
        wrapped = emulator.call("real_wrap", [angle]).float64
        assert abs(wrapped) <= math.pi + 1e-9
        assert math.cos(wrapped - angle) == pytest.approx(1.0, abs=1e-9), angle


def test_out_of_range_angles_are_angle_zero(emulator: Emulator) -> None:
    for angle in NOT_ANGLES:
        assert emulator.call("real_wrap", [angle]).float64 == 0.0
        assert emulator.call("real_sin", [angle]).float64 == 0.0
        assert emulator.call("real_cos", [angle]).float64 == 1.0


def test_arctangent_in_all_octants(emulator: Emulator) -> None:
    values = [0.0, 1e-9, 0.3, 0.41421356, 0.41421357, 1.0, 2.5, 1e6]
    for y in [*values, *(-v for v in values)]:
        for x in [*values, *(-v for v in values)]:
            got = emulator.call("real_atan2", [y, x]).float64
            expected = math.atan2(y, x)
            if y == 0.0:  # no signed zero: the negative x axis is +pi
                expected = abs(expected)
            if x == 0.0 and y == 0.0:
                expected = 0.0
            assert got == pytest.approx(expected, abs=1e-10), (y, x)


def test_square_root(emulator: Emulator) -> None:
    for value in [1e-300, 1e-12, 0.25, 0.5, 1.0, 2.0, 3.999999, 4.0, 1234.5, 1e17, 1e300]:
        assert emulator.call("real_sqrt", [value]).float64 == pytest.approx(math.sqrt(value), rel=1e-12), value
    for value in [0.0, -0.0, -1.0, math.nan, -math.inf]:
        assert emulator.call("real_sqrt", [value]).float64 == 0.0


def test_crc(emulator: Emulator) -> None:
    for data in [b"", b"\0", b"123456789", bytes(range(256))]:
        crc = 0xFFFF
        for byte in data:
            crc = emulator.call("crc16_byte", [crc, byte]).r0
        assert crc == crc16(data)
    assert crc16(b"123456789") == 0x29B1  # the check value of CRC-16/CCITT-FALSE
