"""Source lines with marks under them: carets, dashes, labels, and rails at the left of spans over several lines."""

from __future__ import annotations

from collections.abc import Callable

from mauve.diagnostics.display import Shown, one_line, show
from mauve.diagnostics.style import Role, Style
from mauve.records import record
from mauve.source import Position, SourceFile, Span

WHOLE = 5
"""A span over at most so many lines is shown whole, a longer one by its first and last line."""


@record
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


class Row:
    """One output row under construction; pieces are put from left to right or over blanks."""

    def __init__(self) -> None:
        self.cells: list[str] = []
        self.roles: list[Role] = []

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


Emit = Callable[[int | None, Row], None]


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
    dots = style.paint(Role.GUTTER, "...")
    return f"{dots}{' ' * gutter}{row.paint(style)}" if row.cells else dots


def _line(file: SourceFile, number: int, marks: list[Mark], rails: list[tuple[Mark, int]], emit: Emit) -> None:
    """One source line and the rows under it: marks within the line, then beginnings and ends of longer spans."""
    text = file.line(number)
    points = [m.first.column - 1 for m in marks if m.first.line == number]
    points += [m.last.column - 1 for m in marks if m.last.line == number and m.first.line < number]
    shown = show(text, points)
    indent = len(text) - len(text.lstrip())
    left = _rail_width(rails)
    active = {rail: m for m, rail in rails if m.first.line < number <= m.last.line}
    starts = [(m, rail) for m, rail in rails if m.first.line == number]

    row = _with_rails(active)
    for each, rail in [s for s in starts if s[0].first.column - 1 <= indent]:
        row.put(2 * rail, "/", each.role)
        active[rail] = each
    row.put(left, shown.text, Role.PLAIN)
    emit(number, row)

    for layer in _layers([m for m in marks if len(m.lines) == 1 and m.first.line == number], shown):
        for row in _layer_rows(layer, shown, active, left):
            emit(None, row)
    for each, rail in [s for s in starts if s[1] not in active]:
        emit(None, _arm(_with_rails(active), each, rail, left + shown.cell(each.first.column - 1)))
        active[rail] = each
    for each, rail in [(m, rail) for m, rail in rails if m.last.line == number]:
        row = _arm(_with_rails(active), each, rail, left + shown.cell(max(0, each.last.column - 2)))
        row.put(len(row.cells) + 1, each.text, each.role)
        emit(None, row)
        del active[rail]


def _with_rails(active: dict[int, Mark]) -> Row:
    row = Row()
    for rail, each in active.items():
        row.put(2 * rail, "|", each.role)
    return row


def _arm(row: Row, each: Mark, rail: int, column: int) -> Row:
    """Draw the underscores from a rail to a column and the mark's symbol there; other rails stay visible."""
    for cell in range(2 * rail + 1, column):
        if cell >= len(row.cells) or row.cells[cell] == " ":
            row.put(cell, "_", each.role)
    row.put(column, each.symbol, each.role)
    return row


def _extent(each: Mark, shown: Shown) -> tuple[int, int]:
    """First and last-but-one column of a mark within a line, at least one column wide."""
    start = shown.cell(each.first.column - 1)
    return start, max(start + 1, shown.cell(each.last.column - 1))


def _layers(marks: list[Mark], shown: Shown) -> list[list[Mark]]:
    """The marks in as few rows as keep them apart; primary ones (`^`) come first, each row is in column order."""
    layers: list[list[Mark]] = []
    for each in sorted(marks, key=lambda m: (m.symbol != "^", m.first.column)):
        start, end = _extent(each, shown)
        for layer in layers:
            if all(end <= s or start >= e for s, e in (_extent(other, shown) for other in layer)):
                layer.append(each)
                break
        else:
            layers.append([each])
    return [sorted(layer, key=lambda m: m.first.column) for layer in layers]


def _layer_rows(layer: list[Mark], shown: Shown, active: dict[int, Mark], left: int) -> list[Row]:
    """The underlines of one row; the rightmost label beside them, the others hanging below, right to left."""
    row = _with_rails(active)
    for each in layer:
        start, end = _extent(each, shown)
        row.put(left + start, each.symbol * (end - start), each.role)
    row.put(len(row.cells) + 1, layer[-1].text, layer[-1].role)
    rows = [row]
    hanging = [m for m in layer[:-1] if m.text]
    for count in range(len(hanging), -1, -1):
        row = _with_rails(active)
        for each in hanging[:count]:
            row.put(left + _extent(each, shown)[0], "|", each.role)
        if count < len(hanging):
            row.put(left + _extent(hanging[count], shown)[0], hanging[count].text, hanging[count].role)
        if hanging:
            rows.append(row)
    return rows
