"""Actions for missions: resources, activities, objectives, checks."""

from __future__ import annotations

from typing import Any

from mauve.diagnostics.diagnostic import Applicability, Diagnostic, Edit, Fix, Label
from mauve.records import record
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.ast import missions as m
from mauve.syntax.build import Action, Clause, Context, all_of, as_name, check_lines, clause, first, has, only, take
from mauve.syntax.build_systems import once_each
from mauve.syntax.tokens import Token


def _items(context: Context, children: list[Any], end: int) -> list[Any]:
    """What stands between the braces, checked to stand on lines of their own."""
    opening = next(i for i, child in enumerate(children) if has([child], "LBRACE"))
    items = [child for child in children[opening + 1 : -1] if child is not None]
    check_lines(context, items, children[opening].start, end)
    return items


def _all_names(items: list[Any], word: str) -> tuple[ast.Name, ...]:
    """The names of all clauses of one kind, which may be given several times."""
    return tuple(name for each in all_of(items, word) for name in each.value)


# ------------------------------------------------------------------------------------------------ resources
def _may(context: Context, children: list[Any], start: int, end: int) -> Clause:
    return Clause(f"may {children[-1].kind.lower()}", True, context.span(children[-2].start, end))


def _hardware(context: Context, children: list[Any], start: int, end: int) -> m.HardwareDecl:
    name: ast.Name = children[1]
    fails, recovers = (bool(take(context, children, word)) for word in ("may fail", "may recover"))
    if recovers and not fails:
        span = next(c.span for c in only(children, Clause))
        fix = Fix("write `may fail, may recover`", (Edit(span, "may fail, may recover"),), Applicability.MAYBE)
        context.error(f"`{name}` may recover, but never fails", span, fix=fix)
    span = context.span(start, end)
    return m.HardwareDecl(name, first(children, ast.TypeRef), fails, recovers, span, context.doc(start))


def _sharing(context: Context, children: list[Any], start: int, end: int) -> m.Sharing:
    return m.Sharing(children[0].kind.lower())


def _resource(context: Context, children: list[Any], start: int, end: int) -> m.ResourceDecl:
    sharing = only(children, m.Sharing)
    if len(set(sharing)) < len(sharing) or {m.Sharing.SHARED, m.Sharing.EXCLUSIVE} <= set(sharing):
        context.error("a resource is either `exclusive` or `shared`", context.span(start, end))
    span = context.span(start, end)
    may = next((each.span for each in only(children, Clause)), None)
    return m.ResourceDecl(children[1], first(children, ast.TypeRef), sharing, may, span, context.doc(start))


# ------------------------------------------------------------------------------------------------ activities
def _mode(context: Context, children: list[Any], start: int, end: int) -> Clause:
    span = context.span(start, end)
    return Clause("mode", m.ModeDecl(children[1], first(children, ast.Path), span), span)


def _rank(context: Context, children: list[Any], start: int, end: int) -> Clause:
    word: ast.Name = children[0]
    if word.text != "priority":
        fix = Fix(f"write `priority {children[1].text}`", (Edit(word.span, "priority"),), Applicability.MAYBE)
        context.error(f"an alternative has no `{word}`", word.span, "it has a `priority`", fix)
    return Clause("priority", children[1], context.span(start, end))


def _on_recovery(context: Context, children: list[Any], start: int, end: int) -> Clause:
    return Clause("on recovery", children[2].kind == "UPGRADE", context.span(start, end))


def _alternative(context: Context, children: list[Any], start: int, end: int) -> m.AlternativeDecl:
    items = _items(context, children, end)
    return m.AlternativeDecl(
        children[1],
        take(context, children, "priority"),
        _all_names(items, "consumes"),
        _all_names(items, "produces"),
        take(context, items, "mode"),
        context.span(start, end),
        context.doc(start),
    )


def _activity(context: Context, children: list[Any], start: int, end: int) -> m.ActivityDecl:
    items = _items(context, children, end)
    return m.ActivityDecl(
        children[1],
        _all_names(items, "consumes"),
        _all_names(items, "produces"),
        take(context, items, "runs"),
        take(context, items, "mode"),
        only(items, m.AlternativeDecl),
        take(context, items, "on recovery"),
        context.span(start, end),
        context.doc(start),
    )


# ------------------------------------------------------------------------------------------------ objectives
def _does(context: Context, children: list[Any], start: int, end: int) -> m.DoesDecl:
    return m.DoesDecl(children[1], take(context, children, "timeout"), context.span(start, end))


def _sequence(context: Context, children: list[Any], start: int, end: int) -> m.SequenceDecl:
    return m.SequenceDecl(only(children, m.StageDecl), context.span(start, end))


def _stage_name(context: Context, children: list[Any], start: int, end: int) -> m.UseDecl:
    return m.UseDecl(as_name(context, children[0]), context.span(start, end))


def _stage(context: Context, children: list[Any], start: int, end: int) -> m.StageDecl:
    reaction = children[1] if len(children) > 1 else None
    return m.StageDecl(children[0], reaction, context.span(start, end))


def _parallel(context: Context, children: list[Any], start: int, end: int) -> m.ParallelDecl:
    span = context.span(start, end)
    return m.ParallelDecl(first(children, ast.Name), only(_items(context, children, end), m.ChildDecl), span)


def _child(context: Context, children: list[Any], start: int, end: int) -> m.ChildDecl:
    return m.ChildDecl(children[0].kind == "MANDATORY", children[1], context.span(start, end))


def _on_failure(context: Context, children: list[Any], start: int, end: int) -> m.OnFailureDecl:
    reaction: m.OnFailureDecl = children[2]
    return reaction


def _reaction(context: Context, children: list[Any], start: int, end: int) -> m.OnFailureDecl:
    (child,) = children
    if type(child) is not Token:
        reaction: m.OnFailureDecl = child
        return reaction
    span = context.span(start, end)
    return m.AbortDecl(span) if child.kind == "ABORT" else m.ContinueDecl(span)


def _retry(context: Context, children: list[Any], start: int, end: int) -> m.RetryDecl:
    return m.RetryDecl(children[1], context.span(start, end))


def _recover(context: Context, children: list[Any], start: int, end: int) -> m.RecoverDecl:
    return m.RecoverDecl(children[2], has(children, "CONTINUE"), context.span(start, end))


def _objective(context: Context, children: list[Any], start: int, end: int) -> m.ObjectiveDecl:
    body = next((c for c in children if isinstance(c, (m.DoesDecl, m.SequenceDecl))), None)
    return m.ObjectiveDecl(children[1], body, context.span(start, end), context.doc(start))


# ------------------------------------------------------------------------------------------------ missions
@record
class _Check:
    """The claims of one `check`, or its formula."""

    claims: tuple[m.ClaimDecl | m.LtlDecl, ...]
    span: Span


def _claim(context: Context, children: list[Any], start: int, end: int) -> m.ClaimDecl:
    if isinstance(children[0], m.ClaimDecl):
        return children[0]
    return m.ClaimDecl(m.ClaimKind(children[0].kind.lower()), None, context.span(start, end))


def _reachable(context: Context, children: list[Any], start: int, end: int) -> m.ClaimDecl:
    return m.ClaimDecl(m.ClaimKind.SUCCESS_REACHABLE, first(children, m.LossDecl), context.span(start, end))


def _loss(context: Context, children: list[Any], start: int, end: int) -> m.LossDecl:
    return m.LossDecl(children[3], take(context, children, "of") or (), context.span(start, end))


DEEPEST_FORMULA = 100
"""Operators nested deeper than this in one formula are refused, so that no later pass runs out of stack."""


def _depth(formula: m.FormulaDecl) -> int:
    """How deeply operators nest, without recursion."""
    deepest, stack = 0, [(formula, 0)]
    while stack:
        node, depth = stack.pop()
        deepest = max(deepest, depth)
        match node:
            case m.FormulaPrefix(_, operand):
                stack.append((operand, depth + 1))
            case m.FormulaInfix(_, left, right):
                stack += [(left, depth + 1), (right, depth + 1)]
            case _:
                pass
    return deepest


def _check(context: Context, children: list[Any], start: int, end: int) -> _Check:
    span = context.span(start, end)
    if not has(children[:2], "LTL"):
        return _Check(only(children, m.ClaimDecl), span)
    formula: m.FormulaDecl | None = children[4]
    if formula is not None and _depth(formula) > DEEPEST_FORMULA:
        message = f"this formula nests more than {DEEPEST_FORMULA} operators"
        context.report.add(Diagnostic("MV008", message, Label(formula.span, "split it into several checks")))
        formula = None
    return _Check((m.LtlDecl(children[2], formula, span),), span)


def _flag(context: Context, children: list[Any], start: int, end: int) -> Clause:
    span = context.span(start, end)
    return Clause("report cuts", span, span)


def _generate(context: Context, children: list[Any], start: int, end: int) -> m.ControllerDecl:
    attributes = only(children, ast.ExecutionAttribute)
    once_each(context, attributes)
    runs, wcet = take(context, children, "runs"), take(context, children, "wcet")
    return m.ControllerDecl(runs, attributes, wcet, context.span(start, end))


def _accepts(context: Context, children: list[Any], start: int, end: int) -> m.AcceptsDecl:
    return m.AcceptsDecl(children[4], context.span(start, end))


def _mission(context: Context, children: list[Any], start: int, end: int) -> m.MissionDecl:
    stages = only(children, m.StageDecl)
    items = [c for c in children if isinstance(c, (_Check, Clause, m.ControllerDecl, m.AcceptsDecl))]
    opening = next(child for child in children if has([child], "LBRACE"))
    check_lines(context, [*stages[-1:], *items], opening.start, end)
    controllers = only(items, m.ControllerDecl)
    for extra in controllers[1:]:
        labels = (Label(controllers[0].span, "first here"),)
        message = "`generate controller` is given twice"
        context.report.add(Diagnostic("MV001", message, Label(extra.span, "and here"), labels=labels))
    claims = [claim for item in only(items, _Check) for claim in item.claims]
    return m.MissionDecl(
        children[1],
        m.SequenceDecl(stages, stages[0].span.to(stages[-1].span)) if stages else None,
        only(claims, m.ClaimDecl),
        only(claims, m.LtlDecl),
        next((c.span for c in items if isinstance(c, Clause)), None),
        controllers[0] if controllers else None,
        only(items, m.AcceptsDecl),
        context.span(start, end),
        context.doc(start),
    )


# ------------------------------------------------------------------------------------------------ formulas
def _infix(context: Context, children: list[Any], start: int, end: int) -> m.FormulaDecl:
    if len(children) == 1:
        formula: m.FormulaDecl = children[0]
        return formula
    left, operator, right = children
    return m.FormulaInfix(m.Infix(operator.kind.lower()), left, right, context.span(start, end))


def _prefix(context: Context, children: list[Any], start: int, end: int) -> m.FormulaDecl:
    if len(children) == 1:
        formula: m.FormulaDecl = children[0]
        return formula
    return m.FormulaPrefix(m.Prefix(children[0].kind.lower()), children[1], context.span(start, end))


def _atom(context: Context, children: list[Any], start: int, end: int) -> m.FormulaDecl:
    formula: m.FormulaDecl = children[0] if len(children) == 1 else children[1]
    return formula


def _formula_word(context: Context, children: list[Any], start: int, end: int) -> m.FormulaDecl:
    return m.FormulaAtom(m.AtomKind(children[0].kind.lower()), None, context.span(start, end))


def _formula_of(context: Context, children: list[Any], start: int, end: int) -> m.FormulaDecl:
    return m.FormulaAtom(m.AtomKind(children[0].kind.lower()), children[2], context.span(start, end))


MISSION_ACTIONS: dict[str, Action] = {
    "hardware": _hardware,
    "may": _may,
    "resource": _resource,
    "sharing": _sharing,
    "mission_activity": _activity,
    "consumes": clause("consumes"),
    "produces": clause("produces"),
    "runs_component": clause("runs"),
    "mode": _mode,
    "alternative": _alternative,
    "rank": _rank,
    "on_recovery": _on_recovery,
    "objective": _objective,
    "does": _does,
    "timeout": clause("timeout"),
    "sequence": _sequence,
    "stage": _stage,
    "stage_name": _stage_name,
    "parallel": _parallel,
    "child": _child,
    "on_failure": _on_failure,
    "reaction": _reaction,
    "retry": _retry,
    "recover": _recover,
    "mission": _mission,
    "check": _check,
    "claim": _claim,
    "reachable": _reachable,
    "loss": _loss,
    "loss_of": clause("of"),
    "report": _flag,
    "generate": _generate,
    "accepts": _accepts,
    "formula": _infix,
    "formula_or": _infix,
    "formula_and": _infix,
    "formula_until": _infix,
    "formula_prefix": _prefix,
    "formula_atom": _atom,
    "formula_word": _formula_word,
    "formula_of": _formula_of,
}
