"""The time axis of a chart: where its ticks stand and how they read."""

from __future__ import annotations

from fractions import Fraction

from mauve.records import record
from mauve.units import TIME_UNITS

READABLE = ("s", "ms", "us", "ns", "ps")


@record
class Axis:
    """A stretch of time drawn from `left` over `width` pixels; times are in `unit`."""

    start: int
    end: int
    left: float
    width: float
    unit: str

    def x(self, time: int) -> float:
        """Where a time stands, kept within the axis."""
        inside = min(max(time, self.start), self.end)
        return self.left + self.width * (inside - self.start) / max(1, self.end - self.start)

    def pixels(self, duration: int) -> float:
        """How wide a duration is."""
        return self.width * duration / max(1, self.end - self.start)


def ticks(axis: Axis, most: int) -> list[tuple[int, str]]:
    """At most so many round times with their labels, all in one unit."""
    step = nice_step(max(1, axis.end - axis.start), most)
    unit, size = _label_unit(step, axis.unit)
    first = -(-axis.start // step) * step
    return [(at, f"{_decimal(Fraction(at, size))}{unit}") for at in range(first, axis.end + 1, step)]


def nice_step(span: int, most: int) -> int:
    """The least of 1, 2, 5, 10, 20, .. that divides a span into at most so many parts."""
    power = 1
    while True:
        for digit in (1, 2, 5):
            if span <= digit * power * most:
                return digit * power
        power *= 10


def _label_unit(step: int, unit: str) -> tuple[str, int]:
    """The unit in which steps have at most one decimal, and how many of the axis' units it is."""
    if unit not in TIME_UNITS:
        return unit, 1
    for name in READABLE:
        size = Fraction(TIME_UNITS[name], TIME_UNITS[unit])
        if size.denominator == 1 and 10 * step >= size:
            return name, int(size)
    return unit, 1


def _decimal(value: Fraction) -> str:
    whole, rest = divmod(value, 1)
    digits = ""
    while rest and len(digits) < 12:
        digit, rest = divmod(rest * 10, 1)
        digits += str(digit)
    return f"{whole}.{digits}" if digits else str(whole)
