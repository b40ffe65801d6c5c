"""Flow facts from OTAWA's .ff files.

A file is a list of statements, each ended by a semicolon; `//` and `#` start a comment up to the end of the line,
`/* */` encloses one. An address is a number, `"symbol"`, `"symbol" + offset` (or - offset), or `"file":line`.
Numbers are decimal, hexadecimal (0x), octal (leading 0) or binary (0b). A `?` stands where a tool left a number to be
filled in.

What `loop ADDRESS max N` counts: passes along back edges, per entry of the loop. That is how OTAWA constrains its
problem, so a loop may run its header N + 1 times, whether the compiler left the test at its top or turned it around.

Statements that change what we compute are loop bounds, noreturn, return, nocall and targets of branches and calls. The
others are understood and have no influence here (decoding hints, memory and register hints): a note says so. A checksum
is not compared, because its algorithm covers bytes of the executable file in OTAWA's way; a note says so, too.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import PurePath

from mauve.wcet.flow.facts import (
    AtAddress,
    AtLine,
    AtSymbol,
    ControlFact,
    ControlKind,
    Counting,
    Fact,
    LoopFact,
    Place,
)

GREATEST = (1 << 63) - 1


@dataclass(frozen=True, slots=True)
class FfProblem:
    """A remark on a .ff file: line and column count from 1; a note where `is_error` is false."""

    line: int
    column: int
    message: str
    is_error: bool = True


@dataclass(frozen=True, slots=True)
class FfFile:
    """The facts of a file, in its order, and what is wrong with it."""

    facts: tuple[Fact, ...]
    problems: tuple[FfProblem, ...]


def parse_facts(text: str, name: str = "") -> FfFile:
    """Read the text of a .ff file; `name` is its path, for `Fact.written`. Never raises: errors are located problems,
    and reading goes on behind the next semicolon."""
    parser = _Parser(text, PurePath(name).name or name)
    parser.run()
    return FfFile(tuple(parser.facts), tuple(parser.problems))


# ------------------------------------------------------------------------------------------------------------ tokens
_TOKEN = re.compile(
    r"""(?P<space>\s+|//[^\n]*|\#[^\n]*|/\*.*?\*/)
      | (?P<string>"[^"\n]*")
      | (?P<number>0[xX][0-9a-fA-F]+|0[bB][01]+|\d+)(?![A-Za-z0-9_])
      | (?P<word>[A-Za-z_][A-Za-z0-9_]*)
      | (?P<mark>\.\.|[;:,+\-=?()\[\]{}*./])
    """,
    re.VERBOSE | re.DOTALL,
)


_STATEMENTS = frozenset(
    {
        *("loop", "noreturn", "return", "nocall", "multibranch", "multicall", "checksum", "noblock", "doinline"),
        *("noinline", "ignorecontrol", "preserve", "memory", "register", "force", "ignore"),
    }
)


@dataclass(frozen=True, slots=True)
class _Token:
    kind: str
    text: str
    offset: int


def _tokens(text: str) -> Iterator[_Token]:
    offset = 0
    while offset < len(text):
        found = _TOKEN.match(text, offset)
        if found is None:
            end = offset + 1
            if text.startswith("/*", offset):
                end = len(text)
            elif text[offset] == '"':
                end = offset + len(text[offset:].split("\n", 1)[0].split(";", 1)[0])
            yield _Token("bad", text[offset:end], offset)
            offset = end
            continue
        if found.lastgroup != "space":
            yield _Token(found.lastgroup or "bad", found.group(), offset)
        offset = found.end()
    yield _Token("end", "", len(text))


class _Unreadable(Exception):
    """A statement that cannot be read; inside this module only."""

    def __init__(self, token: _Token, message: str) -> None:
        super().__init__(message)
        self.token = token
        self.message = message


# ------------------------------------------------------------------------------------------------------------ parser
@dataclass(slots=True)
class _Parser:
    text: str
    name: str
    facts: list[Fact] = field(default_factory=list)
    problems: list[FfProblem] = field(default_factory=list)
    tokens: list[_Token] = field(default_factory=list)
    at: int = 0

    def run(self) -> None:
        """Read statement by statement."""
        self.tokens = list(_tokens(self.text.removeprefix("\ufeff")))
        while self.here.kind != "end":
            if self._take(";"):
                continue
            begin = self.at
            try:
                self._statement()
                if not self._take(";"):
                    raise _Unreadable(self.here, f"expected `;` before {_shown(self.here)}")
            except _Unreadable as error:
                self._report(error.token, error.message)
                self.at = max(self.tokens.index(error.token), begin + 1)
                self._skip()

    # -- tools
    @property
    def here(self) -> _Token:
        """The next token."""
        return self.tokens[self.at]

    def _next(self) -> _Token:
        token = self.here
        if token.kind != "end":
            self.at += 1
        return token

    def _take(self, text: str) -> bool:
        if self.here.text.lower() == text and self.here.kind in ("mark", "word"):
            self.at += 1
            return True
        return False

    def _expect(self, text: str) -> None:
        if not self._take(text):
            raise _Unreadable(self.here, f"expected `{text}` instead of {_shown(self.here)}")

    def _skip(self) -> None:
        """Go on behind the next semicolon, or where a line begins with a statement that was not begun yet."""
        while self.here.kind != "end" and not self._take(";"):
            if self.here.text.lower() in _STATEMENTS and self._begins_line(self.here):
                return
            self.at += 1

    def _begins_line(self, token: _Token) -> bool:
        return self.at > 0 and not self.text[self.text.rfind("\n", 0, token.offset) + 1 : token.offset].strip()

    def _report(self, token: _Token, message: str, is_error: bool = True) -> None:
        line = self.text.count("\n", 0, token.offset) + 1
        column = token.offset - (self.text.rfind("\n", 0, token.offset) + 1) + 1
        self.problems.append(FfProblem(line, column, message, is_error))

    def _written(self, token: _Token) -> str:
        return f"{self.name}:{self.text.count(chr(10), 0, token.offset) + 1}"

    def _ignore(self, token: _Token, what: str) -> None:
        """Pass over the rest of a statement that has no influence."""
        self._report(token, f"{what} has no influence on this analysis", is_error=False)
        while self.here.kind not in ("end", "bad") and self.here.text != ";":
            self.at += 1

    # -- statements
    def _statement(self) -> None:
        start = self._next()
        match start.text.lower() if start.kind == "word" else "":
            case "loop":
                self._loop(start)
            case "noreturn":
                self._control(start, ControlKind.NO_RETURN)
            case "return":
                self._control(start, ControlKind.RETURN)
            case "nocall":
                self._control(start, ControlKind.NO_CALL)
            case "multibranch":
                self._targets(start)
            case "multicall":
                self._targets(start)
            case "checksum":
                self._ignore(start, "`checksum`, which is not compared with the executable,")
            case "noblock" | "doinline" | "noinline" | "ignorecontrol" | "preserve" | "memory" | "register" as word:
                self._ignore(start, f"`{word}`")
            case "force" | "ignore" as word:
                following = self.here.text.lower()
                allowed = ("branch", "call") if word == "force" else ("entry", "seq")
                if following not in allowed:
                    options = " or ".join(f"`{option}`" for option in allowed)
                    raise _Unreadable(self.here, f"expected {options} after `{word}` instead of {_shown(self.here)}")
                self._ignore(start, f"`{word} {following}`")
            case _:
                raise _Unreadable(start, f"unknown statement {_shown(start)}")

    def _loop(self, start: _Token) -> None:
        place = self._place()
        maximum: int | None = None
        total: int | None = None
        open_at: _Token | None = None
        while self.here.kind != "end" and self.here.text != ";":
            token = self._next()
            match token.text.lower():
                case "max" | "total" | "min" as word:
                    if self.here.text == "?":
                        open_at = self._next()
                        continue
                    value = self._number()
                    if word == "max":
                        maximum = value
                    elif word == "total":
                        total = value
                case "?":
                    open_at = token
                case "in":
                    self._context(start)
                    return
                case _:
                    raise _Unreadable(token, f"expected `max`, `total`, `min` or `in` instead of {_shown(token)}")
        if open_at is not None and maximum is None and total is None:
            self._report(open_at, "the bound is still a `?`: write a number here", is_error=False)
        elif maximum is None and total is None:
            raise _Unreadable(start, "a loop statement without `max N` or `total N` says nothing")
        else:
            self.facts.append(LoopFact(place, maximum, Counting.BACK, total, self._written(start), len(self.facts)))

    def _context(self, start: _Token) -> None:
        """A bound that holds in one calling context only would be unsound elsewhere; none is taken from it."""
        self._report(start, "a bound for one calling context only is not used: give one without `in`", is_error=False)
        while self.here.kind not in ("end", "bad") and self.here.text != ";":
            self.at += 1

    def _control(self, start: _Token, kind: ControlKind) -> None:
        self.facts.append(ControlFact(kind, self._place(), (), self._written(start), len(self.facts)))

    def _targets(self, start: _Token) -> None:
        place = self._place()
        if self._take("?"):
            self._report(start, "the targets are still a `?`: write addresses here", is_error=False)
            return
        self._expect("to")
        if self.here.text == "?":
            self._report(self._next(), "the targets are still a `?`: write addresses here", is_error=False)
            return
        targets = [self._place()]
        while self._take(","):
            targets.append(self._place())
        written = self._written(start)
        self.facts.append(ControlFact(ControlKind.TARGETS, place, tuple(targets), written, len(self.facts)))

    # -- addresses and numbers
    def _place(self) -> Place:
        token = self._next()
        if token.kind == "number":
            self.at -= 1
            return AtAddress(self._number())
        if token.kind != "string":
            raise _Unreadable(token, f"expected an address instead of {_shown(token)}")
        name = token.text[1:-1]
        if not name:
            raise _Unreadable(token, "a symbol or file without a name")
        if self._take(":"):
            return AtLine(name, self._number())
        if self._take("+"):
            return AtSymbol(name, self._number())
        if self._take("-"):
            return AtSymbol(name, -self._number())
        return AtSymbol(name)

    def _number(self) -> int:
        token = self._next()
        if token.kind != "number":
            raise _Unreadable(token, f"expected a number instead of {_shown(token)}")
        text = token.text.lower()
        base = (
            16 if text.startswith("0x") else 2 if text.startswith("0b") else 8 if text[0] == "0" and text != "0" else 10
        )
        try:
            value = int(text, base)
        except ValueError:
            raise _Unreadable(token, f"`{token.text}` is not a number in base {base}") from None
        if value > GREATEST:
            raise _Unreadable(token, f"`{token.text}` is too large")
        return value


def _shown(token: _Token) -> str:
    if token.kind == "end":
        return "the end of the file"
    if token.kind == "bad" and token.text.startswith('"'):
        return "a string that does not end on its line"
    if token.kind == "bad" and token.text.startswith("/*"):
        return "a comment that does not end"
    return f"`{token.text}`"
