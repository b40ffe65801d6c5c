"""Comments that accept a warning: `// mauve: allow(MV211)` on the line where the warning points."""

from __future__ import annotations

import re

from mauve.diagnostics.diagnostic import Diagnostic, Report, Severity

_STRING_OR_COMMENT = re.compile(r'"[^"]*"?|//.*')
_ALLOW = re.compile(r"//\s*mauve:\s*allow\(([^()]*)\)")


def filter_allowed(report: Report) -> list[Diagnostic]:
    """The report's diagnostics, sorted, without the warnings and notes that a comment on their line allows.

    The line is the one on which the primary span begins. Errors stay: a comment never makes a wrong model right.
    """
    return [each for each in report.sorted() if not _is_allowed(each)]


def _is_allowed(diagnostic: Diagnostic) -> bool:
    if diagnostic.severity is Severity.ERROR or diagnostic.primary is None:
        return False
    span = diagnostic.primary.span
    return diagnostic.code in allowed_codes(span.file.line(span.first.line))


def allowed_codes(line: str) -> frozenset[str]:
    """The codes that a source line's comment allows; `//` inside a string is no comment."""
    comments = (found for found in _STRING_OR_COMMENT.findall(line) if found.startswith("//"))
    lists = _ALLOW.findall(next(comments, ""))
    return frozenset(code.strip() for codes in lists for code in codes.split(","))
