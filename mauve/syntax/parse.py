"""Text to abstract syntax: the entrance to the parser, and the check of a file's first line."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label, Report
from mauve.source import SourceFile, Span
from mauve.syntax import ast
from mauve.syntax.machine import Machine
from mauve.syntax.tokens import Token, scan

VERSIONS = (1,)
"""The versions of the language that this tool reads."""


def parse(file: SourceFile, report: Report) -> ast.Module:
    """The syntax of one file. Errors go to the report; what could be read is in the module nevertheless.

    A module with errors may lack declarations and hold made-up names: it serves an editor, not an analysis.
    """
    scanned = scan(file, report)
    version = _version(file, scanned.tokens, report) if scanned.complete else None
    if not scanned.complete or (version is not None and version not in VERSIONS):
        return ast.Module(file, version, None, (), ())
    machine = Machine(file, scanned, report)
    module = machine.advance()
    if module is None:
        from mauve.syntax.recover import recover

        module = recover(machine)
    return module


def _version(file: SourceFile, tokens: list[Token], report: Report) -> int | None:
    """The version that the first line states, None where it states none.

    What is wrong with it is reported, and mended in the tokens.
    """
    first = tokens[0]
    if not (first.kind == "NAME" and first.text == "mauve"):
        empty = "the file is empty" if first.start == first.end else "the file does not begin with its language version"
        fix = Fix("begin the file with `mauve 1`", (Edit(Span(file, 0, 0), "mauve 1\n"),), Applicability.MACHINE)
        report.add(Diagnostic("MV003", empty, Label(Span(file, first.start, first.end)), help=fix))
        return None
    number = tokens[1]
    if number.kind == "NUMBER" and number.text.isdigit() and len(number.text) < 10:
        version = int(number.text)
        if version not in VERSIONS:
            readable = " and ".join(str(version) for version in VERSIONS)
            message = f"this file is written in version {version} of the language; this tool reads version {readable}"
            newer = Fix("a newer mauvec may read it") if version > max(VERSIONS) else None
            report.add(Diagnostic("MV003", message, Label(Span(file, first.start, number.end)), help=newer))
        return version
    wrong = number.kind in ("NUMBER", "EXPONENT", "QUANTITY", "HEX", "STRING")
    span = Span(file, first.start, number.end if wrong else first.end)
    fix = Fix("write `mauve 1`", (Edit(span, "mauve 1"),), Applicability.MACHINE)
    report.add(Diagnostic("MV003", "the language version is a whole number", Label(span), help=fix))
    tokens[1 : 2 if wrong else 1] = [Token("NUMBER", "1", first.end, first.end)]
    return None
