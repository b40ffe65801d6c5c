"""What the actions of the grammar's rules share: the context of a run, leaves, clauses, and the checks of form.

An action gets the values of a rule's right side in order (tokens, nodes, tuples) and the offsets of the text it covers.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Sequence
from itertools import pairwise
from typing import Any, TypeVar

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label, Report
from mauve.records import record
from mauve.source import SourceFile, Span
from mauve.syntax import ast
from mauve.syntax.tokens import Token

LONGEST_NUMERAL = 40
"""More characters than any number of a model needs."""

DEEPEST_GUARD = 100
"""Operators nested deeper than this in one guard are refused, so that no later pass runs out of stack."""

T = TypeVar("T")


@record
class Context:
    """What actions need besides their children: the file, the report, and the documentation by offset."""

    file: SourceFile
    report: Report
    docs: dict[int, str]
    broken: set[int]
    """the lines of syntax errors, about which nothing else is said"""

    def span(self, start: int, end: int) -> Span:
        """A span of the file."""
        return Span(self.file, start, end)

    def doc(self, start: int) -> str:
        """The `///` text before the token at an offset."""
        return self.docs.get(start, "") if self.docs else ""

    def sound(self, first: Span, last: Span) -> bool:
        """Whether no syntax error was found in the lines from one span to another."""
        return not any(first.first.line <= line <= last.last.line for line in self.broken)

    def error(self, message: str, span: Span, label: str = "", fix: Fix | None = None) -> None:
        """Report a syntax error."""
        self.report.add(Diagnostic("MV001", message, Label(span, label), help=fix))


Action = Callable[[Context, list[Any], int, int], Any]


@record
class Clause:
    """An optional part of a declaration: `reads a, b` is the clause `reads` with two names."""

    word: str
    value: Any
    span: Span


# ------------------------------------------------------------------------------------------------ leaves
def _name(context: Context, token: Token) -> ast.Name:
    return ast.Name(token.text, Span(context.file, token.start, token.end))


def _numeral(context: Context, token: Token, text: str) -> str:
    """The text of a numeral, or `1` where it is too long to be meant."""
    if len(text) <= LONGEST_NUMERAL:
        return text
    span = context.span(token.start, token.end)
    message = f"a number has at most {LONGEST_NUMERAL} characters, this one has {len(text)}"
    context.report.add(Diagnostic("MV007", message, Label(span)))
    return "1"


def _number(context: Context, token: Token) -> ast.Number:
    return ast.Number(_numeral(context, token, token.text), context.span(token.start, token.end))


def _quantity(context: Context, token: Token) -> ast.Quantity:
    split = re.match(r"-?[0-9]*(?:\.[0-9]+)?", token.text)
    number = split[0] if split else ""
    unit = token.text[len(number) :].replace("\u03bc", "\u00b5")
    return ast.Quantity(_numeral(context, token, number), unit, context.span(token.start, token.end))


_ESCAPES = {"n": "\n", "t": "\t", "\\": "\\", '"': '"'}


def _string(context: Context, token: Token) -> ast.String:
    def resolve(found: re.Match[str]) -> str:
        if found[1] not in _ESCAPES:
            start = token.start + 1 + found.start()
            fix = Fix('a backslash stands before `"`, `\\`, `n` or `t`; write `\\\\` for a backslash itself')
            context.error(f"a string has no escape `{found[0]}`", context.span(start, start + 2), fix=fix)
        return _ESCAPES.get(found[1], found[1])

    inner = token.text[1:-1]
    value = re.sub(r"\\(.)", resolve, inner) if "\\" in inner else inner
    return ast.String(value, context.span(token.start, token.end))


LEAVES: dict[str, Callable[[Context, Token], Any]] = {
    "NAME": _name,
    "NUMBER": _number,
    "HEX": _number,
    "EXPONENT": _number,
    "QUANTITY": _quantity,
    "STRING": _string,
}


# ------------------------------------------------------------------------------------------------ picking children
def only(children: Iterable[Any], kind: type[T]) -> tuple[T, ...]:
    """The children of one type, in order."""
    return tuple(child for child in children if isinstance(child, kind))


def first(children: Iterable[Any], kind: type[T]) -> T | None:
    """The first child of a type, if any."""
    for child in children:
        if isinstance(child, kind):
            return child
    return None


def has(children: Iterable[Any], word: str) -> bool:
    """Whether a keyword is among the children."""
    return any(type(child) is Token and child.kind == word for child in children)


def as_name(context: Context, child: ast.Name | Token) -> ast.Name:
    """A name, or a keyword that stands for one."""
    return child if isinstance(child, ast.Name) else _name(context, child)


# ------------------------------------------------------------------------------------------------ clauses
def clause(word: str, position: int = 1) -> Action:
    """The action of a clause that begins with a keyword: its value is the child at `position`."""

    def action(context: Context, children: list[Any], start: int, end: int) -> Clause:
        return Clause(word, children[position], context.span(start, end))

    return action


def all_of(children: Iterable[Any], word: str) -> list[Clause]:
    """The clauses of one kind."""
    return [child for child in children if isinstance(child, Clause) and child.word == word]


def take(context: Context, children: Sequence[Any], word: str) -> Any:
    """The value of a clause that may occur once, None where it is missing. A second one is reported."""
    found = all_of(children, word)
    for extra in found[1:]:
        label = Label(found[0].span, "first here")
        message = f"`{word}` is given twice"
        context.report.add(Diagnostic("MV001", message, Label(extra.span, "and here"), labels=(label,)))
    return found[0].value if found else None


# ------------------------------------------------------------------------------------------------ one per line
def check_lines(context: Context, items: Sequence[Any], start: int, end: int) -> None:
    """In a block of several lines (`start` to `end`) no two items begin on one line: MV006, once per line."""
    text = context.file.text
    if len(items) < 2 or "\n" not in text[start:end]:
        return
    reported = False
    head = items[0]
    for before, item in pairwise(items):
        if "\n" in text[before.span.start : item.span.start]:
            head, reported = item, False
        elif not reported and context.sound(head.span, item.span):
            reported = True
            line = [i for i in items if i.span.start > head.span.start and _same_line(text, head, i)]
            _crowded(context, head, line)


def _same_line(text: str, head: Any, item: Any) -> bool:
    return "\n" not in text[head.span.start : item.span.start]


def _crowded(context: Context, head: Any, others: Sequence[Any]) -> None:
    """Report items that share the line of `head`; the fix gives each a line of its own."""
    text, file = context.file.text, context.file
    line_start = text.rfind("\n", 0, head.span.start) + 1
    before = text[line_start : head.span.start]
    indent = before if not before.strip() else re.match(r"[ \t]*", before)[0] + "  "  # type: ignore[index]
    edits = []
    for item in others:
        gap = len(text[: item.span.start].rstrip(" \t"))
        edits.append(Edit(Span(file, gap, item.span.start), "\n" + indent))
    fix = Fix("begin a new line before it", tuple(edits), Applicability.MACHINE)
    first_of_line = Label(head.span, "the first one of this line")
    primary = Label(others[0].span, "a second one")
    message = "in a block of several lines each member stands on its own line"
    context.report.add(Diagnostic("MV006", message, primary, labels=(first_of_line,), help=fix))
