"""The format `github`: workflow commands, which GitHub shows beside the changed lines of a pull request."""

from __future__ import annotations

from collections.abc import Iterable

from mauve.diagnostics.diagnostic import Diagnostic, Severity
from mauve.diagnostics.place import parse_place
from mauve.diagnostics.render_full import fix_mark, title

COMMANDS = {Severity.ERROR: "error", Severity.WARNING: "warning", Severity.NOTE: "notice"}


def render_github(diagnostics: Iterable[Diagnostic], file: str = "") -> str:
    """One command for each message. `file` is named for those that have neither a position nor a place."""
    return "".join(f"{_command(each, file)}\n" for each in diagnostics)


def _command(diagnostic: Diagnostic, file: str) -> str:
    properties = {**_position(diagnostic, file), "title": title(diagnostic)}
    shown = ",".join(f"{key}={_property(value)}" for key, value in properties.items() if value)
    return f"::{COMMANDS[diagnostic.severity]} {shown}::{_data(_text(diagnostic))}"


def _position(diagnostic: Diagnostic, file: str) -> dict[str, str]:
    """File, line and column. Columns only within one line: GitHub refuses them elsewhere."""
    if diagnostic.primary is None:
        place = parse_place(diagnostic.place)
        if place is None:
            return {"file": file}
        return {"file": place.file, "line": str(place.line or ""), "col": str(place.column or "")}
    span = diagnostic.primary.span
    lines = {"file": span.file.name, "line": str(span.first.line), "endLine": str(span.last.line)}
    if span.first.line == span.last.line:
        lines |= {"col": str(span.first.column), "endColumn": str(span.last.column)}
    return lines


def _text(diagnostic: Diagnostic) -> str:
    parts = [diagnostic.message]
    if diagnostic.primary is not None and diagnostic.primary.text:
        parts.append(diagnostic.primary.text)
    if diagnostic.place:
        parts.append(f"at {diagnostic.place}")
    parts.extend(f"note: {note}" for note in diagnostic.notes)
    if diagnostic.help is not None:
        parts.append(f"help: {diagnostic.help.text}{fix_mark(diagnostic.help)}")
    return "\n".join(parts)


def _data(text: str) -> str:
    """The escapes of a command's message."""
    text = text.encode("utf-8", "replace").decode("utf-8")
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(text: str) -> str:
    """The escapes of a property's value: those of a message, and the two separators."""
    return _data(text).replace(":", "%3A").replace(",", "%2C")
