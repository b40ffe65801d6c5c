"""Identifiers, paths and literals as written."""

from __future__ import annotations

from mauve.records import record
from mauve.source import Span


@record
class Name:
    """One identifier."""

    text: str
    span: Span

    def __str__(self) -> str:
        return self.text


@record
class Path:
    """Identifiers joined by dots; at least one."""

    parts: tuple[Name, ...]
    span: Span

    def __str__(self) -> str:
        return ".".join(part.text for part in self.parts)


@record
class Quantity:
    """A numeral with its unit stuck to it, as written: `10ms`, `200MHz`, `16KiB`, `1cycle`. The unit may be unknown."""

    number: str
    unit: str
    span: Span


@record
class Number:
    """A numeral without unit, as written: `3`, `-0.5`, `0x8000`."""

    text: str
    span: Span

    @property
    def is_integer(self) -> bool:
        """Whether it has neither fraction nor exponent."""
        return self.text.lstrip("-").isdigit() or self.text.lower().lstrip("-").startswith("0x")

    @property
    def integer(self) -> int:
        """Its value, when it is an integer."""
        return int(self.text, 16 if "x" in self.text.lower() else 10)


@record
class String:
    """A string without its quotes, escapes resolved."""

    value: str
    span: Span


@record
class Boolean:
    """`true` or `false`."""

    value: bool
    span: Span


@record
class Record:
    """`{ yaw: 0.0, roll: 0.0 }`."""

    fields: tuple[tuple[Name, Value], ...]
    span: Span


@record
class List:
    """`[1, 2, 3]`."""

    items: tuple[Value, ...]
    span: Span


Value = Quantity | Number | String | Boolean | Path | Record | List
"""A Path is the name of an enumeration's literal."""
