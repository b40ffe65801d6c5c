"""A report keeps what the passes found, once each, and sorts it by place."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report, Severity
from mauve.source import SourceFile, Span

FILE = SourceFile("r.mauve", "a\nb\nc\n")


def at(code: str, offset: int, file: SourceFile = FILE, **rest: object) -> Diagnostic:
    return Diagnostic(code, "m", Label(Span(file, offset, offset + 1)), **rest)  # type: ignore[arg-type]


def test_an_equal_diagnostic_is_kept_once_whatever_its_data() -> None:
    report = Report([at("MV201", 0)])
    for diagnostic in (
        at("MV201", 0),
        at("MV201", 0, data=(("names", ["a"]),)),
        at("MV201", 0, data=(("names", ["a"]),)),
        at("MV201", 2),
    ):
        report.add(diagnostic)
    assert list(report) == [at("MV201", 0), at("MV201", 0, data=(("names", ["a"]),)), at("MV201", 2)]


def test_many_diagnostics_take_no_more_than_linear_time() -> None:
    report = Report()
    for offset in range(30_000):
        report.add(at("MV001", offset))
    assert len(report.diagnostics) == 30_000


def test_sorted_goes_by_file_and_position_and_puts_the_placeless_last() -> None:
    other = SourceFile("a.mauve", "x")
    lost = Diagnostic("MV511", "m", place="z.c:1")
    report = Report([lost, at("MV201", 4), at("MV211", 0), at("MV201", 0), at("MV301", 0, other)])
    assert report.sorted() == [at("MV301", 0, other), at("MV201", 0), at("MV211", 0), at("MV201", 4), lost]


def test_only_an_error_is_an_error() -> None:
    assert not Report([at("MV211", 0, severity=Severity.WARNING), at("MV420", 0, severity=Severity.NOTE)]).has_errors
    assert Report([at("MV201", 0)]).has_errors
