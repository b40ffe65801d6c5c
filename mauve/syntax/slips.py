"""Slips that people make who come from other languages, each with a message of its own."""

from __future__ import annotations

import re
from collections.abc import Callable

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label
from mauve.source import Span
from mauve.syntax.build_systems import unit_apart
from mauve.syntax.machine import Machine, feed
from mauve.syntax.quantities import UNITS
from mauve.syntax.repair import Repair, Situation
from mauve.syntax.tokens import END, Token

_OPERATORS = {"=>": "->", "<-": "->", "==": "=", ":=": "=", "&&": "and", "||": "or", "!": "not"}
_COMPARISONS = frozenset({"<", ">", "<=", ">=", "==", "!=", "=", "+", "-", "*", "/", "%"})
_C_TYPES = {
    "int": "i32", "unsigned": "u32", "short": "i16", "long": "i64", "char": "i8", "float": "f32", "double": "f64",
    "int8_t": "i8", "int16_t": "i16", "int32_t": "i32", "int64_t": "i64",
    "uint8_t": "u8", "uint16_t": "u16", "uint32_t": "u32", "uint64_t": "u64",
}  # fmt: skip
Tell = Callable[[Machine], Diagnostic]
_UNITS = frozenset(unit for units in UNITS.values() for unit in units)


def slip(situation: Situation) -> Repair | None:
    """The change for a known slip at the token that does not fit, if it is one and what it inserts fits."""
    for find in FINDERS:
        repair = find(situation)
        if repair is None:
            continue
        states = list(situation.states[: len(situation.states) - repair.pops])
        if all(feed(situation.table, states, kind) for kind in repair.insert):
            return repair
    return None


def _told(message: str, start: int, end: int, text: str, label: str = "", words: str = "") -> Tell:
    """A message at a place whose fix writes `text` there."""

    def tell(machine: Machine) -> Diagnostic:
        span = Span(machine.file, start, end)
        advice = words or (f"write `{text}`" if text else f"remove `{span.text}`")
        fix = Fix(advice, (Edit(span, text),), Applicability.MACHINE)
        return Diagnostic("MV001", message, Label(span, label), help=fix)

    return tell


def _count_until(situation: Situation, end: int) -> int:
    """How many tokens from the one that does not fit end before a place of the text."""
    count = 1
    while situation.token(count).kind != END and situation.token(count).end <= end:
        count += 1
    return count


def _comment(situation: Situation) -> Repair | None:
    """`# text` for `// text`."""
    token = situation.token()
    if token.text != "#":
        return None
    end = situation.text.find("\n", token.start)
    count = _count_until(situation, end if end >= 0 else len(situation.text))
    told = _told("a comment begins with `//`", token.start, token.start + 1, "//")
    return Repair(replace=count, told=told)


def _type_first(situation: Situation) -> Repair | None:
    """`int left` for `left: i32`."""
    token, before = situation.token(), situation.token(-1)
    meant = _C_TYPES.get(before.text)
    if token.kind != "NAME" or meant is None or "COLON" not in situation.row():
        return None
    told = _told("the name comes first, its type after `:`", before.start, token.end, f"{token.text}: {meant}")
    return Repair(("COLON",), told=told)


def _condition(situation: Situation) -> Repair | None:
    """`when x > 3`: a guard has no expressions."""
    token, before, after = situation.token(), situation.token(-1), situation.token(1)
    if token.text not in _COMPARISONS or not {"AND", "OR"} <= set(situation.row()) or before.kind != "NAME":
        return None
    more = after.kind in ("NAME", "NUMBER", "QUANTITY", "HEX", "EXPONENT")

    def tell(machine: Machine) -> Diagnostic:
        span = Span(machine.file, before.start, after.end if more else token.end)
        help_ = Fix(
            f"decide it in C: declare `codel NAME reads {before.text} returns bool` and write `when NAME`",
            (),
            Applicability.PLACEHOLDERS,
        )
        message = f"there is no `{token.text}` in a guard: it combines bool codels"
        return Diagnostic("MV001", message, Label(span), help=help_)

    return Repair(replace=2 if more else 1, told=tell)


def _bare_board(situation: Situation) -> Repair | None:
    """`node base on generic-arm7tdmi` for `on "generic-arm7tdmi"`."""
    name, on = situation.token(-1), situation.token(-2)
    word = re.compile(r"[A-Za-z_][A-Za-z0-9_.+-]*").match(situation.text, name.start)
    if on.text != "on" or name.kind != "NAME" or situation.symbols()[-1:] != ["NAME"]:
        return None
    if word is None or word.end() <= name.end or situation.token().start != name.end:
        return None
    meant = f'"{word[0]}"'
    told = _told("the board's name has to stand in quotes", name.start, word.end(), meant)
    return Repair(("STRING",), pops=1, replace=_count_until(situation, word.end()), text=meant, told=told)


def _semicolon(situation: Situation) -> Repair | None:
    token = situation.token()
    if token.text != ";":
        return None
    return Repair(replace=1, told=_told("a line ends without `;`", token.start, token.end, ""))


def _operator(situation: Situation) -> Repair | None:
    """`=>` for `->`, `==` for `=`, `&&` for `and`."""
    token = situation.token()
    meant = _OPERATORS.get(token.text)
    if token.kind != "OTHER" or meant is None:
        return None
    kind = situation.table.marks.get(meant) or situation.table.words[meant]
    message = f"there is no `{token.text}` in the language"
    return Repair((kind,), replace=1, told=_told(message, token.start, token.end, meant))


def _direction(situation: Situation) -> Repair | None:
    """`port in x` for `in port x`, and `port x` without a direction."""
    token, after = situation.token(), situation.token(1)
    if token.text != "port" or "IN" not in situation.row():
        return None
    if after.text in ("in", "out", "event") and situation.token(2).kind == "NAME":
        kinds = (situation.table.words[after.text], "PORT")
        meant = f"{after.text} port"
        message = "the direction comes before `port`"
        return Repair(kinds, replace=2, text=meant, told=_told(message, token.start, after.end, meant))
    if after.kind != "NAME":
        return None
    label = "`in`, `out` or `event` comes before it"
    fix = "write `in port`, `out port` or `event port`"
    message = "the port has no direction"
    return Repair(("IN",), told=_told(message, token.start, token.end, "in port", label, fix))


def _runs_in(situation: Situation) -> Repair | None:
    """`operation f() in caller` for `runs in caller`."""
    token, before = situation.token(), situation.token(-1)
    if token.text not in ("caller", "owner") or before.text != "in" or situation.symbols()[-1:] != ["IN"]:
        return None
    message = f"expected `runs` before `in {token.text}`"
    meant = f"runs in {token.text}"
    return Repair(pops=1, replace=1, told=_told(message, before.start, token.end, meant))


def _apart(situation: Situation) -> Repair | None:
    """`5 ms`, read as the attribute `5` and another one named `ms`."""
    unit, number = situation.token(-1), situation.token(-2)
    if unit.text not in _UNITS or number.kind != "NUMBER" or situation.symbols()[-1:] != ["NAME"]:
        return None
    return Repair(pops=1, told=_told_apart(number, unit))


def _told_apart(number: Token, unit: Token) -> Tell:
    return lambda machine: unit_apart(Span(machine.file, number.start, unit.end), number.text, unit.text)


def _bare_string(situation: Situation) -> Repair | None:
    """`binary robot.elf` for `binary "robot.elf"`."""
    token = situation.token()
    if "STRING" not in situation.row() or token.kind not in ("NAME", "NUMBER", "DOT"):
        return None
    word = re.compile(r"[^\s{}\"=,]+").match(situation.text, token.start)
    end = word.end() if word else token.end
    count = _count_until(situation, end)
    meant = f'"{situation.text[token.start:end]}"'
    told = _told("expected a text in quotes", token.start, end, meant)
    return Repair(("STRING",), replace=count, text=meant, told=told)


def _no_unit(situation: Situation) -> Repair | None:
    """A bare number where a quantity is expected: without a unit, or with the unit apart."""
    token, after = situation.token(), situation.token(1)
    if "QUANTITY" not in situation.row() or token.kind != "NUMBER":
        return None
    if after.kind == "NAME" and after.text in _UNITS:
        meant = token.text + after.text
        return Repair(("QUANTITY",), replace=2, text=meant, told=_told_apart(token, after))

    def tell(machine: Machine) -> Diagnostic:
        span = Span(machine.file, token.start, token.end)
        fix = Fix(f"write the unit against the number, as in `{token.text}ms`")
        return Diagnostic("MV004", f"the number `{token.text}` has no unit", Label(span, "of what?"), help=fix)

    return Repair(("QUANTITY",), replace=1, text=token.text, told=tell)


def _with_unit(situation: Situation) -> Repair | None:
    """A quantity where a bare number is expected: `size 16B`."""
    token = situation.token()
    if "NUMBER" not in situation.row() or token.kind != "QUANTITY":
        return None
    number = re.match(r"-?[0-9]+(\.[0-9]+)?", token.text)
    meant = number[0] if number else "1"
    told = _told("expected a number without a unit", token.start, token.end, meant)
    return Repair(("NUMBER",), replace=1, text=meant, told=told)


FINDERS = (
    _semicolon, _comment, _condition, _operator, _direction, _runs_in, _apart, _type_first, _bare_board, _bare_string,
    _no_unit, _with_unit,
)  # fmt: skip
"""The slips, in the order they are looked for."""
