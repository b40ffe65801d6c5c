"""Actions for flows: `flow NAME: instance.port -> ... -> instance.port within 40ms`."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from mauve.diagnostics.diagnostic import Fix
from mauve.records import record
from mauve.syntax import ast
from mauve.syntax.build import Action, Clause, Context, first, only, take


@record
class _Point:
    """A point of a flow; None for `...`."""

    path: ast.Path | None


def _flow_point(context: Context, children: list[Any], start: int, end: int) -> _Point:
    return _Point(first(children, ast.Path))


def _flow(context: Context, children: list[Any], start: int, end: int) -> ast.FlowDecl:
    points = tuple(point.path for point in only(children, _Point))
    span = context.span(start, end)
    elided = [None, *points, None]
    if any(a is None and b is None for a, b in pairwise(elided)) or len(points) < 2:
        fix = Fix("write at least two points, and `...` between two of them only")
        context.error("a flow begins and ends at a port, a method or an operation", span, fix=fix)
    within = take(context, children, "within")
    quantity, latency = within if within is not None else (None, ast.Latency.BOTH)
    return ast.FlowDecl(children[1], points, quantity, latency, span, context.doc(start))


def _within(context: Context, children: list[Any], start: int, end: int) -> Clause:
    latency = first(children, ast.Latency) or ast.Latency.BOTH
    return Clause("within", (children[1], latency), context.span(start, end))


def _latency(context: Context, children: list[Any], start: int, end: int) -> ast.Latency:
    return ast.Latency(context.file.text[start:end])


FLOW_ACTIONS: dict[str, Action] = {
    "flow": _flow,
    "flow_point": _flow_point,
    "within": _within,
    "latency": _latency,
}
