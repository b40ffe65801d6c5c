"""Exact numbers: times of a task set are decimals in its own unit; inside they become whole ticks of it."""

from __future__ import annotations

import re
from collections.abc import Iterable
from fractions import Fraction
from math import lcm

LARGEST = 10**18
"""No time or priority of a task set is larger."""

DECIMALS = 18
"""No time has more decimals."""

_NUMERAL = re.compile(r"[+-]?(\d+(\.\d*)?|\.\d+)([eE][+-]?\d{1,4})?")


def read_number(text: str) -> Fraction | str:
    """The number that a text says exactly, or what is wrong with it."""
    if len(text) <= DECIMALS and text.isascii() and text.isdigit():
        return Fraction(int(text))
    if len(text) > 60 or not _NUMERAL.fullmatch(text):
        known = text.lower().lstrip("+-")
        if known in ("nan", "inf", "infinity"):
            return f"`{text}` is not a number that a time can be"
        return f"`{text[:30]}` is no number" if len(text) <= 60 else "the number has too many digits"
    mantissa, _, exponent = text.lower().partition("e")
    if exponent and abs(int(exponent)) > 2 * DECIMALS:
        return f"`{text}` is out of range"
    value = Fraction(mantissa) * Fraction(10) ** int(exponent or 0)
    if abs(value) > LARGEST:
        return f"`{text}` is out of range: at most 10^18"
    if (value * 10**DECIMALS).denominator != 1:
        return f"`{text}` has more than {DECIMALS} decimals"
    return value


def common_scale(values: Iterable[Fraction]) -> int:
    """How many ticks a unit has at least, so that all these are whole numbers of ticks."""
    return lcm(*{value.denominator for value in values})


def format_number(value: Fraction | int) -> str:
    """A number as a decimal, exactly where it has one; else rounded up at the ninth decimal."""
    value = Fraction(value)
    if value < 0:
        return "-" + format_number(-value)
    digits = next((d for d in range(2 * DECIMALS + 1) if 10**d % value.denominator == 0), None)
    if digits is None:
        digits, value = 9, Fraction(-(-value * 10**9 // 1), 10**9)
    whole, part = divmod(value.numerator * (10**digits // value.denominator), 10**digits)
    decimals = f"{part:0{digits}d}".rstrip("0") if digits else ""
    return f"{whole}.{decimals}" if decimals else str(whole)
