"""What is wrong with a task set, told once, at its place in the file."""

from __future__ import annotations

from fractions import Fraction

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.tasksets.taskset import MOST_TASKS, Path, Spans

MOST_FAULTS = 50
"""So many faults of one file are told; the rest are only counted."""


class Faults:
    """Collects the faults of one file; `errors` counts those that are errors."""

    __slots__ = ("count", "errors", "report", "spans")

    def __init__(self, spans: Spans, report: Report) -> None:
        self.spans, self.report = spans, report
        self.count = self.errors = 0

    def add(self, code: str, path: Path, message: str, help_: str = "", label: str = "") -> None:
        """An error at a path."""
        self.errors += 1
        self._tell(code, path, message, Severity.ERROR, help_, label)

    def warn(self, code: str, path: Path, message: str, help_: str = "", severity: Severity = Severity.WARNING) -> None:
        """A warning, or a note, at a path."""
        self._tell(code, path, message, severity, help_, "")

    def _tell(self, code: str, path: Path, message: str, severity: Severity, help_: str, label: str) -> None:
        self.count += 1
        if self.count > MOST_FAULTS:
            return
        fix = Fix(help_) if help_ else None
        self.report.add(Diagnostic(code, message, Label(self.spans.of(path), label), severity, help=fix))

    def close(self) -> None:
        """Say how many were left out."""
        if self.count > MOST_FAULTS:
            message = f"and {self.count - MOST_FAULTS} more like these"
            severity = Severity.ERROR if self.errors else Severity.NOTE
            self.report.add(Diagnostic("MV622", message, None, severity, place=self.spans.file.name))


def positive(value: Fraction, what: str, path: Path, faults: Faults) -> bool:
    """Whether a time is above 0; MV623 where it is not."""
    if value > 0:
        return True
    faults.add("MV623", path, f"{what} is not above 0")
    return False


def not_negative(value: Fraction, what: str, path: Path, faults: Faults) -> bool:
    """Whether a time is 0 or more; MV623 where it is not."""
    if value >= 0:
        return True
    faults.add("MV623", path, f"{what} is negative")
    return False


def too_many(count: int, path: Path, faults: Faults) -> bool:
    """MV623 for more tasks than are analysed."""
    if count <= MOST_TASKS:
        return False
    faults.add("MV623", path, f"the set has {count} tasks; at most {MOST_TASKS} are analysed")
    return True


def unique(names: list[tuple[str, Path]], what: str, faults: Faults) -> None:
    """MV624 for each name that is given twice."""
    seen: set[str] = set()
    for name, path in names:
        if name in seen:
            faults.add("MV624", path, f"there are two {what} of the name `{name}`", "give each its own name")
        seen.add(name)
