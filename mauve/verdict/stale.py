"""A warning where a binary is older than a source it was built from (MV504)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.model.model import Binary

if TYPE_CHECKING:
    from mauve.wcet.cache import Cache

TOLERANCE = 2.0
"""Seconds: a checkout or a copy writes sources and binary in any order."""


def check_stale(binary: Binary, cache: Cache | None, report: Report) -> None:
    """Append MV504 for the newest source that is newer than the binary. Paths are those of its line table, relative to
    the directory it was built in, taken as the binary's own."""
    from mauve.wcet.sources import source_files

    path = Path(binary.path)
    try:
        built = path.stat().st_mtime
    except OSError:
        return
    newest: tuple[float, str] | None = None
    for name in source_files(path, cache):
        try:
            changed = (path.parent / name).stat().st_mtime
        except OSError:
            continue
        if changed > built + TOLERANCE and (newest is None or changed > newest[0]):
            newest = (changed, name)
    if newest is not None:
        message = f"`{binary.path}` is older than its source `{newest[1]}`"
        help_ = Fix("build it again, or the times are those of an earlier program")
        report.add(Diagnostic("MV504", message, Label(binary.span), Severity.WARNING, help=help_))
