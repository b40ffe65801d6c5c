"""The LALR machine: runs the table over the tokens and builds the tree at each reduction."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from mauve.diagnostics.diagnostic import Report
from mauve.records import record
from mauve.source import SourceFile
from mauve.syntax import ast
from mauve.syntax.actions import ACTIONS
from mauve.syntax.build import LEAVES, Context
from mauve.syntax.table import Table, load_table
from mauve.syntax.tokens import Scan, Token

RESERVED = frozenset(
    {"then", "when", "on", "after", "do", "emit", "every", "once"}
    | {"reads", "writes", "returns", "wcet", "symbol", "not", "and", "or"}
)
"""Words that join the parts of a declaration; they are never names."""


SHARED = frozenset({"ASSUME"})
"""Keywords that open an item of several constructs, one inside the other."""


@record
class Snapshot:
    """The stacks before the token at index `at`. Lists among the values only grow, from `lengths` on."""

    at: int
    states: list[int]
    values: list[Any]
    lengths: list[int]
    starts: list[int]
    last_end: int


def feed(table: Table, states: list[int], kind: str) -> bool:
    """Shift a kind of token on a stack of states alone, after the reductions it allows; False where it does not fit."""
    actions = table.actions
    action = actions[states[-1]].get(kind)
    while action is not None and action < 0:
        name, size = table.rules[~action]
        if size:
            del states[-size:]
        states.append(actions[states[-1]][name])
        if states[-1] == table.final:
            return True
        action = actions[states[-1]].get(kind)
    if action is None:
        return False
    states.append(action)
    return True


def kind_of(table: Table, states: Sequence[int], token: Token) -> str:
    """What a token is to the parser in these states.

    A word is a keyword where it fits, else a name, except that reserved words never are. Where the last state knows
    both, a LALR table may have borrowed the keyword from another context: then it is tried.
    """
    word = table.words.get(token.text) if token.kind == "NAME" else None
    if word is None:
        return token.kind
    row = table.actions[states[-1]]
    if token.text in RESERVED or (word in row and ("NAME" not in row or feed(table, list(states), word))):
        return word
    return "NAME"


class Machine:
    """The stacks of one run: `states`, `values` and `starts` grow together, `states` being one longer.

    `at` is the index of the next token, `last_end` the offset after the last one shifted. `suspect` is the situation
    before the latest keyword that opened a line and was taken for a name, or for an item of the innermost construct
    where one around it has such items, too (SHARED): often what should come before it is missing.
    `closing` is the one before the latest brace that closed a block of another indentation: it may be one too many.
    """

    def __init__(self, file: SourceFile, scanned: Scan, report: Report) -> None:
        self.file = file
        self.table: Table = load_table()
        self.tokens = scanned.tokens
        self.context = Context(file, report, scanned.docs, set())
        self.states = [self.table.start]
        self.values: list[Any] = []
        self.starts: list[int] = []
        self.at = 0
        self.last_end = 0
        self.suspect: Snapshot | None = None
        self.closing: Snapshot | None = None

    def advance(self) -> ast.Module | None:
        """Run until the file is read, or until the token at `at` does not fit: then None."""
        actions, words, tokens = self.table.actions, self.table.words, self.tokens
        states, values, starts = self.states, self.values, self.starts
        while True:
            token = tokens[self.at]
            kind, text, start, end = token
            row = actions[states[-1]]
            if kind == "NAME" and text in words:
                kind = kind_of(self.table, states, token)
                if (kind == "NAME" or kind in SHARED) and self._opens_line(start):
                    self.suspect = self._snapshot()
            elif kind == "RBRACE" and self._opens_line(start) and not self._aligned(start):
                self.closing = self._snapshot()
            action = row.get(kind)
            while action is not None and action < 0:
                self.reduce(~action)
                if states[-1] == self.table.final:
                    module: ast.Module = values[-1]
                    return module
                action = actions[states[-1]].get(kind)
            if action is None:
                return None
            make = LEAVES.get(kind)
            if make:
                values.append(make(self.context, token))
            else:
                values.append(Token(kind, text, start, end))
            states.append(action)
            starts.append(start)
            self.last_end = end
            self.at += 1

    def reduce(self, rule: int) -> None:
        """Replace the right side of a rule on the stacks by its left side, and build its value.

        The helper rules of repetitions (`__...`) make lists, which melt into the rule that uses them. A rule with an
        action makes what the action returns, one without passes its only child on.
        """
        name, size = self.table.rules[rule]
        states, values, starts = self.states, self.values, self.starts
        begin = starts[-size] if size else self.last_end
        children = values[-size:] if size else []
        if size:
            del states[-size:], values[-size:], starts[-size:]
        if name.startswith("__"):
            if type(children[0]) is list:
                value: Any = children[0]
                value.extend(children[1:])
            else:
                value = children
        else:
            action = ACTIONS.get(name)
            if action is None:
                (value,) = children
            else:
                for child in children:
                    if type(child) is list:
                        children = [x for c in children for x in (c if type(c) is list else (c,))]
                        break
                value = action(self.context, children, begin, self.last_end)
        states.append(self.table.actions[states[-1]][name])
        values.append(value)
        starts.append(begin)

    def push(self, token: Token) -> bool:
        """Shift a made-up token of the given kind, reducing first; False where it does not fit."""
        actions = self.table.actions
        action = actions[self.states[-1]].get(token.kind)
        while action is not None and action < 0:
            self.reduce(~action)
            action = actions[self.states[-1]].get(token.kind)
        if action is None:
            return False
        make = LEAVES.get(token.kind)
        self.states.append(action)
        self.values.append(make(self.context, token) if make else token)
        self.starts.append(token.start)
        return True

    def restore(self, snapshot: Snapshot) -> None:
        """Go back to an earlier situation."""
        for value, length in zip(snapshot.values, snapshot.lengths, strict=True):
            if type(value) is list:
                del value[length:]
        self.states[:] = snapshot.states
        self.values[:] = snapshot.values
        self.starts[:] = snapshot.starts
        self.at, self.last_end = snapshot.at, snapshot.last_end

    def open_brace(self) -> Token | None:
        """The innermost brace that is not closed."""
        closed = 0
        for value in reversed(self.values):
            if type(value) is Token and value.kind == "RBRACE":
                closed += 1
            elif type(value) is Token and value.kind == "LBRACE":
                if not closed:
                    return value
                closed -= 1
        return None

    def indent(self, offset: int) -> str:
        """The white space with which the line of an offset begins."""
        line = self.file.text[self.file.text.rfind("\n", 0, offset) + 1 : offset]
        return line[: len(line) - len(line.lstrip())]

    def _opens_line(self, start: int) -> bool:
        """Whether the next token is the first of its line."""
        before = self.tokens[self.at - 1].end if self.at else 0
        return "\n" in self.file.text[before:start]

    def _aligned(self, start: int) -> bool:
        """Whether a closing brace is indented as the line that opens its block."""
        opening = self.open_brace()
        return opening is None or self.indent(opening.start) == self.indent(start)

    def _snapshot(self) -> Snapshot:
        """The situation before the next token."""
        values, starts = list(self.values), list(self.starts)
        lengths = [len(value) if type(value) is list else 0 for value in values]
        return Snapshot(self.at, list(self.states), values, lengths, starts, self.last_end)
