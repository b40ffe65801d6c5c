"""Changes at a syntax error, and what would come of them: the parser's states simulated without building anything."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from mauve.diagnostics.diagnostic import Diagnostic
from mauve.diagnostics.suggest import closest
from mauve.syntax.machine import RESERVED, Machine
from mauve.syntax.table import Table
from mauve.syntax.tokens import END, Token


@dataclass(frozen=True, slots=True)
class Repair:
    """A change at the token that does not fit.

    Drop the last `pops` symbols, put tokens of the kinds `insert` there, leave out `replace` tokens. With both, the
    inserted token stands for those left out, with their text or with `text`. `score` counts the tokens that then fit,
    `need` how many are asked for. `rename`: a reserved word is read as a name. `told` makes the message of a slip.
    """

    insert: tuple[str, ...] = ()
    replace: int = 0
    pops: int = 0
    text: str | None = None
    score: int = 0
    need: int = 1
    rename: bool = False
    told: Callable[[Machine], Diagnostic] | None = None


def machine_situation(machine: Machine) -> Situation:
    """Where a machine stands."""
    return Situation(machine.table, machine.file.text, machine.tokens, machine.states, machine.at)


@dataclass(frozen=True, slots=True)
class Situation:
    """The states of the parser before the token at index `at` of a text."""

    table: Table
    text: str
    tokens: Sequence[Token]
    states: Sequence[int]
    at: int

    def row(self) -> dict[str, int]:
        """What the last state does for each symbol."""
        return self.table.actions[self.states[-1]]

    def symbols(self) -> list[str]:
        """The symbols read so far and not yet reduced."""
        return [self.table.symbols[state] for state in self.states[1:]]

    def token(self, ahead: int = 0) -> Token:
        """The token that does not fit, or one after (before) it; the last (first) one beyond the ends."""
        return self.tokens[max(0, min(self.at + ahead, len(self.tokens) - 1))]

    def opens_line(self, at: int) -> bool:
        """Whether the token of an index is the first of its line."""
        return at == 0 or "\n" in self.text[self.tokens[at - 1].end : self.tokens[at].start]

    def fits(self, kind: str) -> bool:
        """Whether a token of this kind could stand here."""
        return self.feed(list(self.states), kind)

    def complete(self) -> bool:
        """Whether the file could end here."""
        return self.fits(END)

    def allowed(self) -> list[str]:
        """All kinds of tokens that could stand here."""
        return [kind for kind in self.row() if (kind.isupper() or kind == END) and self.fits(kind)]

    def feed(self, states: list[int], kind: str) -> bool:
        """Shift a token of this kind, after the reductions it allows; False where it does not fit."""
        actions = self.table.actions
        action = actions[states[-1]].get(kind)
        while action is not None and action < 0:
            name, size = self.table.rules[~action]
            if size:
                del states[-size:]
            states.append(actions[states[-1]][name])
            if states[-1] == self.table.final:
                return True
            action = actions[states[-1]].get(kind)
        if action is None:
            return False
        states.append(action)
        return True

    def kind(self, state: int, token: Token) -> str:
        """What the parser would take a token for."""
        word = self.table.words.get(token.text) if token.kind == "NAME" else None
        if word is not None and (word in self.table.actions[state] or token.text in RESERVED):
            return word
        return token.kind

    def score(self, states: Sequence[int], insert: Sequence[str], at: int, limit: int) -> int:
        """How many tokens from index `at` on fit after the inserted kinds, at most `limit`; the end counts as all.

        Where the line is finished and only the next one does not fit, that is one more: it is another error.
        """
        simulated = list(states)
        for kind in insert:
            if not self.feed(simulated, kind):
                return 0
        for count in range(limit):
            token = self.tokens[min(at + count, len(self.tokens) - 1)]
            if not self.feed(simulated, self.kind(simulated[-1], token)):
                return count + (count > 0 and self.opens_line(min(at + count, len(self.tokens) - 1)))
            if token.kind == END:
                return limit
        return limit

    def near_words(self, token: Token) -> list[str]:
        """Keywords that a name may be a misspelling of and that could stand here."""
        if token.kind != "NAME":
            return []
        words = {text: kind for text, kind in self.table.words.items() if kind in self.row()}
        return [words[near] for near in closest(token.text, words)]
