"""Source lines with marks under them: carets, dashes, labels, and rails at the left of spans over several lines."""

from __future__ import annotations

from dataclasses import dataclass, field

from mauve.diagnostics.display import Shown, one_line, show
from mauve.diagnostics.style import Role, Style
from mauve.source import Position, SourceFile, Span

WHOLE = 5
"""A span over at most so many lines is shown whole, a longer one by its first and last line."""


@dataclass(frozen=True, slots=True)
class Mark:
    """A span to underline, in a file's own coordinates: `last` is the position after its last character."""

    first: Position
    last: Position
    text: str
    symbol: str
    role: Role

    @property
    def lines(self) -> range:
        """The lines that the span touches."""
        return range(self.first.line, self.last.line + 1)


def mark(span: Span, text: str, symbol: str, role: Role) -> Mark:
    """A mark for a span, whatever its offsets: clamped to the file, without the line end it may include."""
    source = span.file.text
    start = max(0, min(span.start, len(source)))
    end = max(start, min(span.end, len(source)))
    while end > start and source[end - 1] in "\r\n":
        end -= 1
    return Mark(span.file.position(start), span.file.position(end), one_line(text), symbol, role)


@dataclass(slots=True)
class Row:
    """One output row under construction; pieces are put from left to right or over blanks."""

    cells: list[str] = field(default_factory=list)
    roles: list[Role] = field(default_factory=list)

    def put(self, column: int, text: str, role: Role) -> None:
        """Write text from a column on, one list element a character."""
        missing = column + len(text) - len(self.cells)
        self.cells.extend(" " * missing)
        self.roles.extend([Role.PLAIN] * max(0, missing))
        for index, character in enumerate(text, column):
            self.cells[index] = character
            self.roles[index] = role

    def paint(self, style: Style) -> str:
        """The row with its colours, without trailing blanks."""
        while self.cells and self.cells[-1] == " ":
            self.cells.pop()
        painted, start = [], 0
        for index in range(1, len(self.cells) + 1):
            if index == len(self.cells) or self.roles[index] is not self.roles[start]:
                painted.append(style.paint(self.roles[start], "".join(self.cells[start:index])))
                start = index
        return "".join(painted)


def excerpt(file: SourceFile, marks: list[Mark], gutter: int, style: Style) -> list[str]:
    """The lines of a file that the marks touch, with the marks under them. `gutter` is the width of line numbers."""
    rails = _rails([m for m in marks if len(m.lines) > 1])
    out: list[str] = []

    def emit(number: int | None, row: Row) -> None:
        shown = "" if number is None else str(number)
        body = row.paint(style)
        out.append(style.paint(Role.GUTTER, f"{shown:>{gutter}} |") + (f" {body}" if body else ""))

    previous = 0
    for number in _lines_to_show(marks, len(file.line_starts)):
        if previous and number > previous + 1:
            out.append(_gap(previous, rails, gutter, style))
        _line(file, number, marks, rails, emit)
        previous = number
    return out


def _lines_to_show(marks: list[Mark], count: int) -> list[int]:
    """Every line with a mark's beginning or end, short spans whole, and single lines between two shown ones."""
    numbers: set[int] = set()
    for each in marks:
        numbers.update(each.lines if len(each.lines) <= WHOLE else (each.first.line, each.last.line))
    numbers.update(n + 1 for n in tuple(numbers) if n + 2 in numbers)
    return sorted(n for n in numbers if n <= count)


def _rails(marks: list[Mark]) -> list[tuple[Mark, int]]:
    """A rail number for each mark over several lines, so that two on one rail never share a line."""
    taken: list[tuple[Mark, int]] = []
    for each in sorted(marks, key=lambda m: (m.first.line, -m.last.line)):
        busy = {rail for other, rail in taken if other.last.line >= each.first.line}
        taken.append((each, next(rail for rail in range(len(taken) + 1) if rail not in busy)))
    return taken


def _rail_width(rails: list[tuple[Mark, int]]) -> int:
    return 2 * (1 + max((rail for _, rail in rails), default=-1))


def _gap(line: int, rails: list[tuple[Mark, int]], gutter: int, style: Style) -> str:
    """The row `...` between distant lines, with the rails that pass it."""
    row = Row()
    for each, rail in rails:
        if each.first.line <= line < each.last.line:
            row.put(2 * rail, "|", each.role)
    return style.paint(Role.GUTTER, f"{'...':<{gutter + 3}}") .rstrip() if not row.cells else (
        style.paint(Role.GUTTER, f"{'...':<{gutter + 3}}") + row.paint(style)
    )
