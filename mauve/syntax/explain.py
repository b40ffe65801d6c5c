"""Messages of syntax errors: what is missing or wrong where a token does not fit."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label
from mauve.source import Span
from mauve.syntax.machine import Machine
from mauve.syntax.repair import Repair, Situation, machine_situation
from mauve.syntax.tokens import END, Token
from mauve.syntax.words import DECLARED, SEPARATES, expected, found, quoted

WIDEST_HELP = 70
"""Longer lines are not repeated in a help text."""


def _span(machine: Machine, token: Token) -> Span:
    return Span(machine.file, token.start, token.end)


def _same_line(machine: Machine, start: int, end: int) -> bool:
    return "\n" not in machine.file.text[start:end]


def explain(machine: Machine, situation: Situation, repair: Repair | None) -> Diagnostic:
    """The message for a token that does not fit, with the fix where the repair is a small one."""
    token = machine.tokens[machine.at]
    if repair is not None and len(repair.insert) == 1 and not repair.replace:
        return _missing(machine, situation, repair.insert[0])
    word = _meant(machine, repair)
    if word:
        span = _span(machine, token)
        fix = Fix(f"there is a word `{word}`", (Edit(span, word),), Applicability.MAYBE)
        allowed = expected(machine.table, situation.symbols(), situation.allowed())
        return Diagnostic("MV001", f"unknown word {found(token)}", Label(span, f"expected {allowed}"), help=fix)
    return _unexpected(machine, situation, token, repair)


def _meant(machine: Machine, repair: Repair | None) -> str:
    """The keyword that a misspelled word stands for."""
    if repair is None or repair.replace != 1 or len(repair.insert) != 1:
        return ""
    situation = machine_situation(machine)
    if repair.insert[0] not in situation.near_words(machine.tokens[machine.at]):
        return ""
    return next(text for text, kind in machine.table.words.items() if kind == repair.insert[0])


def _unexpected(machine: Machine, situation: Situation, token: Token, repair: Repair | None) -> Diagnostic:
    allowed = expected(machine.table, situation.symbols(), situation.allowed())
    span = _span(machine, token)
    if token.kind == "RBRACE" and machine.open_brace() is None:
        edit = (Edit(span, ""),)
        fix = Fix("remove it, or an earlier `}` that closes too much", edit, Applicability.MAYBE)
        return Diagnostic("MV001", "this `}` closes nothing", Label(span, "no brace is open here"), help=fix)
    fix_ = None
    if repair is not None and not repair.insert:
        last = machine.tokens[machine.at + repair.replace - 1]
        removed = Span(machine.file, token.start, last.end)
        fix_ = Fix(f"remove `{removed.text}`", (Edit(removed, ""),), Applicability.MAYBE)
    labels = _closed_before(machine, situation)
    label = "" if allowed else "this cannot stand here"
    message = f"expected {allowed}, found {found(token)}" if allowed else f"unexpected {found(token)}"
    return Diagnostic("MV001", message, Label(span, label), labels=labels, help=fix_)


def _closed_before(machine: Machine, situation: Situation) -> tuple[Label, ...]:
    """Between declarations, the brace that ended the last one: it may have come too early."""
    if not situation.complete() or machine.at == 0:
        return ()
    before = machine.tokens[machine.at - 1]
    return (Label(_span(machine, before), "the declaration ends here"),) if before.kind == "RBRACE" else ()


def _construct(machine: Machine, situation: Situation) -> str:
    """The keyword that opens the construct being read."""
    known = {keyword for _, keyword in SEPARATES} | set(DECLARED)
    for symbol in reversed(situation.symbols()):
        if symbol in known:
            return symbol
        if symbol.startswith("__") or symbol == "LBRACE":
            continue
    return ""


def _missing(machine: Machine, situation: Situation, kind: str) -> Diagnostic:
    """One token is missing between the last one and this one."""
    token, before = machine.tokens[machine.at], situation.token(-1)
    construct = _construct(machine, situation)
    what = quoted(machine.table, kind)
    if kind in ("NAME", "QUANTITY", "NUMBER", "STRING"):
        what = expected(machine.table, situation.symbols(), [kind])
    place, label = SEPARATES.get((kind, construct), ("", ""))
    if not place:
        place = f"after {found(before)}" if machine.at else "first"
    together = _same_line(machine, before.end, token.start)
    begins = kind == "ARROW" or kind in machine.table.words.values()
    if not together and not begins:
        primary = Label(_span(machine, before), "before the end of this line")
    else:
        primary = Label(_span(machine, token), label)
    fix = _insertion(machine, kind, before, token, together)
    return Diagnostic("MV001", f"expected {what} {place}", primary, help=fix)


def _insertion(machine: Machine, kind: str, before: Token, token: Token, together: bool) -> Fix | None:
    """The line with what is missing."""
    written = quoted(machine.table, kind)
    if not written.startswith("`") or not machine.at:
        return None
    mark = written[1:-1]
    tight = mark in (":", ",", ")", "]")
    at = before.end
    inserted = mark if tight else f" {mark}"
    start = machine.file.text.rfind("\n", 0, at) + 1
    head = machine.file.text[start:at].strip()
    tail = machine.file.text[token.start : token.end] if together else ""
    shown = " ".join(f"{head}{inserted} {tail}".split())
    fixed = (Edit(Span(machine.file, at, at), inserted),)
    text = f"write `{shown}`" if len(shown) <= WIDEST_HELP else f"write {written} after {found(before)}"
    return Fix(text, fixed, Applicability.MAYBE)


def reserved(machine: Machine) -> Diagnostic:
    """A reserved word where a name is expected."""
    token = machine.tokens[machine.at]
    span = _span(machine, token)
    situation = machine_situation(machine)
    wanted = expected(machine.table, situation.symbols(), ["NAME"])
    fix = Fix(f"choose another name, such as `{token.text}_`")
    label = f"{wanted} is expected here"
    message = f"`{token.text}` is a reserved word and cannot be a name"
    return Diagnostic("MV005", message, Label(span, label), help=fix)


# ------------------------------------------------------------------------------------------------ braces
def unclosed(machine: Machine) -> Diagnostic:
    """A closing brace is missing before the next token: shown at the brace that it should close."""
    token = machine.tokens[machine.at]
    opening = _suspicious(machine) or machine.open_brace()
    if opening is None:
        return unfinished(machine, machine_situation(machine))
    span = _span(machine, opening)
    place = f"a `}}` is missing before this {found(token)}" if token.kind != END else "the file ends here"
    labels = (Label(_span(machine, token), place),)
    indent = machine.indent(opening.start)
    before = machine.tokens[machine.at - 1].end
    fix = Fix("close it", (Edit(Span(machine.file, before, before), f"\n{indent}}}"),), Applicability.MAYBE)
    return Diagnostic("MV001", "this `{` is not closed", Label(span), labels=labels, help=fix)


def _suspicious(machine: Machine) -> Token | None:
    """The first brace whose closing one, first on its line, is indented less than the line that opens it."""
    text = machine.file.text
    stack: list[Token] = []
    for token in machine.tokens[: machine.at]:
        if token.kind == "LBRACE":
            stack.append(token)
        elif token.kind == "RBRACE" and stack:
            opening = stack.pop()
            indent = machine.indent(token.start)
            alone = not text[text.rfind("\n", 0, token.start) + 1 : token.start].strip()
            if alone and len(indent) < len(machine.indent(opening.start)):
                return opening
    return None


def surplus(machine: Machine) -> Diagnostic:
    """The next token is a closing brace too many."""
    token = machine.tokens[machine.at]
    span, opening = _span(machine, token), machine.open_brace()
    labels = (Label(_span(machine, opening), "it would close this one"),) if opening else ()
    fix = Fix("remove it", (Edit(span, ""),), Applicability.MAYBE)
    return Diagnostic("MV001", "a `}` too many", Label(span, "what follows belongs inside"), labels=labels, help=fix)


def unfinished(machine: Machine, situation: Situation) -> Diagnostic:
    """The file ends inside a construct."""
    before = situation.token(-1)
    allowed = expected(machine.table, situation.symbols(), situation.allowed())
    message = f"the file ends where {allowed} is expected"
    return Diagnostic("MV001", message, Label(_span(machine, before), "after this"))
