"""Actions for binaries: symbols of codels, and flow facts."""

from __future__ import annotations

from typing import Any

from mauve.diagnostics.diagnostic import Fix
from mauve.records import changed
from mauve.syntax import ast
from mauve.syntax.build import Action, Clause, Context, check_lines, clause, only, take
from mauve.syntax.tokens import Token

LIMITS = ("max", "total")
COUNTED = (ast.LoopFactDecl, ast.RecursionFactDecl)
RANGES = ("argument", "each", "from", "any", "ends")
"""The clauses that follow what is counted, and those that follow an assumed range."""


def _binary(context: Context, children: list[Any], start: int, end: int) -> ast.BinaryDecl:
    items = [item for item in children[2:] if item is not None and type(item) is not Token]
    check_lines(context, [i for i in items if not isinstance(i, Clause)], children[1].span.end, end)
    facts = [_with_clauses(context, item, clauses) for item, clauses in _groups(context, items)]
    loops = tuple(fact for fact in facts if isinstance(fact, ast.LoopFactDecl))
    ranges = tuple(fact for fact in facts if isinstance(fact, ast.AssumedRangeDecl))
    symbols, files = only(items, ast.SymbolBinding), only(items, ast.FactsFile)
    control = only(items, ast.ControlFactDecl)
    recursions = tuple(fact for fact in facts if isinstance(fact, ast.RecursionFactDecl))
    return ast.BinaryDecl(children[1], symbols, loops, recursions, ranges, control, files, context.span(start, end))


def _groups(context: Context, items: list[Any]) -> list[tuple[Any, list[Clause]]]:
    """Each item with the clauses that follow it; a clause that follows nothing of its kind is reported."""
    groups: list[tuple[Any, list[Clause]]] = []
    for item in items:
        if not isinstance(item, Clause):
            groups.append((item, []))
            continue
        owner = groups[-1][0] if groups else None
        if isinstance(owner, COUNTED if item.word in LIMITS else ast.AssumedRangeDecl):
            groups[-1][1].append(item)
        elif item.word in LIMITS:
            context.error(f'`{item.word}` follows a loop: `loop "file.c:41" {item.word} 6`', item.span)
        else:
            context.error(f'`{item.word}` follows an assumption: `assume "length" from 0 to 64`', item.span)
    return groups


def _with_clauses(context: Context, fact: Any, clauses: list[Clause]) -> Any:
    """A fact with the clauses that belong to it."""
    span = fact.span.to(clauses[-1].span) if clauses else fact.span
    if isinstance(fact, ast.LoopFactDecl):
        maximum, total = (take(context, clauses, word) for word in LIMITS)
        if maximum is None and total is None:
            fix = Fix(f"write how often it runs: `{fact.span.text} max 10`")
            context.error("a flow fact of a loop needs `max` or `total`", fact.span, fix=fix)
        return changed(fact, maximum=maximum, total=total, span=span)
    if isinstance(fact, ast.RecursionFactDecl):
        maximum, total = (take(context, clauses, word) for word in LIMITS)
        if maximum is None or total is not None:
            fix = Fix(f"write how many activations are under way at once: `{fact.span.text} max 8`")
            context.error("a flow fact of a recursion needs `max`, and no `total`", span, fix=fix)
        return changed(fact, maximum=maximum, span=span)
    if isinstance(fact, ast.AssumedRangeDecl):
        argument, width, between, free, ends = (take(context, clauses, word) for word in RANGES)
        if sum(said is not None for said in (between, free, ends)) != 1 and context.sound(span, span):
            fix = Fix(f"write `{fact.span.text} from 0 to 64`, or `{fact.span.text} any` for what is not known")
            context.error("an assumption needs either a range or `any`, or `ends within`", fact.span, fix=fix)
        low, high = between or (None, None)
        return changed(fact, argument=argument, width=width, low=low, high=high, ends=ends, span=span)
    return fact


def _limit(context: Context, children: list[Any], start: int, end: int) -> Clause:
    number = children[1]
    if isinstance(number, Token):
        number = ast.Number(number.text, context.span(number.start, number.end))
    return Clause(children[0].text, number, context.span(start, end))


def _place(context: Context, children: list[Any], start: int, end: int) -> ast.CodePlace:
    return ast.CodePlace(children[0], children[2] if len(children) > 1 else None, context.span(start, end))


def _loop(context: Context, children: list[Any], start: int, end: int) -> ast.LoopFactDecl:
    return ast.LoopFactDecl(children[1], None, None, context.span(start, end))


def _recursion(context: Context, children: list[Any], start: int, end: int) -> ast.RecursionFactDecl:
    return ast.RecursionFactDecl(children[1], None, context.span(start, end))


def _given(context: Context, children: list[Any], start: int, end: int) -> ast.AssumedRangeDecl:
    return ast.AssumedRangeDecl(children[1], None, None, None, None, None, context.span(start, end))


def _control(context: Context, children: list[Any], start: int, end: int) -> ast.ControlFactDecl:
    place, *targets = only(children, ast.CodePlace)
    return ast.ControlFactDecl(children[0].text, place, tuple(targets), context.span(start, end))


def _from_to(context: Context, children: list[Any], start: int, end: int) -> Clause:
    return Clause("from", (children[1], children[3]), context.span(start, end))


def _any(context: Context, children: list[Any], start: int, end: int) -> Clause:
    return Clause("any", True, context.span(start, end))


def _ends(context: Context, children: list[Any], start: int, end: int) -> Clause:
    return Clause("ends", children[2], context.span(start, end))


def _binding(context: Context, children: list[Any], start: int, end: int) -> ast.SymbolBinding:
    return ast.SymbolBinding(children[0], children[2], context.span(start, end))


def _bind_path(context: Context, children: list[Any], start: int, end: int) -> ast.Path:
    return ast.Path(only(children, ast.Name), context.span(start, end))


def _facts(context: Context, children: list[Any], start: int, end: int) -> ast.FactsFile:
    return ast.FactsFile(children[1], context.span(start, end))


BINARY_ACTIONS: dict[str, Action] = {
    "binary": _binary,
    "binding": _binding,
    "bind_path": _bind_path,
    "loop": _loop,
    "limit": _limit,
    "facts": _facts,
    "place": _place,
    "recursion": _recursion,
    "given": _given,
    "targets": _control,
    "noreturn": _control,
    "argument": clause("argument"),
    "elements": clause("each"),
    "from_to": _from_to,
    "any": _any,
    "ends": _ends,
}
