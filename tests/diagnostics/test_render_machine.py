"""The formats that programs read: short, json, sarif, github."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import jsonschema
import pytest
from diagnostic_samples import ROBOT, at, diagnostics
from hypothesis import given, settings

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label, Severity
from mauve.diagnostics.place import Place, parse_place
from mauve.diagnostics.render import Format, render
from mauve.diagnostics.render_sarif import uri
from mauve.source import SourceFile, Span

SCHEMA = json.loads(
    (Path(__file__).resolve().parents[2] / "docs" / "schema" / "mauve.diagnostics-1.schema.json").read_text()
)
TYPES = Diagnostic(
    "MV201",
    "a `Position` cannot flow into `Attitude`",
    Label(at("ig500.position")),
    labels=(Label(at("Position"), "written as `Position`"),),
    notes=("one\ntwo",),
    help=Fix("swap", (Edit(at("ig500"), "fusion"),), Applicability.MACHINE),
    data=(("size", 3), ("ratio", Fraction(1, 3)), ("load", float("inf")), ("names", ("a", "b"))),
)
LOOP = Diagnostic("MV511", "a loop has no bound", place="fusion.c:41:3 (0x8a34, in `mat_invert`)")
LOST = Diagnostic("MV406", "nothing to check", severity=Severity.WARNING)
STATE = Diagnostic("MV301", "x, 100%", Label(at("initial state", until="fuse\n    }")), severity=Severity.NOTE)
ALL = [TYPES, LOOP, LOST, STATE]


def test_short_is_one_line_a_message_with_the_best_known_place() -> None:
    assert render(ALL, "short", file="ttrk.mauve").splitlines() == [
        "ttrk.mauve:13:11: error: a `Position` cannot flow into `Attitude` [MV201]",
        "fusion.c:41:3: error: a loop has no bound (0x8a34, in `mat_invert`) [MV511]",
        "ttrk.mauve: warning: nothing to check [MV406]",
        "ttrk.mauve:7:5: note: x, 100% [MV301]",
    ]


def test_github_escapes_and_gives_columns_only_within_a_line() -> None:
    odd = Diagnostic("MV301", "x", Label(Span(SourceFile("a,b:c%.mauve", "abc"), 0, 1)))
    assert render([*ALL, odd], "github", file="ttrk.mauve").splitlines() == [
        "::error file=ttrk.mauve,line=13,endLine=13,col=11,endColumn=25,title=MV201 type-mismatch"
        "::a `Position` cannot flow into `Attitude`%0Anote: one%0Atwo%0Ahelp: swap [fixable]",
        "::error file=fusion.c,line=41,col=3,title=MV511 unbounded-loop"
        "::a loop has no bound%0Aat fusion.c:41:3 (0x8a34, in `mat_invert`)",
        "::warning file=ttrk.mauve,title=MV406 nothing-to-check::nothing to check",
        "::notice file=ttrk.mauve,line=7,endLine=9,title=MV301 unreachable-state::x, 100%25",
        "::error file=a%2Cb%3Ac%25.mauve,line=1,endLine=1,col=1,endColumn=2,title=MV301 unreachable-state::x",
    ]


def test_json_holds_everything_and_follows_the_published_schema() -> None:
    document = json.loads(render(ALL, Format.JSON))
    jsonschema.validate(document, SCHEMA)
    first = document["diagnostics"][0]
    assert first["primary"] == {
        "file": "ttrk.mauve",
        "start": {"line": 13, "column": 11, "offset": ROBOT.text.index("ig500.")},
        "end": {"line": 13, "column": 25, "offset": ROBOT.text.index("ig500.") + 14},
        "text": "",
    }
    assert first["data"] == {"size": 3, "ratio": "1/3", "load": "inf", "names": ["a", "b"]}
    assert first["help"]["edits"][0]["text"] == "fusion"
    assert document["diagnostics"][1]["place"] == LOOP.place
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


POSITIVE = {"type": "integer", "minimum": 1}
TEXT = {"type": "object", "required": ["text"], "properties": {"text": {"type": "string", "minLength": 1}}}
REGION = {
    "type": "object",
    "required": ["startLine"],
    "properties": dict.fromkeys(("startLine", "startColumn", "endLine", "endColumn"), POSITIVE),
    "additionalProperties": False,
}
ARTIFACT = {"type": "object", "required": ["uri"], "properties": {"uri": {"type": "string", "pattern": r"^[!-~]+$"}}}
LOCATION = {
    "type": "object",
    "properties": {
        "id": POSITIVE,
        "physicalLocation": {
            "type": "object",
            "required": ["artifactLocation"],
            "properties": {"artifactLocation": ARTIFACT, "region": REGION},
        },
        "message": TEXT,
    },
}
REPLACEMENT = {"type": "object", "required": ["deletedRegion"], "properties": {"deletedRegion": REGION}}
FIX = {
    "type": "object",
    "required": ["artifactChanges"],
    "properties": {
        "artifactChanges": {
            "type": "array",
            "minItems": 1,
            "items": {
                "type": "object",
                "required": ["artifactLocation", "replacements"],
                "properties": {"replacements": {"type": "array", "minItems": 1, "items": REPLACEMENT}},
            },
        }
    },
}
LEVEL = {"enum": ["none", "note", "warning", "error"]}
RULE = {
    "type": "object",
    "required": ["id", "name", "shortDescription", "defaultConfiguration"],
    "properties": {
        "shortDescription": TEXT,
        "defaultConfiguration": {"type": "object", "required": ["level"], "properties": {"level": LEVEL}},
    },
}
RESULT = {
    "type": "object",
    "required": ["ruleId", "ruleIndex", "level", "message"],
    "properties": {
        "level": LEVEL,
        "message": TEXT,
        "locations": {"type": "array", "items": LOCATION},
        "relatedLocations": {"type": "array", "items": LOCATION},
        "fixes": {"type": "array", "items": FIX},
    },
}
SARIF = {
    "type": "object",
    "required": ["$schema", "version", "runs"],
    "properties": {
        "version": {"const": "2.1.0"},
        "runs": {
            "type": "array",
            "minItems": 1,
            "items": {
                "type": "object",
                "required": ["tool", "results", "columnKind"],
                "properties": {
                    "columnKind": {"enum": ["utf16CodeUnits", "unicodeCodePoints"]},
                    "tool": {
                        "type": "object",
                        "required": ["driver"],
                        "properties": {
                            "driver": {
                                "type": "object",
                                "required": ["name", "informationUri", "rules"],
                                "properties": {"rules": {"type": "array", "items": RULE}},
                            }
                        },
                    },
                    "results": {"type": "array", "items": RESULT},
                },
            },
        },
    },
}


def test_sarif_has_the_properties_that_the_standard_requires() -> None:
    log = json.loads(render(ALL, "sarif", file="ttrk.mauve", version="0.1.0"))
    jsonschema.validate(log, SARIF)
    run = log["runs"][0]
    driver = run["tool"]["driver"]
    assert (driver["name"], driver["version"]) == ("mauvec", "0.1.0")
    assert [rule["id"] for rule in driver["rules"]] == ["MV201", "MV301", "MV406", "MV511"]
    assert driver["rules"][0]["name"] == "TypeMismatch"
    assert all(driver["rules"][result["ruleIndex"]]["id"] == result["ruleId"] for result in run["results"])
    types, loop, lost, _ = run["results"]
    assert types["locations"][0]["physicalLocation"] == {
        "artifactLocation": {"uri": "ttrk.mauve"},
        "region": {"startLine": 13, "startColumn": 11, "endLine": 13, "endColumn": 25},
    }
    assert types["relatedLocations"][0]["message"]["text"] == "written as `Position`"
    assert types["fixes"][0]["artifactChanges"][0]["replacements"][0]["insertedContent"] == {"text": "fusion"}
    assert loop["locations"][0]["physicalLocation"]["region"] == {"startLine": 41, "startColumn": 3}
    assert lost["locations"][0]["physicalLocation"] == {"artifactLocation": {"uri": "ttrk.mauve"}}


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("a b/ü.mauve", "a%20b/%C3%BC.mauve"),
        ("/srv/r.mauve", "file:///srv/r.mauve"),
        ("C:\\r\\a.mauve", "file:///C:/r/a.mauve"),
        ("x:y", "x%3Ay"),
    ],
)
def test_a_file_name_becomes_a_uri_reference(name: str, expected: str) -> None:
    assert uri(name) == expected


def test_a_place_may_begin_with_a_file_and_a_line() -> None:
    assert parse_place("fusion.c:41 (0x8a34, in `f`)") == Place("fusion.c", 41, None, "(0x8a34, in `f`)")
    assert parse_place("src/a b.c:7:2") == Place("src/a b.c", 7, 2)
    assert parse_place("0x8a34, in `f`") is None
    assert parse_place("") is None


def test_a_format_that_does_not_exist_is_refused() -> None:
    with pytest.raises(ValueError, match="xml"):
        render(ALL, "xml")


@given(diagnostics())
@settings(max_examples=80, deadline=None)
def test_any_diagnostic_has_a_form_in_every_format(diagnostic: Diagnostic) -> None:
    for format in Format:
        render([diagnostic], format, file="f").encode("utf-8")
    assert len(render([diagnostic], "short").splitlines()) == 1
    assert render([diagnostic], "github").count("\n") == 1
