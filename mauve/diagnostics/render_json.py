"""The format `json`: everything a diagnostic holds, for programs (`mauve.diagnostics/1`, docs/schema)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isfinite

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label
from mauve.diagnostics.rules import RULES
from mauve.source import Span

SCHEMA = "mauve.diagnostics/1"


def render_json(diagnostics: Iterable[Diagnostic]) -> str:
    """The document as text, in ASCII, so that no output encoding can break it."""
    import json

    return json.dumps(document(diagnostics), indent=2, allow_nan=False) + "\n"


def document(diagnostics: Iterable[Diagnostic]) -> dict[str, object]:
    """A whole `mauve.diagnostics/1` document as plain data."""
    return {"schema": SCHEMA, "diagnostics": [to_plain(each) for each in diagnostics]}


def to_plain(diagnostic: Diagnostic) -> dict[str, object]:
    """One diagnostic as plain data; other documents (`mauve.check/1`) hold lists of these."""
    rule = RULES.get(diagnostic.code)
    return {
        "code": diagnostic.code,
        "slug": rule.slug if rule else None,
        "severity": diagnostic.severity.value,
        "message": diagnostic.message,
        "primary": _label(diagnostic.primary) if diagnostic.primary else None,
        "labels": [_label(label) for label in diagnostic.labels],
        "place": diagnostic.place or None,
        "notes": list(diagnostic.notes),
        "help": _fix(diagnostic.help) if diagnostic.help else None,
        "data": {key: _value(value) for key, value in diagnostic.data},
    }


def _label(label: Label) -> dict[str, object]:
    return {**_span(label.span), "text": label.text}


def _span(span: Span) -> dict[str, object]:
    """File and both ends; lines and columns from 1, offsets in characters from 0, the end exclusive."""
    return {
        "file": span.file.name,
        "start": {"line": span.first.line, "column": span.first.column, "offset": span.start},
        "end": {"line": span.last.line, "column": span.last.column, "offset": span.end},
    }


def _fix(fix: Fix) -> dict[str, object]:
    return {
        "text": fix.text,
        "applicability": fix.applicability.value,
        "edits": [{**_span(edit.span), "text": edit.text} for edit in fix.edits],
    }


def _value(value: object) -> object:
    """A figure as JSON can hold it: what JSON has no form for (a fraction, an infinity) becomes its text."""
    match value:
        case None | bool() | int() | str():
            return value
        case float():
            return value if isfinite(value) else str(value)
        case Mapping():
            return {str(key): _value(item) for key, item in value.items()}
        case list() | tuple():
            return [_value(item) for item in value]
        case _:
            return str(value)
