"""JSON with exact decimals: the standard library writes a number through a float, which cannot hold each of them."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from fractions import Fraction

from mauve.tasksets.numbers import format_number


def dumps(document: object) -> str:
    """The document as ASCII text with indentation; a Fraction becomes its decimal."""
    return "".join(_pieces(document, "\n")) + "\n"


def _pieces(value: object, line: str) -> Iterator[str]:
    match value:
        case Fraction():
            yield format_number(value)
        case Mapping() if value:
            yield "{"
            inner = line + "  "
            for index, (key, item) in enumerate(value.items()):
                yield f"{',' if index else ''}{inner}{json.dumps(str(key))}: "
                yield from _pieces(item, inner)
            yield line + "}"
        case list() | tuple() if value:
            yield "["
            inner = line + "  "
            for index, item in enumerate(value):
                yield f"{',' if index else ''}{inner}"
                yield from _pieces(item, inner)
            yield line + "]"
        case Mapping():
            yield "{}"
        case list() | tuple():
            yield "[]"
        case _:
            yield json.dumps(value, allow_nan=False)
