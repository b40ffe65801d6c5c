"""Plain tables: columns as wide as their widest cell, numbers to the right."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

from mauve.diagnostics.style import Role, Style


class Align(Enum):
    """Where a column's text stands."""

    LEFT = "<"
    RIGHT = ">"


@dataclass(frozen=True, slots=True)
class Column:
    """A column's heading and alignment."""

    heading: str
    align: Align = Align.LEFT


@dataclass(frozen=True, slots=True)
class Cell:
    """A text with the role that decides its colour."""

    text: str
    role: Role = Role.PLAIN


Row = Sequence[Cell | str]


def format_table(columns: Sequence[Column], rows: Sequence[Row], style: Style, indent: str = "  ") -> list[str]:
    """The lines of a table with its headings; a cell given as a string is plain. No line ends in spaces."""
    cells = [[cell if isinstance(cell, Cell) else Cell(cell) for cell in row] for row in rows]
    widths = [
        max([len(column.heading), *(len(row[index].text) for row in cells)]) for index, column in enumerate(columns)
    ]
    headings = [Cell(column.heading, Role.GUTTER) for column in columns]
    return [_line(columns, row, widths, style, indent) for row in [headings, *cells]]


def _line(columns: Sequence[Column], row: Sequence[Cell], widths: Sequence[int], style: Style, indent: str) -> str:
    last = max((index for index, cell in enumerate(row) if cell.text), default=-1)
    parts = []
    for index, (column, cell, width) in enumerate(zip(columns, row, widths, strict=True)):
        padding = " " * (width - len(cell.text))
        painted = style.paint(cell.role, cell.text)
        if column.align is Align.RIGHT:
            parts.append(padding + painted)
        else:
            parts.append(painted + (padding if index < last else ""))
    return (indent + "  ".join(parts[: last + 1])).rstrip()
