"""What happens at a syntax error: one message, the smallest change that lets the parser go on, and no cascade.

The changes tried at the token that does not fit, cheapest first: known slips (slips.py), a mark or a word inserted, the
token left out or exchanged, several tokens left out. Each is judged by how many of the next tokens then fit. Where none
helps, the parser leaves the construct and goes on at the next member, or at the end of the block.
"""

from __future__ import annotations

from collections.abc import Iterator

from mauve.records import changed
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.explain import explain, reserved, surplus, unclosed, unfinished
from mauve.syntax.machine import RESERVED, Machine, feed
from mauve.syntax.repair import Repair, Situation, machine_situation
from mauve.syntax.slips import slip
from mauve.syntax.table import Table
from mauve.syntax.tokens import END, Token

MOST_ERRORS = 25
"""After so many errors in one file the rest is not read."""

LOOKAHEAD = 5
"""A change that lets so many tokens pass is as good as any."""

QUIET = 3
"""An error within so many tokens of its line after a change is taken for its consequence and not reported."""

DEEPEST_STACK = 1000
"""More symbols are half read only in a chain of `not`, whose end is then dropped."""

MOST_STALLS = 6
"""So many changes in a row may leave the parser where it is."""

MOST_SKIPPED = 50_000
"""Where the parser finds nothing to go on with in so many tokens, the rest of the file is not read."""

PLACEHOLDERS = {"NAME": "_missing", "QUANTITY": "1", "NUMBER": "1", "STRING": '""'}
"""The text of a token that is missing altogether."""


def recover(machine: Machine) -> ast.Module:
    """Report the error at which the machine stands and those that follow, and read on to the end."""
    recovery = _Recovery(machine)
    while True:
        recovery.repair()
        module = machine.advance()
        if module is not None:
            return module


class _Recovery:
    """Counts errors, and remembers up to where they are consequences of the last one."""

    def __init__(self, machine: Machine) -> None:
        self.machine = machine
        self.quiet_until = -1
        self.errors = 0
        self.furthest = -1
        self.stalls = 0

    def repair(self) -> None:
        """Mend the error at the machine's next token, or leave the construct it is in."""
        machine = self.machine
        if len(machine.states) > DEEPEST_STACK:
            self._pop(len(machine.states) - DEEPEST_STACK)
        situation = machine_situation(machine)
        silent = machine.at < self.quiet_until and not situation.opens_line(machine.at)
        machine.context.broken.add(machine.file.position(machine.tokens[machine.at].start).line)
        if machine.at:
            machine.context.broken.add(machine.file.position(situation.token(-1).end).line)
        self.errors += not silent
        if self.errors > MOST_ERRORS:
            message = f"more than {MOST_ERRORS} syntax errors: the rest of the file is not read"
            token = machine.tokens[machine.at]
            machine.context.error(message, Span(machine.file, token.start, token.end))
            self._finish()
        elif self._stalled():
            self._leave_behind()
        elif machine.tokens[machine.at].kind == END:
            if not silent:
                missing = situation.fits("RBRACE")
                diagnostic = unclosed(machine) if missing else unfinished(machine, situation)
                machine.context.report.add(diagnostic)
            self._finish()
        else:
            best = self._best()
            if not silent:
                self._report(best)
            if best is None:
                self._leave()
                self.quiet_until = machine.at
            else:
                self._apply(best)
                self.quiet_until = machine.at + QUIET

    def _stalled(self) -> bool:
        """Whether the last changes have not brought the parser further: no mixture of changes may go in circles."""
        self.stalls = self.stalls + 1 if self.machine.at <= self.furthest else 0
        self.furthest = max(self.furthest, self.machine.at)
        return self.stalls > MOST_STALLS

    def _leave_behind(self) -> None:
        """Leave out all tokens up to the furthest one that was reached."""
        self.machine.suspect = self.machine.closing = None
        self.machine.at = min(self.furthest + 1, len(self.machine.tokens) - 1)
        if self.machine.tokens[self.machine.at].kind == END:
            self._finish()

    def _best(self) -> Repair | None:
        """The change that lets most tokens pass, where need be before a keyword that was read as a name."""
        machine = self.machine
        closing, suspect = machine.closing, machine.suspect
        if closing is not None and machine.at - closing.at == 1:
            inside = changed(machine_situation(machine), states=closing.states)
            if inside.score(closing.states, (), machine.at, LOOKAHEAD) == LOOKAHEAD:
                machine.restore(closing)
                return Repair(replace=1, told=surplus)
        if suspect is not None and 0 < machine.at - suspect.at <= 2:
            earlier = changed(machine_situation(machine), states=suspect.states, at=suspect.at)
            back = _choose(earlier)
            if back is not None and back.insert and not back.replace and back.score >= LOOKAHEAD:
                machine.restore(suspect)
                machine.suspect = None
                return back
        return _choose(machine_situation(self.machine))

    def _report(self, best: Repair | None) -> None:
        machine = self.machine
        if best is not None and best.told is not None:
            diagnostic = best.told(machine)
        elif best is not None and best.rename:
            diagnostic = reserved(machine)
        elif best is not None and "RBRACE" in best.insert and not best.replace:
            diagnostic = unclosed(machine)
        else:
            diagnostic = explain(machine, machine_situation(self.machine), best)
        machine.context.report.add(diagnostic)

    # -------------------------------------------------------------------------------------------- acting
    def _apply(self, best: Repair) -> None:
        """Carry out a change."""
        machine = self.machine
        self._pop(best.pops)
        token = machine.tokens[machine.at]
        for kind in best.insert:
            if best.replace:
                last = machine.tokens[machine.at + best.replace - 1]
                text = best.text if best.text is not None else token.text
                usable = best.text is not None or best.rename or kind == token.kind or kind not in PLACEHOLDERS
                machine.push(Token(kind, text if usable else PLACEHOLDERS[kind], token.start, last.end))
                machine.last_end = last.end
            else:
                machine.push(Token(kind, PLACEHOLDERS.get(kind, ""), machine.last_end, machine.last_end))
        machine.at += best.replace

    def _pop(self, count: int) -> None:
        """Drop symbols that are half read."""
        machine = self.machine
        if count:
            del machine.states[-count:], machine.values[-count:], machine.starts[-count:]

    def _leave(self) -> None:
        """Skip to a token with which a member or a block may go on or end, and drop what is half read."""
        machine, situation = self.machine, machine_situation(self.machine)
        begin, depth = machine.at, 0
        inside = machine.open_brace() is not None
        for at in range(begin, min(begin + MOST_SKIPPED, len(machine.tokens))):
            token = machine.tokens[at]
            possible = token.kind == "NAME" or (inside and token.kind in ("RBRACE", "ARROW"))
            if depth == 0 and possible and self._resume(situation, at, fresh=at > begin):
                return
            if token.kind == "LBRACE":
                depth += 1
            elif token.kind == "RBRACE":
                depth = max(0, depth - 1)
        self._finish()

    def _resume(self, situation: Situation, at: int, fresh: bool) -> bool:
        """Go on at a token, if that is possible after dropping what is half read of the innermost block.

        A declaration at the margin ends the blocks around it too. `fresh`: the token is not the one in error.
        """
        machine = self.machine
        token = machine.tokens[at]
        word = token.kind == "ARROW" or token.text in machine.table.words
        if not word and token.kind != "RBRACE" and not situation.opens_line(at):
            return False
        need = 1 if token.kind == "RBRACE" else 3
        states = list(machine.states)
        while True:
            pops = len(machine.states) - len(states)
            if (pops or fresh) and _goes_on(situation, states, at, need):
                self._pop(pops)
                machine.at = at
                return True
            if len(states) == 1 or machine.table.symbols[states[-1]] == "LBRACE":
                break
            _drop(machine.table, states)
        return machine.file.position(token.start).column == 1 and self._close_to(at)

    def _close_to(self, at: int) -> bool:
        """Close blocks until the token fits; False, with nothing changed, where it never does."""
        machine, situation = self.machine, machine_situation(self.machine)
        states = list(machine.states)
        plan: list[int] = []
        while situation.score(states, (), at, 3) < 3:
            before = len(states)
            while len(states) > 1 and not feed(machine.table, list(states), "RBRACE"):
                _drop(machine.table, states)
            if len(states) == 1:
                return False
            plan.append(before - len(states))
            feed(situation.table, states, "RBRACE")
        for pops in plan:
            self._pop(pops)
            machine.push(Token("RBRACE", "}", machine.last_end, machine.last_end))
        machine.at = at
        return True

    def _finish(self) -> None:
        """Close what is open, so that the end of the file fits."""
        machine = self.machine
        machine.at = len(machine.tokens) - 1
        while len(machine.states) > 1 and not machine_situation(self.machine).complete():
            if feed(machine.table, list(machine.states), "RBRACE"):
                machine.push(Token("RBRACE", "}", machine.last_end, machine.last_end))
            else:
                states = list(machine.states)
                _drop(machine.table, states)
                self._pop(len(machine.states) - len(states))


def _drop(table: Table, states: list[int]) -> None:
    """Drop the last symbol; for a closing brace, all of the block it closes."""
    depth = 0
    while len(states) > 1:
        symbol = table.symbols[states.pop()]
        depth += (symbol == "RBRACE") - (symbol == "LBRACE" and depth > 0)
        if depth == 0:
            return


def _goes_on(situation: Situation, states: list[int], at: int, need: int) -> bool:
    """Whether so many tokens fit from an index on, the first one perhaps misspelled: that is an error of its own."""
    if situation.score(states, (), at, need) >= need:
        return True
    if not situation.opens_line(at) or situation.tokens[at].text in situation.table.words:
        return False
    there = changed(situation, states=states, at=at)
    return any(there.score(states, (kind,), at + 1, need) >= need for kind in there.near_words(there.token()))


def _choose(situation: Situation) -> Repair | None:
    """The best change at a token that does not fit, the first among equals; None where none lets enough tokens pass."""
    told = slip(situation)
    if told is not None:
        return told
    best: Repair | None = None
    for repair in _candidates(situation):
        if repair.score >= repair.need and (best is None or repair.score > best.score):
            best = repair
            if best.score >= LOOKAHEAD:
                break
    return best


def _candidates(situation: Situation) -> Iterator[Repair]:
    """Changes in the order of preference, each with its score."""
    token, row, table = situation.token(), situation.row(), situation.table
    opens_line = situation.opens_line(situation.at)

    def judged(insert: tuple[str, ...], skip: int, need: int, rename: bool = False) -> Repair:
        score = situation.score(situation.states, insert, situation.at + skip, LOOKAHEAD)
        return Repair(insert, replace=skip, score=score, need=need, rename=rename)

    marks = [kind for kind in table.marks.values() if kind in row and kind not in ("RBRACE", "DOT", "PLUS", "QMARK")]
    joining = [table.words[word] for word in sorted(RESERVED)]
    words = [kind for kind in dict.fromkeys([*joining, *table.words.values()]) if kind in row]
    holders = [kind for kind in PLACEHOLDERS if kind in row]
    if token.text in RESERVED and "NAME" in row:
        yield judged(("NAME",), 1, 2, rename=True)
    yield from (judged((kind,), 0, 2) for kind in marks)
    yield from (judged((kind,), 1, 2) for kind in situation.near_words(token))
    yield from (judged(("RBRACE",) * closes, 0, 3 if opens_line else LOOKAHEAD) for closes in (1, 2, 3))
    yield from (judged((kind,), 0, 2) for kind in holders)
    yield judged((), 1, 3)
    yield from (judged((kind,), 1, 3) for kind in [*holders, *marks])
    for kind in words:
        yield judged((kind,), 0, 3)
        yield judged((kind,), 1, 3)
    for skip in range(2, 9):
        last = situation.token(skip - 1)
        if last.kind in (END, "LBRACE", "RBRACE") or "\n" in situation.text[token.start : last.start]:
            return
        yield judged((), skip, 3)
