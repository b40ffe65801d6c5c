"""Text as a terminal shows it: tabs, wide and combining characters, and characters that must not reach a terminal."""

from __future__ import annotations

import unicodedata

from mauve.records import record

TAB = 4
REPLACEMENT = "\N{REPLACEMENT CHARACTER}"
ELLIPSIS = "\N{HORIZONTAL ELLIPSIS}"
JOINERS = "\u200c\u200d"  # they belong to scripts and emoji; every other format character could hide or reorder text


def safe(character: str) -> str:
    """A character that changes nothing but its own cell: controls, direction overrides and half surrogates replaced."""
    if " " <= character <= "~":
        return character
    match unicodedata.category(character):
        case "Cc":
            return chr(0x2400 + ord(character)) if ord(character) < 0x20 else REPLACEMENT
        case "Cf":
            return character if character in JOINERS else REPLACEMENT
        case "Cs" | "Zl" | "Zp":
            return REPLACEMENT
        case _:
            return character


def width(character: str) -> int:
    """Cells of a safe character on a terminal: 0 for combining marks and joiners, 2 for wide ones, else 1."""
    if character < "\u0300":
        return 1
    if unicodedata.category(character) in ("Mn", "Me", "Cf"):
        return 0
    return 2 if unicodedata.east_asian_width(character) in ("W", "F") else 1


def one_line(text: str) -> str:
    """A message as one safe line: line ends become spaces, tabs too."""
    return " ".join("".join(safe(c) for c in part.replace("\t", " ")) for part in text.splitlines())


def lines(text: str) -> list[str]:
    """A note as its safe lines, at least one."""
    return ["".join(safe(c) for c in part.expandtabs(TAB)) for part in text.splitlines()] or [""]


@record
class Shown:
    """One source line, or the window of a very long one, as it appears on a terminal.

    `first` is the index of the first character shown; `cells[i]` the column at which character `first + i` begins, with
    one entry more for the end.
    """

    text: str
    first: int
    cells: tuple[int, ...]

    def cell(self, index: int) -> int:
        """The column of a character of the line, clamped to the window."""
        return self.cells[max(0, min(index - self.first, len(self.cells) - 1))]


def show(line: str, points: list[int], limit: int = 160) -> Shown:
    """Lay a source line out. Where it is longer than `limit` characters, only the part around `points` is shown."""
    first, last = 0, len(line)
    if len(line) > limit:
        first = max(0, min(min(points, default=0) - limit // 4, len(line) - limit))
        last = first + limit
    pieces, cells, column = [], [], 0
    if first > 0:
        pieces.append(ELLIPSIS)
        column = 1
    for character in line[first:last]:
        cells.append(column)
        if character == "\t":
            piece = " " * (TAB - column % TAB)
            column += len(piece)
        else:
            piece = safe(character)
            column += width(piece)
        pieces.append(piece)
    cells.append(column)
    if last < len(line):
        pieces.append(ELLIPSIS)
    return Shown("".join(pieces), first, tuple(cells))
