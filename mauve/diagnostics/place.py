"""The place of a finding that is not in the model's text, such as `fusion.c:41:3 (0x8a34, in mat_invert)`."""

from __future__ import annotations

import re

from mauve.records import record

_POSITION = re.compile(
    r"(?P<file>(?:[A-Za-z]:[\\/])?[^:\n]*[^:\s]):(?P<line>[1-9]\d{0,8})(?::(?P<column>[1-9]\d{0,8}))?(?=$|[\s,;(])"
)


@record
class Place:
    """A file with an optional line and column (from 1), and what the text says besides."""

    file: str
    line: int | None = None
    column: int | None = None
    rest: str = ""


def parse_place(text: str) -> Place | None:
    """The file and line that a diagnostic's `place` begins with; None where it begins with something else."""
    found = _POSITION.match(text)
    if found is None:
        return None
    column = found["column"]
    return Place(found["file"], int(found["line"]), int(column) if column else None, text[found.end() :].strip())
