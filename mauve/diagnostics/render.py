"""Diagnostics in any of the output formats."""

from __future__ import annotations

from collections.abc import Iterable
from enum import Enum

from mauve.diagnostics.diagnostic import Diagnostic


class Format(Enum):
    """The output formats, by the names of the command line."""

    FULL = "full"
    SHORT = "short"
    JSON = "json"
    SARIF = "sarif"
    GITHUB = "github"


def render(
    diagnostics: Iterable[Diagnostic],
    format: Format | str = Format.FULL,
    *,
    colour: bool = False,
    file: str = "",
    version: str = "",
) -> str:
    """The diagnostics in the order given, as text that ends with a line end; empty where a format has nothing to say.

    `colour` applies to `full`; `file` is named by the line-based formats for messages without a place; `version` is the
    tool's, for SARIF. Raises ValueError for a format that does not exist.
    """
    match Format(format):
        case Format.FULL:
            from mauve.diagnostics.render_full import render_full
            from mauve.diagnostics.style import ANSI, PLAIN

            return render_full(diagnostics, ANSI if colour else PLAIN)
        case Format.SHORT:
            from mauve.diagnostics.render_short import render_short

            return render_short(diagnostics, file)
        case Format.JSON:
            from mauve.diagnostics.render_json import render_json

            return render_json(diagnostics)
        case Format.SARIF:
            from mauve.diagnostics.render_sarif import render_sarif

            return render_sarif(diagnostics, file, version)
        case Format.GITHUB:
            from mauve.diagnostics.render_github import render_github

            return render_github(diagnostics, file)
