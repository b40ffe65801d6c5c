"""The text of a MAST model: declarations of named fields, nested in parentheses, with the place of each word."""

from __future__ import annotations

import re
from collections.abc import Iterator

from mauve.records import record
from mauve.source import SourceFile, Span

DEEPEST = 40
"""Parentheses nested deeper are no MAST model."""

_TOKEN = re.compile(r'\s+|--[^\n]*|("[^"\n]*")|(=>)|([(),;])|([^\s(),;="]+)|(.)', re.DOTALL)


@record
class Word:
    """A name, a number or a text."""

    text: str
    span: Span


@record
class Group:
    """What stands in parentheses: named fields (lower-case names), and values without a name."""

    fields: tuple[tuple[str, Word | Group], ...]
    items: tuple[Word | Group, ...]
    span: Span

    def get(self, name: str) -> Word | Group | None:
        """The value of a field."""
        return next((value for key, value in self.fields if key == name.lower()), None)

    def word(self, name: str) -> Word | None:
        """The value of a field that is one word."""
        value = self.get(name)
        return value if isinstance(value, Word) else None

    def said(self, name: str) -> str:
        """The text of a field in lower case; empty where it is not there."""
        found = self.word(name)
        return found.text.lower() if found else ""

    def groups(self, name: str) -> tuple[Group, ...]:
        """The groups in a field: one, or a list of them."""
        value = self.get(name)
        if not isinstance(value, Group):
            return ()
        inner = tuple(item for item in value.items if isinstance(item, Group))
        return inner if inner and not value.fields else (value,)

    def words(self, name: str) -> tuple[Word, ...]:
        """The words in a field: one, or a list of them."""
        value = self.get(name)
        if isinstance(value, Word):
            return (value,)
        return tuple(item for item in value.items if isinstance(item, Word)) if value is not None else ()


@record
class Declaration:
    """One object of the model, such as `Transaction (...);`."""

    kind: Word
    body: Group


@record
class Fault:
    """Where the text stops being MAST, and why."""

    span: Span
    message: str


def parse_mast(file: SourceFile) -> tuple[Declaration, ...] | Fault:
    """The declarations of a model."""
    tokens = list(_tokens(file))
    found = []
    at = 0
    while at < len(tokens):
        kind = tokens[at]
        if not kind.text.isidentifier() or at + 1 >= len(tokens) or tokens[at + 1].text != "(":
            return Fault(kind.span, f"`{kind.text[:40]}` begins no MAST declaration, which reads `Kind ( ... );`")
        body = _group(tokens, at + 1)
        if isinstance(body, Fault):
            return body
        group, at = body
        if at >= len(tokens) or tokens[at].text != ";":
            return Fault(tokens[min(at, len(tokens) - 1)].span, "a declaration ends with `);`")
        found.append(Declaration(kind, group))
        at += 1
    if not found:
        return Fault(Span(file, 0, 0), "there is no MAST declaration in the file")
    return tuple(found)


def _tokens(file: SourceFile) -> Iterator[Word]:
    for match in _TOKEN.finditer(file.text):
        if match.lastindex:
            yield Word(match.group().strip('"'), Span(file, match.start(), match.end()))


class _Open:
    """A group that is being read."""

    __slots__ = ("fields", "full", "items", "key", "start")

    def __init__(self, start: Span) -> None:
        self.start = start
        self.fields: list[tuple[str, Word | Group]] = []
        self.items: list[Word | Group] = []
        self.key = ""
        self.full = False  # a value stands here, so that a comma or the end comes next

    def put(self, value: Word | Group) -> None:
        """A value: of the field whose name went before, or without a name."""
        if self.key:
            self.fields.append((self.key, value))
        else:
            self.items.append(value)
        self.key, self.full = "", True


def _group(tokens: list[Word], at: int) -> tuple[Group, int] | Fault:
    """The group that opens at a token, and the token behind it."""
    stack: list[_Open] = []
    while at < len(tokens):
        token = tokens[at]
        if stack and stack[-1].full and token.text not in (",", ")"):
            return Fault(token.span, f"a comma is missing before `{token.text[:40]}`")
        match token.text:
            case "(":
                if len(stack) >= DEEPEST:
                    return Fault(token.span, "parentheses are nested too deeply for a MAST model")
                stack.append(_Open(token.span))
            case ")":
                done = stack.pop()
                group = Group(tuple(done.fields), tuple(done.items), done.start.to(token.span))
                if not stack:
                    return group, at + 1
                stack[-1].put(group)
            case ",":
                stack[-1].full = False
            case ";" | "=>" as mark:
                return Fault(token.span, f"`{mark}` stands where a field or a value is expected")
            case _ if at + 1 < len(tokens) and tokens[at + 1].text == "=>":
                stack[-1].key = token.text.lower()
                at += 1
            case _:
                stack[-1].put(token)
        at += 1
    return Fault(stack[-1].start, "this parenthesis is never closed")
