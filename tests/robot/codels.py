"""Calls the TTRK codels of an image under the emulator, and builds the frames that its devices send."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path

from emulator import Emulator, Execution

ROOT = Path(__file__).parents[2]
TTRK = ROOT / "examples" / "ttrk"
GPS_CAPACITY, IMU_CAPACITY, QUEUE = 254, 62, 16
CODELS = (
    "IG500_open", "IG500_read", "IG500_close", "CHR6dm_open", "CHR6dm_read", "StateFusion_reset", "StateFusion_fuse",
    "Command_halt", "Command_rotate", "Command_reach", "Command_aligned", "Command_strayed", "CICAS_send_frame",
)  # fmt: skip


def crc16(data: bytes) -> int:
    """CRC-16/CCITT-FALSE, by polynomial division over an integer (not the way the codel does it)."""
    value = int.from_bytes(data, "big") << 16 ^ 0xFFFF << 8 * len(data)
    for bit in range(8 * len(data) + 15, 15, -1):
        if value >> bit & 1:
            value ^= 0x11021 << bit - 16
    return value


def gps_frame(payload: bytes, command: int = 0x50) -> bytes:
    """A frame of the IG500."""
    body = struct.pack(">BH", command, len(payload)) + payload
    return b"\xff\x02" + body + struct.pack(">H", crc16(body)) + b"\x03"


def fix(ms: int, latitude: float, longitude: float, altitude: float, quality: int = 3) -> bytes:
    """Payload of a position fix; angles in degrees, altitude in metres."""
    return struct.pack(
        ">IiiiBB", ms, round(latitude * 1e7), round(longitude * 1e7), round(altitude * 1e3), 9, quality
    )


def imu_packet(channels: dict[int, int], kind: int = 0xB7) -> bytes:
    """A packet of the CHR-6dm with the given raw channels."""
    mask = sum(0x8000 >> channel for channel in channels)
    payload = struct.pack(">H", mask) + b"".join(struct.pack(">h", channels[c]) for c in sorted(channels))
    packet = b"snp" + bytes([kind, len(payload)]) + payload
    return packet + struct.pack(">H", sum(packet) & 0xFFFF)


@dataclass(slots=True)
class Position:
    latitude: float = 0.0
    longitude: float = 0.0
    altitude: float = 0.0
    stamp: int = 0


@dataclass(slots=True)
class State:
    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    speed: float = 0.0
    yaw_rate: float = 0.0


class Robot:
    """One image with one object per component variable and port, as the generated code would hold them."""

    def __init__(self, elf: Path) -> None:
        self.emulator = emulator = Emulator(elf, "arm926ej-s")
        emulator.alloc(16)  # so that a write before the first inbox would be seen
        self.gps, self.imu = emulator.alloc(GPS_CAPACITY + 2 + 12), emulator.alloc(IMU_CAPACITY + 2 + 12)
        self.position, self.attitude = emulator.alloc(32), emulator.alloc(24)
        self.samples, self.weight = emulator.alloc(24 * 64), emulator.alloc(struct.pack("<d", 0.25))
        self.filter, self.state = emulator.alloc(208), emulator.alloc(32)
        self.target, self.tolerance = emulator.alloc(24), emulator.alloc(struct.pack("<d", 0.05))
        self.command, self.outbox = emulator.alloc(8), emulator.alloc(28)
        self.device = emulator.alloc(4)
        emulator.write(self.device, struct.pack("<I", emulator.alloc(b"/dev/ttyS1\0")))

    def open(self) -> None:
        """Open both devices and reset the filter."""
        self.emulator.call("IG500_open", [self.device, self.gps])
        self.emulator.call("CHR6dm_open", [self.device, self.imu])
        self.emulator.call("StateFusion_reset", [self.filter, self.state])

    def _receive(self, inbox: int, capacity: int, data: bytes) -> None:
        (count,) = self.emulator.unpack(inbox + capacity + 2, "<I")
        assert count + len(data) <= capacity, "the driver would drop bytes"
        self.emulator.write(inbox + count, data)
        self.emulator.write(inbox + capacity + 2, struct.pack("<I", count + len(data)))

    def gps_receives(self, data: bytes) -> None:
        """What the driver of the IG500's line does with received bytes."""
        self._receive(self.gps, GPS_CAPACITY, data)

    def imu_receives(self, data: bytes) -> None:
        """What the driver of the CHR-6dm's line does with received bytes."""
        self._receive(self.imu, IMU_CAPACITY, data)

    def gps_counters(self) -> tuple[int, int]:
        """(bytes left, frames rejected) of the IG500's inbox."""
        count, _, rejected = self.emulator.unpack(self.gps + GPS_CAPACITY + 2, "<3I")
        return count, rejected

    def imu_counters(self) -> tuple[int, int]:
        """(bytes left, packets rejected) of the CHR-6dm's inbox."""
        count, _, rejected = self.emulator.unpack(self.imu + IMU_CAPACITY + 2, "<3I")
        return count, rejected

    def read_gps(self) -> Position:
        self.emulator.call("IG500_read", [self.gps, self.position])
        return Position(*self.emulator.unpack(self.position, "<3dq"))

    def read_imu(self) -> tuple[float, float, float, int]:
        """(roll, pitch, yaw, stamp)."""
        self.emulator.call("CHR6dm_read", [self.imu, self.attitude])
        roll, pitch, yaw, stamp = self.emulator.unpack(self.attitude, "<3f4xq")
        return roll, pitch, yaw, stamp

    def fuse(self, position: Position, yaws: list[float]) -> Execution:
        """One activation of StateFusion with a buffer of samples that have these yaws."""
        e = self.emulator
        e.write(self.position, struct.pack("<3dq", *(getattr(position, f) for f in Position.__slots__)))
        e.write(self.samples, b"".join(struct.pack("<3f4xq", 0.0, 0.0, yaw, i) for i, yaw in enumerate(yaws)))
        return e.call(
            "StateFusion_fuse", [self.position, self.samples, len(yaws), self.weight, self.filter, self.state]
        )

    def estimate(self) -> State:
        return State(*self.emulator.unpack(self.state, "<3d2f"))

    def covariance(self) -> list[list[float]]:
        flat = self.emulator.unpack(self.filter + 32, "<16d")
        return [list(flat[4 * row : 4 * row + 4]) for row in range(4)]

    def aim(self, state: State, target: tuple[float, float, float]) -> None:
        """Set what Command reads."""
        fields = (state.x, state.y, state.heading, state.speed, state.yaw_rate)
        self.emulator.write(self.state, struct.pack("<3d2f", *fields))
        self.emulator.write(self.target, struct.pack("<3d", *target))

    def control(self, codel: str) -> tuple[float, float]:
        """Run Command's `rotate`, `reach` or `halt`; the track speeds (left, right)."""
        args = [self.command] if codel == "halt" else [self.state, self.target, self.command]
        self.emulator.call(f"Command_{codel}", args)
        left, right = self.emulator.unpack(self.command, "<2f")
        return left, right

    def guard(self, codel: str) -> bool:
        """Run Command's `aligned` or `strayed`."""
        return bool(self.emulator.call(f"Command_{codel}", [self.state, self.target, self.tolerance]).r0 & 0xFF)

    def send(self, left: float, right: float) -> tuple[int, bytes]:
        """Send a command; (status, bytes handed to the driver)."""
        self.emulator.write(self.command, struct.pack("<2f", left, right))
        status = self.emulator.call("CICAS_send_frame", [self.command, self.outbox]).r0 & 0xFF
        (count,) = self.emulator.unpack(self.outbox + 20, "<I")
        return status, self.emulator.read(self.outbox, count)

    def sent(self) -> None:
        """What the driver does when the last byte has left."""
        self.emulator.write(self.outbox + 20, bytes(4))
