"""Text to tokens. Words are not told from names here: that depends on the state of the parser.

The regular expressions of the tokens come from the grammar; beside them stand those of what people write by mistake
(`/* */`, `'x'`, a string without its end), so that one slip is one message.
"""

from __future__ import annotations

import re
from functools import cache
from itertools import islice
from typing import NamedTuple

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label, Report
from mauve.records import record
from mauve.source import SourceFile, Span
from mauve.syntax.table import load_table

DEEPEST = 64
"""Brackets nested deeper than this are refused, so that no later pass runs out of stack."""

MOST_TOKENS = 500_000
"""A file of more words and marks is refused, so that the time for any file is bounded."""

MOST_PROBLEMS = 25
"""After so many problems inside tokens the rest of a file is not read."""

END = "$END"
OTHER = "OTHER"
"""The kind of a character, or a group of them, that is no token of the language."""


class Token(NamedTuple):
    """A terminal of the grammar (NAME also for words), its text, and its offsets."""

    kind: str
    text: str
    start: int
    end: int


@record
class Scan:
    """The tokens of a file, closed by one of kind END.

    `comments` are all comments in order. `docs` holds the text of `///` lines by the start of the token that follows.
    `complete` is false where the scan gave up, for too deep a nesting, too many tokens or too many problems.
    """

    tokens: list[Token]
    comments: list[Token]
    docs: dict[int, str]
    complete: bool = True


@cache
def _master() -> re.Pattern[str]:
    """One expression that matches anywhere, tried from left to right; leading white space is skipped.

    It matches at every offset, the end included, so that the time to scan grows with the length of the text only.
    """
    table = load_table()
    marks = "|".join(re.escape(mark) for mark in table.marks)
    groups = [
        ("COMMENT", r"//[^\n]*"),
        ("BLOCK_COMMENT", r"/\*(?s:.*?)(?:\*/|\Z)"),
        *table.patterns,
        ("OPEN_STRING", r'"[^\n{}]*'),
        ("SINGLE", r"'[^'\n]*'"),
        ("FOREIGN_WORD", r"\w+"),
        (OTHER, r"=>|==|:=|<-|&&|\|\|"),
        ("MARK", marks),
        ("LAST", r"\Z"),
        ("REST", r"[^\s\ufeff]"),
    ]
    return re.compile(r"[\s\ufeff]*(?:" + "|".join(f"(?P<{name}>{pattern})" for name, pattern in groups) + ")")


def scan(file: SourceFile, report: Report) -> Scan:
    """Split a text into tokens. Problems inside one token go to the report, and the token is mended."""
    text, marks = file.text, load_table().marks
    result = Scan([], [], {})
    tokens, docs = result.tokens, result.docs
    depth, doc, problems = 0, "", 0
    for match in islice(_master().finditer(text), MOST_TOKENS * 2):
        kind = match.lastgroup or OTHER
        start, end = match.span(kind)
        word = text[start:end]
        if kind == "MARK":
            kind = marks[word]
            if word in "{[(":
                depth += 1
                if depth > DEEPEST:
                    return _give_up(f"brackets are nested more than {DEEPEST} deep", Span(file, start, end), report)
            elif word in "}])":
                depth -= 1
        elif kind == "COMMENT":
            result.comments.append(Token(kind, word, start, end))
            if word.startswith("///") and not word.startswith("////") and _first_on_line(text, start):
                doc = f"{doc}\n{word[3:].strip()}" if doc else word[3:].strip()
            continue
        elif kind not in ("NAME", "NUMBER", "QUANTITY", "STRING"):
            if kind == "FOREIGN_WORD" and tokens and tokens[-1].kind == "NAME" and tokens[-1].end == start:
                start = tokens.pop().start
                word = text[start:end]
            known = len(report.diagnostics)
            mended = _mend(file, Token(kind, word, start, end), report)
            problems += len(report.diagnostics) - known
            if problems > MOST_PROBLEMS:
                return _give_up(f"more than {MOST_PROBLEMS} wrong tokens", Span(file, start, end), report)
            if mended is None:
                continue
            kind, word, start, end = mended
        if doc:
            docs[start], doc = doc, ""
        tokens.append(Token(kind, word, start, end))
    if len(tokens) > MOST_TOKENS or match.end() < len(text):
        last = (tokens or result.comments)[-1]
        span = Span(file, last.start, last.end)
        return _give_up(f"more than {MOST_TOKENS} words and marks in one file", span, report)
    tokens.append(Token(END, "", len(text), len(text)))
    return result


def _first_on_line(text: str, offset: int) -> bool:
    """Whether only white space stands before an offset on its line."""
    return not text[text.rfind("\n", 0, offset) + 1 : offset].strip()


def _mend(file: SourceFile, token: Token, report: Report) -> Token | None:
    """Report what is wrong inside a token and give what was meant; None drops it."""
    span = Span(file, token.start, token.end)
    match token.kind:
        case "LAST":
            return None
        case "BLOCK_COMMENT":
            report.add(syntax("comments begin with `//` and end with the line", span, "write `//` before each line"))
            return None
        case "OPEN_STRING":
            return _open_string(file, token, report)
        case "SINGLE":
            inner = token.text[1:-1].replace('"', '\\"')
            fix = Fix(f'write `"{inner}"`', (Edit(span, f'"{inner}"'),), Applicability.MACHINE)
            report.add(Diagnostic("MV001", "strings stand in double quotes", Label(span), help=fix))
            return token._replace(kind="STRING", text=f'"{inner}"')
        case "FOREIGN_WORD":
            if token.text[0].isdigit():
                return token._replace(kind=OTHER)
            wrong = next(c for c in token.text if not (c.isascii()))
            report.add(syntax(f"a name has no `{wrong}`: it consists of the letters a to z, digits and `_`", span))
            return token._replace(kind="NAME")
        case "REST":
            return token._replace(kind=OTHER)
        case _:
            return token


def _open_string(file: SourceFile, token: Token, report: Report) -> Token:
    """A string without its closing quote: it ends before a comment, or before a brace at the end of the line."""
    content = token.text.split(" //")[0].rstrip()
    end = token.start + len(content)
    span = Span(file, token.start, end)
    fix = Fix(f'write `{content}"`', (Edit(Span(file, end, end), '"'),), Applicability.MAYBE)
    report.add(Diagnostic("MV001", "this string has no closing quote", Label(span), help=fix))
    return Token("STRING", f'{content}"', token.start, end)


def syntax(message: str, span: Span, advice: str = "") -> Diagnostic:
    """A syntax error with advice in words."""
    return Diagnostic("MV001", message, Label(span), help=Fix(advice) if advice else None)


def _give_up(message: str, span: Span, report: Report) -> Scan:
    """A file that no person wrote: nothing of it is parsed."""
    report.add(Diagnostic("MV008", message, Label(span, "the file is not read from here on")))
    return Scan([Token(END, "", 0, 0)], [], {}, complete=False)
