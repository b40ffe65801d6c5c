"""Plain tables: columns as wide as their widest cell, numbers to the right, names cut where a terminal is narrow."""

from __future__ import annotations

from collections.abc import Sequence
from enum import Enum

from mauve.diagnostics.display import ELLIPSIS, one_line, width
from mauve.diagnostics.style import Role, Style
from mauve.records import record

LEAST = 12
"""Columns that may be cut keep at least so many cells."""

GAP = "  "


class Align(Enum):
    """Where a column's text stands."""

    LEFT = "left"
    RIGHT = "right"


@record
class Column:
    """A column's heading and alignment; one that is `elastic` is cut where the table is too wide."""

    heading: str
    align: Align = Align.LEFT
    elastic: bool = False


@record
class Cell:
    """A text with the role that decides its colour."""

    text: str
    role: Role = Role.PLAIN


Row = Sequence[Cell | str]


def format_table(
    columns: Sequence[Column], rows: Sequence[Row], style: Style, indent: str = "  ", limit: int | None = None
) -> list[str]:
    """The lines of a table with its headings; a cell given as a string is plain. No line ends in spaces.

    With a `limit`, elastic columns are cut, the widest first, until the lines have so many cells or all of them are at
    their least width; numbers are never cut. Columns without any text are left out.
    """
    cells = [[_clean(cell) for cell in row] for row in rows]
    used = [index for index in range(len(columns)) if any(row[index].text for row in cells)] or range(len(columns))
    shown = [columns[index] for index in used]
    body = [[row[index] for index in used] for row in cells]
    headings = [Cell(column.heading, Role.GUTTER) for column in shown]
    widths = _widths(shown, [headings, *body], None if limit is None else limit - len(indent))
    return [_line(shown, row, widths, style, indent) for row in [headings, *body]]


def _clean(cell: Cell | str) -> Cell:
    """A cell as one line that a terminal shows safely: names of a binary may hold anything."""
    return Cell(one_line(cell)) if isinstance(cell, str) else Cell(one_line(cell.text), cell.role)


def _widths(columns: Sequence[Column], rows: Sequence[Sequence[Cell]], limit: int | None) -> list[int]:
    widths = [max(_cells(row[index].text) for row in rows) for index in range(len(columns))]
    if limit is None:
        return widths
    over = sum(widths) + len(GAP) * (len(widths) - 1) - limit
    while over > 0:
        elastic = [i for i, column in enumerate(columns) if column.elastic and widths[i] > LEAST]
        if not elastic:
            break
        widest = max(elastic, key=lambda i: widths[i])
        widths[widest] -= 1
        over -= 1
    return widths


def _cells(text: str) -> int:
    return len(text) if text.isascii() else sum(width(character) for character in text)


def _cut(text: str, cells: int) -> str:
    """The text in so many cells, its middle left out where it is longer: names differ at their ends."""
    if _cells(text) <= cells:
        return text
    head, tail = text[:cells], text[-cells:]
    while _cells(head) > cells // 2:
        head = head[:-1]
    while _cells(tail) > cells - 1 - _cells(head):
        tail = tail[1:]
    return head + ELLIPSIS + tail


def _line(columns: Sequence[Column], row: Sequence[Cell], widths: Sequence[int], style: Style, indent: str) -> str:
    last = max((index for index, cell in enumerate(row) if cell.text), default=-1)
    parts = []
    for index, (column, cell, cells) in enumerate(zip(columns, row, widths, strict=True)):
        text = _cut(cell.text, cells)
        padding = " " * (cells - _cells(text))
        painted = style.paint(cell.role, text)
        if column.align is Align.RIGHT:
            parts.append(padding + painted)
        else:
            parts.append(painted + (padding if index < last else ""))
    return (indent + GAP.join(parts[: last + 1])).rstrip()


def percent(part: float) -> str:
    """A part of the whole: `36.6 %`."""
    return f"{100 * part:.1f} %"
