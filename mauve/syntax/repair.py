"""Changes at a syntax error, and what would come of them: the parser's states simulated without building anything."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from mauve.diagnostics.diagnostic import Diagnostic
from mauve.diagnostics.suggest import closest
from mauve.records import record
from mauve.syntax.machine import Machine, feed, kind_of
from mauve.syntax.table import Table
from mauve.syntax.tokens import END, Token


@record
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


@record
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
        return feed(self.table, list(self.states), kind)

    def complete(self) -> bool:
        """Whether the file could end here."""
        return self.fits(END)

    def allowed(self) -> list[str]:
        """All kinds of tokens that could stand here."""
        return [kind for kind in self.row() if (kind.isupper() or kind == END) and self.fits(kind)]

    def score(self, states: Sequence[int], insert: Sequence[str], at: int, limit: int) -> int:
        """How many tokens from index `at` on fit after the inserted kinds, at most `limit`; the end counts as all.

        Where the line is finished and only the next one does not fit, that is one more: it is another error.
        """
        simulated = list(states)
        for kind in insert:
            if not feed(self.table, simulated, kind):
                return 0
        for count in range(limit):
            token = self.tokens[min(at + count, len(self.tokens) - 1)]
            kind = kind_of(self.table, simulated, token)
            if token.text == ";" and not feed(self.table, list(simulated), kind):
                continue  # a slip of its own
            if not feed(self.table, simulated, kind):
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
