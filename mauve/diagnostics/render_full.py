"""The format `full`: for people at a terminal, with source excerpts, labels, notes and help."""

from __future__ import annotations

from collections.abc import Iterable

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Fix, Label, Severity
from mauve.diagnostics.display import lines, one_line
from mauve.diagnostics.excerpt import Mark, excerpt, mark
from mauve.diagnostics.rules import RULES
from mauve.diagnostics.style import PLAIN, Role, Style, severity_role
from mauve.source import SourceFile

GUTTER = 2
"""Width of the line numbers where a message shows no source line, and the least width elsewhere."""


def render_full(diagnostics: Iterable[Diagnostic], style: Style = PLAIN) -> str:
    """Every message in the order given, a blank line between two, and a line that counts them; empty for none."""
    messages = list(diagnostics)
    if not messages:
        return ""
    blocks = ["\n".join(_message(each, style)) for each in messages]
    return "\n\n".join([*blocks, summary(messages)]) + "\n"


def summary(diagnostics: Iterable[Diagnostic]) -> str:
    """How many of each severity there are: `2 errors, 1 warning`; empty for none."""
    messages = list(diagnostics)
    counts = [(sum(d.severity is severity for d in messages), severity.value) for severity in Severity]
    return ", ".join(f"{count} {name}{'' if count == 1 else 's'}" for count, name in counts if count)


def title(diagnostic: Diagnostic) -> str:
    """Code and slug: `MV201 type-mismatch`."""
    rule = RULES.get(diagnostic.code)
    return f"{diagnostic.code} {rule.slug}" if rule else diagnostic.code


def _message(diagnostic: Diagnostic, style: Style) -> list[str]:
    role = severity_role(diagnostic.severity)
    head = style.paint(role, f"{diagnostic.severity.value}[{title(diagnostic)}]")
    out = [head + style.paint(Role.MESSAGE, f": {one_line(diagnostic.message)}")]
    parts = _parts(diagnostic, role)
    last_line = max((m.last.line for _, marks in parts for m in marks), default=0)
    gutter = max(GUTTER, len(str(last_line)))
    arrow = "-->"
    if diagnostic.primary is None and diagnostic.place:
        out.append(_arrow("-->", one_line(diagnostic.place), gutter, style))
        arrow = ":::"
    for file, marks in parts:
        first = next((m for m in marks if m.symbol == "^"), marks[0]).first
        out.append(_arrow(arrow, f"{one_line(file.name)}:{first.line}:{first.column}", gutter, style))
        out.append(style.paint(Role.GUTTER, " " * gutter + " |"))
        out.extend(excerpt(file, marks, gutter, style))
        arrow = ":::"
    if diagnostic.primary is not None and diagnostic.place:
        out.append(_arrow(":::", one_line(diagnostic.place), gutter, style))
    for note in diagnostic.notes:
        out.extend(_footer("note", note, gutter, style))
    if diagnostic.help is not None:
        out.extend(_footer("help", diagnostic.help.text + fix_mark(diagnostic.help), gutter, style))
    return out


def fix_mark(fix: Fix) -> str:
    """` [fixable]` after advice that a tool may carry out by itself."""
    return " [fixable]" if fix.edits and fix.applicability is Applicability.MACHINE else ""


def _parts(diagnostic: Diagnostic, role: Role) -> list[tuple[SourceFile, list[Mark]]]:
    """The marks by file: the primary span's file first, the others in the order of their labels."""
    parts: list[tuple[SourceFile, list[Mark]]] = []

    def add(label: Label, symbol: str, role: Role) -> None:
        file = label.span.file
        marks = next((marks for known, marks in parts if known is file or known == file), None)
        if marks is None:
            marks = []
            parts.append((file, marks))
        marks.append(mark(label.span, label.text, symbol, role))

    if diagnostic.primary is not None:
        add(diagnostic.primary, "^", role)
    for label in diagnostic.labels:
        add(label, "-", Role.SECONDARY)
    return parts


def _arrow(arrow: str, place: str, gutter: int, style: Style) -> str:
    return f"{' ' * gutter}{style.paint(Role.GUTTER, arrow)} {place}"


def _footer(kind: str, text: str, gutter: int, style: Style) -> list[str]:
    """`= note: text`, further lines aligned under the first."""
    first, *rest = lines(text)
    role = Role.HELP if kind == "help" else Role.MESSAGE
    head = f"{' ' * gutter} {style.paint(Role.GUTTER, '=')} {style.paint(role, kind + ':')} {first}".rstrip()
    indent = " " * (gutter + len(" = : ") + len(kind))
    return [head, *((indent + line).rstrip() for line in rest)]
