"""The format `short`: one line a message, `file:line:col: error: text [MVnnn]`, as editors and CI matchers read it."""

from __future__ import annotations

from collections.abc import Iterable

from mauve.diagnostics.diagnostic import Diagnostic
from mauve.diagnostics.display import one_line
from mauve.diagnostics.place import parse_place


def render_short(diagnostics: Iterable[Diagnostic], file: str = "") -> str:
    """One line for each message. `file` stands before those that have neither a position nor a place."""
    return "".join(f"{_line(each, file)}\n" for each in diagnostics)


def _line(diagnostic: Diagnostic, file: str) -> str:
    message = one_line(diagnostic.message)
    location = one_line(file) or "mauvec"
    if diagnostic.primary is not None:
        location = one_line(str(diagnostic.primary.span))
    elif diagnostic.place:
        place = parse_place(diagnostic.place)
        if place is None:
            location = one_line(diagnostic.place)
        else:
            location = ":".join(str(part) for part in (one_line(place.file), place.line, place.column) if part)
            message += f" {one_line(place.rest)}" if place.rest else ""
    elif diagnostic.labels:
        location = one_line(str(diagnostic.labels[0].span))
    return f"{location}: {diagnostic.severity.value}: {message} [{diagnostic.code}]"
