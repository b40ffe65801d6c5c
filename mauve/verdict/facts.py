"""Files of flow facts, read for an analysis; what is wrong with them told as messages."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report, Severity
from mauve.source import SourceFile, Span

if TYPE_CHECKING:
    from mauve.wcet.flow.facts import Fact

LARGEST = 16 << 20
"""A longer file, in bytes, is refused."""


def read_facts(path: str, named: Span | None, report: Report) -> tuple[Fact, ...]:
    """The facts of an OTAWA file; MV516 for what is wrong, at its place. `named` is where a model names the file."""
    from mauve.wcet.flow.otawa import parse_facts

    text = _text(path, named, report)
    if text is None:
        return ()
    parsed = parse_facts(text, path)
    file = SourceFile(path, text)
    for problem in parsed.problems:
        line = min(problem.line, len(file.line_starts))
        start = min(file.line_starts[line - 1] + problem.column - 1, len(text))
        span = Span(file, start, min(start + 1, len(text)))
        severity = Severity.ERROR if problem.is_error else Severity.NOTE
        report.add(Diagnostic("MV516", problem.message, Label(span), severity))
    return parsed.facts


def _text(path: str, named: Span | None, report: Report) -> str | None:
    try:
        with Path(path).open("rb") as stream:
            data = stream.read(LARGEST + 1)
        if len(data) <= LARGEST:
            return data.decode("utf-8")
        reason = f"it has more than {LARGEST >> 20} MiB"
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
    except UnicodeDecodeError:
        reason = "it is not UTF-8 text"
    except ValueError:
        reason = "its name has a NUL character"
    primary = Label(named) if named is not None else None
    message = f"the flow facts `{path}` cannot be read: {reason}"
    report.add(Diagnostic("MV516", message, primary, place="" if primary else path))
    return None
