"""Source files, spans and positions.

A span is a pair of character offsets; lines and columns are computed only when something is shown to a person.
"""

from __future__ import annotations

from bisect import bisect_right
from functools import cached_property
from typing import Final

from mauve.records import record


class SourceFile:
    """A text with a name as the user wrote it (`name` is shown, never resolved). Files are equal by name and text."""

    def __init__(self, name: str, text: str) -> None:
        self.name: Final = name
        self.text: Final = text

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        return isinstance(other, SourceFile) and (self.name, self.text) == (other.name, other.text)

    def __hash__(self) -> int:
        return hash((self.name, self.text))

    def __repr__(self) -> str:
        return f"SourceFile(name={self.name!r})"

    @cached_property
    def line_starts(self) -> tuple[int, ...]:
        """Offsets at which the lines begin; at least one."""
        starts = [0]
        position = self.text.find("\n")
        while position != -1:
            starts.append(position + 1)
            position = self.text.find("\n", position + 1)
        return tuple(starts)

    def position(self, offset: int) -> Position:
        """Line and column, both from 1, of a character offset (clamped to the text)."""
        offset = max(0, min(offset, len(self.text)))
        line = bisect_right(self.line_starts, offset)
        return Position(line, offset - self.line_starts[line - 1] + 1)

    def line(self, number: int) -> str:
        """The text of a line, counted from 1, without its end."""
        start = self.line_starts[number - 1]
        end = self.line_starts[number] if number < len(self.line_starts) else len(self.text)
        return self.text[start:end].rstrip("\r\n")


@record
class Position:
    """A line and a column, both counted from 1."""

    line: int
    column: int


@record
class Span:
    """Characters `start` to `end` (exclusive) of a file; empty when they are equal."""

    file: SourceFile
    start: int
    end: int

    @property
    def text(self) -> str:
        """What the span covers."""
        return self.file.text[self.start : self.end]

    @property
    def first(self) -> Position:
        """Where the span begins."""
        return self.file.position(self.start)

    @property
    def last(self) -> Position:
        """Where the span ends (the position after its last character)."""
        return self.file.position(self.end)

    def to(self, other: Span) -> Span:
        """The span from the start of this one to the end of another in the same file."""
        return Span(self.file, self.start, max(self.end, other.end))

    def __str__(self) -> str:
        return f"{self.file.name}:{self.first.line}:{self.first.column}"
