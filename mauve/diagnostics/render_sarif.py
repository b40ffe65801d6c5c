"""The format `sarif`: SARIF 2.1.0 (OASIS standard, 27 March 2020), which code scanning services and editors read."""

from __future__ import annotations

from collections.abc import Iterable

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label
from mauve.diagnostics.explain import explanation, headline
from mauve.diagnostics.place import parse_place
from mauve.diagnostics.rules import RULES
from mauve.source import Span

VERSION = "2.1.0"
SCHEMA = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
HOME = "https://pypi.org/project/mauvec/"


def render_sarif(diagnostics: Iterable[Diagnostic], file: str = "", version: str = "") -> str:
    """The log as text, in ASCII. `file` is named for messages without any place, `version` is that of the tool."""
    import json

    return json.dumps(document(diagnostics, file, version), indent=2, allow_nan=False) + "\n"


def document(diagnostics: Iterable[Diagnostic], file: str = "", version: str = "") -> dict[str, object]:
    """A SARIF log with one run, as plain data. Its rules are those that occur."""
    messages = list(diagnostics)
    codes = sorted({each.code for each in messages})
    driver: dict[str, object] = {"name": "mauvec", "informationUri": HOME, "rules": [_rule(code) for code in codes]}
    if version:
        driver["version"] = version
    run = {
        "tool": {"driver": driver},
        "columnKind": "unicodeCodePoints",
        "results": [_result(each, codes.index(each.code), file) for each in messages],
    }
    return {"$schema": SCHEMA, "version": VERSION, "runs": [run]}


def _rule(code: str) -> dict[str, object]:
    rule = RULES.get(code)
    described: dict[str, object] = {"id": code}
    if rule is None:
        return described
    described["name"] = "".join(word.capitalize() for word in rule.slug.split("-"))
    described["shortDescription"] = {"text": headline(code) or rule.slug.replace("-", " ")}
    described["defaultConfiguration"] = {"level": rule.severity.value}
    page = explanation(code)
    if page is not None:
        described["help"] = {"text": page, "markdown": page}
    return described


def _result(diagnostic: Diagnostic, index: int, file: str) -> dict[str, object]:
    result: dict[str, object] = {
        "ruleId": diagnostic.code,
        "ruleIndex": index,
        "level": diagnostic.severity.value,
        "message": {"text": _text(diagnostic)},
    }
    location = _location(diagnostic, file)
    if location is not None:
        result["locations"] = [location]
    if diagnostic.labels:
        result["relatedLocations"] = [_physical(label, number) for number, label in enumerate(diagnostic.labels, 1)]
    if diagnostic.help is not None and diagnostic.help.edits:
        result["fixes"] = [_fix(diagnostic.help)]
    return result


def _text(diagnostic: Diagnostic) -> str:
    """Message, notes and help: many readers show nothing else."""
    parts = [diagnostic.message, *(f"note: {note}" for note in diagnostic.notes)]
    if diagnostic.help is not None:
        parts.append(f"help: {diagnostic.help.text}")
    return "\n".join(parts)


def _location(diagnostic: Diagnostic, file: str) -> dict[str, object] | None:
    if diagnostic.primary is not None:
        location = _physical(diagnostic.primary)
        if diagnostic.place:
            location["logicalLocations"] = [{"fullyQualifiedName": diagnostic.place}]
        return location
    place = parse_place(diagnostic.place)
    if place is not None:
        region = {"startLine": place.line} | ({"startColumn": place.column} if place.column else {})
        physical = {"artifactLocation": {"uri": uri(place.file)}, "region": region}
        return {"physicalLocation": physical, "logicalLocations": [{"fullyQualifiedName": diagnostic.place}]}
    if not file and not diagnostic.place:
        return None
    location = {"physicalLocation": {"artifactLocation": {"uri": uri(file)}}} if file else {}
    if diagnostic.place:
        location["logicalLocations"] = [{"fullyQualifiedName": diagnostic.place}]
    return location


def _physical(label: Label, number: int | None = None) -> dict[str, object]:
    location: dict[str, object] = {} if number is None else {"id": number}
    artifact = {"uri": uri(label.span.file.name)}
    location["physicalLocation"] = {"artifactLocation": artifact, "region": _region(label.span)}
    if label.text:
        location["message"] = {"text": label.text}
    return location


def _region(span: Span) -> dict[str, int]:
    """Lines and columns from 1, the end column exclusive (SARIF 3.30)."""
    first, last = span.first, span.last
    if (last.line, last.column) < (first.line, first.column):
        last = first
    return {
        "startLine": first.line,
        "startColumn": first.column,
        "endLine": last.line,
        "endColumn": last.column,
    }


def _fix(fix: Fix) -> dict[str, object]:
    """The edits by file, as SARIF groups them (3.55 to 3.57)."""
    changes: dict[str, list[dict[str, object]]] = {}
    for edit in fix.edits:
        replacement = {"deletedRegion": _region(edit.span), "insertedContent": {"text": edit.text}}
        changes.setdefault(uri(edit.span.file.name), []).append(replacement)
    return {
        "description": {"text": fix.text},
        "artifactChanges": [
            {"artifactLocation": {"uri": name}, "replacements": replacements} for name, replacements in changes.items()
        ],
    }


def uri(name: str) -> str:
    """A file name as a URI reference: a relative path stays relative, an absolute one becomes `file:///`."""
    from urllib.parse import quote

    path = name.replace("\\", "/")
    quoted = quote(path, safe="/", errors="replace")
    if path.startswith("/"):
        return "file://" + quoted
    if len(path) > 2 and path[1:3] == ":/":
        return "file:///" + path[0] + ":" + quote(path[2:], safe="/", errors="replace")
    return quoted
