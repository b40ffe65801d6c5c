"""Colours of the full format: a Style maps the role of a piece of text to a terminal escape, or to nothing."""

from __future__ import annotations

from enum import Enum

from mauve.diagnostics.diagnostic import Severity
from mauve.records import record

RESET = "\x1b[0m"


class Role(Enum):
    """What a piece of rendered text is, independent of how it looks."""

    PLAIN = "plain"
    ERROR = "error"
    WARNING = "warning"
    NOTE = "note"
    MESSAGE = "message"
    GUTTER = "gutter"
    SECONDARY = "secondary"
    HELP = "help"


@record
class Style:
    """The escape sequence of each role; a role that is not listed stays plain."""

    escapes: tuple[tuple[Role, str], ...] = ()

    def paint(self, role: Role, text: str) -> str:
        """The text in the look of its role."""
        for known, escape in self.escapes:
            if known is role and text:
                return f"{escape}{text}{RESET}"
        return text


PLAIN = Style()
ANSI = Style(
    (
        (Role.ERROR, "\x1b[1;31m"),
        (Role.WARNING, "\x1b[1;33m"),
        (Role.NOTE, "\x1b[1;36m"),
        (Role.MESSAGE, "\x1b[1m"),
        (Role.GUTTER, "\x1b[34m"),
        (Role.SECONDARY, "\x1b[34m"),
        (Role.HELP, "\x1b[32m"),
    )
)


def severity_role(severity: Severity) -> Role:
    """The role of a severity's name and of its primary marks."""
    match severity:
        case Severity.ERROR:
            return Role.ERROR
        case Severity.WARNING:
            return Role.WARNING
        case Severity.NOTE:
            return Role.NOTE
