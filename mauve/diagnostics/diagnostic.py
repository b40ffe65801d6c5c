"""A diagnostic is data: what is wrong, where, why, what to do. Passes append them to a Report; renderers show them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import Enum

from mauve.records import record
from mauve.source import Span


class Severity(Enum):
    """How serious a diagnostic is. Only an error makes the command line exit with 1."""

    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"


class Applicability(Enum):
    """Whether a tool may apply a fix by itself."""

    MACHINE = "machine-applicable"
    MAYBE = "maybe-incorrect"
    PLACEHOLDERS = "has-placeholders"


@record
class Label:
    """A span of source with a short text about it (the text may be empty)."""

    span: Span
    text: str = ""


@record
class Edit:
    """Replace the span by the text (an empty span inserts)."""

    span: Span
    text: str


@record
class Fix:
    """Advice in words, and where possible the edits that carry it out."""

    text: str
    edits: tuple[Edit, ...] = ()
    applicability: Applicability = Applicability.PLACEHOLDERS


@record
class Diagnostic:
    """One message.

    `code` is a key of the rule table. `message` stands alone; `primary` is where to look first (None when no source
    text is at fault); `place` is a location outside the model's text, for findings in a binary: `fusion.c:41 (0x8a34,
    in mat_invert)`. `notes` give context, `help` what to change. `data` carries figures for machine readers.
    """

    code: str
    message: str
    primary: Label | None = None
    severity: Severity = Severity.ERROR
    labels: tuple[Label, ...] = ()
    place: str = ""
    notes: tuple[str, ...] = ()
    help: Fix | None = None
    data: tuple[tuple[str, object], ...] = ()


class Report:
    """The diagnostics of one run, in the order the passes found them. Passes append, the command line renders."""

    def __init__(self, diagnostics: Iterable[Diagnostic] = ()) -> None:
        self.diagnostics = list(diagnostics)
        self._alike: dict[tuple[str, str, int], list[Diagnostic]] = {}
        for diagnostic in self.diagnostics:
            self._alike.setdefault(_key(diagnostic), []).append(diagnostic)

    def add(self, diagnostic: Diagnostic) -> None:
        """Append one diagnostic, unless an equal one has been added before. The cost is that of one lookup."""
        alike = self._alike.setdefault(_key(diagnostic), [])
        if diagnostic not in alike:
            alike.append(diagnostic)
            self.diagnostics.append(diagnostic)

    @property
    def has_errors(self) -> bool:
        """Whether any diagnostic is an error."""
        return any(d.severity is Severity.ERROR for d in self.diagnostics)

    def sorted(self) -> list[Diagnostic]:
        """By file, line, column, then code; those without a source position last."""

        def key(d: Diagnostic) -> tuple[int, str, int, str]:
            if d.primary is None:
                return (1, d.place, 0, d.code)
            return (0, d.primary.span.file.name, d.primary.span.start, d.code)

        return sorted(self.diagnostics, key=key)

    def __iter__(self) -> Iterator[Diagnostic]:
        return iter(self.diagnostics)


def _key(diagnostic: Diagnostic) -> tuple[str, str, int]:
    """What equal diagnostics share, cheap to compare; `data` may hold what has no hash."""
    return diagnostic.code, diagnostic.message, diagnostic.primary.span.start if diagnostic.primary else -1
