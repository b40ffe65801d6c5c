"""Quantities to numbers, exactly: times in picoseconds, frequencies in hertz, sizes in bytes, counts of cycles.

Each function gives None after reporting what is wrong. Signs are the caller's business: `-10ms` is a time.
"""

from __future__ import annotations

from collections.abc import Mapping
from enum import Enum

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label, Report
from mauve.diagnostics.suggest import closest
from mauve.syntax import ast
from mauve.units import CYCLE_UNITS, FREQUENCY_UNITS, SIZE_UNITS, TIME_UNITS, exact

LIMIT = 2**63
"""Times, frequencies, sizes and counts stay below this."""


class Dimension(Enum):
    """What a quantity measures; the value is how a message names it."""

    TIME = "time"
    FREQUENCY = "frequency"
    SIZE = "size"
    CYCLES = "number of cycles"


UNITS: Mapping[Dimension, Mapping[str, int]] = {
    Dimension.TIME: TIME_UNITS,
    Dimension.FREQUENCY: FREQUENCY_UNITS,
    Dimension.SIZE: SIZE_UNITS,
    Dimension.CYCLES: CYCLE_UNITS,
}

_FINEST = {
    Dimension.TIME: "a picosecond",
    Dimension.FREQUENCY: "one hertz",
    Dimension.SIZE: "one byte",
    Dimension.CYCLES: "one cycle",
}

_SPELLINGS = {
    "sec": "s", "secs": "s", "second": "s", "seconds": "s",
    "msec": "ms", "msecs": "ms", "millisecond": "ms", "milliseconds": "ms",
    "usec": "us", "usecs": "us", "mus": "us", "microsecond": "us", "microseconds": "us",
    "nsec": "ns", "nsecs": "ns", "nanosecond": "ns", "nanoseconds": "ns",
    "mins": "min", "minute": "min", "minutes": "min", "m": "min",
    "hz": "Hz", "HZ": "Hz", "khz": "kHz", "KHz": "kHz", "KHZ": "kHz", "mhz": "MHz", "Mhz": "MHz", "MHZ": "MHz",
    "ghz": "GHz", "Ghz": "GHz", "GHZ": "GHz", "M": "MHz",
    "b": "B", "byte": "B", "bytes": "B", "k": "KiB", "K": "KiB", "kB": "KiB", "KB": "KiB", "kb": "KiB", "Kb": "KiB",
    "kib": "KiB", "MB": "MiB", "mb": "MiB", "Mb": "MiB", "GB": "GiB", "gb": "GiB", "G": "GiB",
    "cy": "cycles", "cyc": "cycles", "clk": "cycles", "clock": "cycles", "clocks": "cycles", "ws": "cycles",
}  # fmt: skip
"""How units are written elsewhere."""


def time_of(quantity: ast.Quantity, report: Report) -> int | None:
    """A time in picoseconds."""
    return _value(quantity, (Dimension.TIME,), report)


def frequency_of(quantity: ast.Quantity, report: Report) -> int | None:
    """A frequency in hertz."""
    return _value(quantity, (Dimension.FREQUENCY,), report)


def size_of(quantity: ast.Quantity, report: Report) -> int | None:
    """A size in bytes."""
    return _value(quantity, (Dimension.SIZE,), report)


def cycles_of(quantity: ast.Quantity, report: Report) -> int | None:
    """A number of cycles."""
    return _value(quantity, (Dimension.CYCLES,), report)


def wait_of(quantity: ast.Quantity, report: Report) -> tuple[Dimension, int] | None:
    """A wait of a memory: a time in picoseconds or a number of cycles, with its dimension."""
    value = _value(quantity, (Dimension.CYCLES, Dimension.TIME), report)
    if value is None:
        return None
    return (Dimension.CYCLES if quantity.unit in CYCLE_UNITS else Dimension.TIME, value)


def _value(quantity: ast.Quantity, wanted: tuple[Dimension, ...], report: Report) -> int | None:
    """The value in the smallest unit of one of the wanted dimensions."""
    if not quantity.unit:
        return None  # the parser has reported that the unit is missing
    for dimension in wanted:
        if quantity.unit in UNITS[dimension]:
            return _exact(quantity, dimension, report)
    report.add(_wrong_unit(quantity, wanted))
    return None


def _exact(quantity: ast.Quantity, dimension: Dimension, report: Report) -> int | None:
    value = exact(quantity.number, UNITS[dimension][quantity.unit])
    written = quantity.span.text
    if value.denominator != 1:
        message = f"`{written}` is finer than {_FINEST[dimension]}"
        report.add(Diagnostic("MV007", message, Label(quantity.span, f"not a whole number of {_whole(dimension)}")))
        return None
    if abs(value) >= LIMIT:
        largest = "106 days" if dimension is Dimension.TIME else f"{LIMIT - 1} {_whole(dimension)}"
        message = f"`{written}` is out of range"
        report.add(Diagnostic("MV007", message, Label(quantity.span, f"at most {largest}")))
        return None
    return int(value)


def _whole(dimension: Dimension) -> str:
    names = {Dimension.TIME: "picoseconds", Dimension.FREQUENCY: "hertz", Dimension.SIZE: "bytes"}
    return names.get(dimension, "cycles")


def _wrong_unit(quantity: ast.Quantity, wanted: tuple[Dimension, ...]) -> Diagnostic:
    """The unit is unknown, or of something else."""
    what = " nor a ".join(dimension.value for dimension in wanted)
    label = f"not a {what}" if len(wanted) == 1 else f"neither a {what}"
    units = [unit for dimension in wanted for unit in UNITS[dimension]]
    for dimension, known in UNITS.items():
        if quantity.unit in known:
            message = f"`{quantity.span.text}` is a {dimension.value}"
            listed = ", ".join(f"`{unit}`" for unit in units if unit != "\u00b5s")
            return Diagnostic("MV004", message, Label(quantity.span, label), help=Fix(f"the units are {listed}"))
    spelled = _SPELLINGS.get(quantity.unit)
    near = [spelled] if spelled in units else list(closest(quantity.unit, units, limit=1))
    if near:
        text = f"{quantity.number}{near[0]}"
        help_ = Fix(f"there is a unit `{near[0]}`: `{text}`", (Edit(quantity.span, text),), Applicability.MAYBE)
    else:
        help_ = Fix("the units are " + ", ".join(f"`{unit}`" for unit in units if unit != "\u00b5s"))
    return Diagnostic("MV004", f"unknown unit `{quantity.unit}`", Label(quantity.span, label), help=help_)
