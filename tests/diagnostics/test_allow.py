"""A comment on its line accepts a warning or a note, never an error, and nothing on other lines."""

from __future__ import annotations

import pytest

from mauve.diagnostics.allow import allowed_codes, filter_allowed
from mauve.diagnostics.diagnostic import Diagnostic, Label, Report, Severity
from mauve.source import SourceFile, Span

FILE = SourceFile("r.mauve", "instance a: A  // mauve: allow(MV211, MV411)\ninstance b: B\n")


def found(code: str, severity: Severity, offset: int) -> Diagnostic:
    return Diagnostic(code, "m", Label(Span(FILE, offset, offset + 1)), severity)


@pytest.mark.parametrize("severity", [Severity.WARNING, Severity.NOTE])
def test_what_the_line_allows_is_gone(severity: Severity) -> None:
    report = Report([found("MV211", severity, 3), found("MV411", severity, 9)])
    assert filter_allowed(report) == []


def test_errors_other_codes_other_lines_and_messages_without_a_line_stay() -> None:
    kept = [
        found("MV211", Severity.ERROR, 3),
        found("MV305", Severity.WARNING, 3),
        found("MV211", Severity.WARNING, 50),
        Diagnostic("MV211", "m", severity=Severity.WARNING),
    ]
    assert filter_allowed(Report(list(kept))) == kept


@pytest.mark.parametrize(
    ("line", "codes"),
    [
        ("x // mauve: allow(MV211)", {"MV211"}),
        ("x //mauve:allow( MV211 , MV305 ) because it is so", {"MV211", "MV305"}),
        ("// mauve: allow(MV211) mauve: allow(MV305)", {"MV211"}),
        ('p = "// mauve: allow(MV211)"', set()),
        ('p = "a//b" // mauve: allow(MV211)', {"MV211"}),
        ("x // allow(MV211)", set()),
        ("x", set()),
        ('"' * 5000, set()),
    ],
)
def test_only_a_comment_counts(line: str, codes: set[str]) -> None:
    assert allowed_codes(line) == codes
