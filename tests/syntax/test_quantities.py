from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mauve.diagnostics.diagnostic import Report
from mauve.source import SourceFile, Span
from mauve.syntax import ast
from mauve.syntax.quantities import Dimension, cycles_of, frequency_of, size_of, time_of, wait_of
from mauve.units import TIME_UNITS

Convert = Callable[[ast.Quantity, Report], object]


def quantity(text: str) -> ast.Quantity:
    number = text.rstrip("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ\u00b5%")
    return ast.Quantity(number, text[len(number) :], Span(SourceFile("f", text), 0, len(text)))


@pytest.mark.parametrize(
    ("convert", "text", "value"),
    [
        (time_of, "10ms", 10**10),
        (time_of, "0.35ms", 350_000_000),
        (time_of, "1.000000000001s", 1_000_000_000_001),
        (time_of, "5min", 300 * 10**12),
        (time_of, "3\u00b5s", 3_000_000),
        (time_of, "-10ms", -(10**10)),
        (time_of, "0ms", 0),
        (frequency_of, "1.5MHz", 1_500_000),
        (size_of, "64KiB", 65536),
        (cycles_of, "1cycle", 1),
        (wait_of, "2cycles", (Dimension.CYCLES, 2)),
        (wait_of, "70ns", (Dimension.TIME, 70_000)),
    ],
)
def test_quantities_are_exact(convert: Convert, text: str, value: object) -> None:
    report = Report()
    assert convert(quantity(text), report) == value
    assert report.diagnostics == []


@pytest.mark.parametrize(
    ("convert", "text", "code", "message", "label", "help_text"),
    [
        (time_of, "10msec", "MV004", "unknown unit `msec`", "not a time", "there is a unit `ms`: `10ms`"),
        (time_of, "10MS", "MV004", "unknown unit `MS`", "not a time", "there is a unit `ms`: `10ms`"),
        (time_of, "10MHz", "MV004", "`10MHz` is a frequency", "not a time", "the units are `ps`"),
        (time_of, "3quux", "MV004", "unknown unit `quux`", "not a time", "the units are `ps`"),
        (size_of, "16KB", "MV004", "unknown unit `KB`", "not a size", "there is a unit `KiB`: `16KiB`"),
        (wait_of, "1B", "MV004", "`1B` is a size", "neither a number of cycles nor a time", "the units are `cycle`"),
        (time_of, "0.5ps", "MV007", "`0.5ps` is finer than a picosecond", "not a whole number of picoseconds", ""),
        (frequency_of, "0.5Hz", "MV007", "`0.5Hz` is finer than one hertz", "not a whole number of hertz", ""),
        (time_of, "99999999999s", "MV007", "`99999999999s` is out of range", "at most 106 days", ""),
    ],
)
def test_what_is_no_quantity_is_said(
    convert: Convert, text: str, code: str, message: str, label: str, help_text: str
) -> None:
    report = Report()
    assert convert(quantity(text), report) is None
    (found,) = report.diagnostics
    assert (found.code, found.message) == (code, message)
    assert found.primary is not None and found.primary.text == label
    assert (found.help.text if found.help else "").startswith(help_text)


def test_a_unit_that_the_parser_missed_is_reported_once() -> None:
    report = Report()
    assert time_of(quantity("10"), report) is None
    assert report.diagnostics == []


@given(st.integers(0, 10**5), st.sampled_from(sorted(TIME_UNITS)))
def test_whole_times_are_products(number: int, unit: str) -> None:
    assert time_of(quantity(f"{number}{unit}"), Report()) == number * TIME_UNITS[unit]
