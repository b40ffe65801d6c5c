"""Exact time and frequency: a time is an integer number of picoseconds, a frequency an integer number of hertz.

Cycles become time in one place, rounded up once per worst-case execution time, so that no sum is ever rounded down.
"""

from __future__ import annotations

from fractions import Fraction

PS = 1
NS = 1_000
US = 1_000_000
MS = 1_000_000_000
S = 1_000_000_000_000

TIME_UNITS: dict[str, int] = {"ps": PS, "ns": NS, "us": US, "µs": US, "ms": MS, "s": S, "min": 60 * S}
FREQUENCY_UNITS: dict[str, int] = {"Hz": 1, "kHz": 1_000, "MHz": 1_000_000, "GHz": 1_000_000_000}
SIZE_UNITS: dict[str, int] = {"B": 1, "KiB": 1 << 10, "MiB": 1 << 20, "GiB": 1 << 30}
CYCLE_UNITS: dict[str, int] = {"cycle": 1, "cycles": 1}


def cycles_to_time(cycles: int, hertz: int) -> int:
    """The picoseconds that `cycles` take at `hertz`, rounded up: the one conversion from cycles to time."""
    if cycles < 0 or hertz <= 0:
        raise ValueError("cycles are not negative and a frequency is positive")
    return -(-cycles * S // hertz)


def time_to_cycles(time: int, hertz: int) -> int:
    """The cycles at `hertz` that cover `time` picoseconds, rounded up."""
    if time < 0 or hertz <= 0:
        raise ValueError("a time is not negative and a frequency is positive")
    return -(-time * hertz // S)


def format_time(time: int, digits: int = 3, down: bool = False) -> str:
    """A time in the unit a person would choose: `19.5ms`, `347.215us`, `0ms`.

    `digits` is the number of decimals kept at most; trailing zeros are dropped. The last one is rounded up, as costs
    and responses must be, or `down`, as slacks and permissions must be.
    """
    if time < 0:
        return "-" + format_time(-time, digits, not down)
    if time == 0:
        return "0ms"
    for unit, size in (("s", S), ("ms", MS), ("us", US), ("ns", NS), ("ps", PS)):
        if time >= size:
            scale = 10**digits
            scaled = time * scale // size if down else -(-time * scale // size)
            whole, part = divmod(scaled, scale)
            decimals = f"{part:0{digits}d}".rstrip("0") if digits else ""
            return f"{whole}.{decimals}{unit}" if decimals else f"{whole}{unit}"
    raise AssertionError("unreachable")


def exact(number: str, factor: int) -> Fraction:
    """A decimal numeral times an integer factor, exactly."""
    return Fraction(number) * factor
