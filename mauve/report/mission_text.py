"""A mission's verdicts as text: sizes, properties with the events that show them, cuts, where success is lost."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mauve.diagnostics.style import Role, Style
from mauve.mission.formula import Verdict
from mauve.mission.graph import BudgetExceeded
from mauve.report.check_text import grouped
from mauve.report.table import Cell, Column, Row, format_table
from mauve.verdict.mission_messages import run_text
from mauve.verdict.missions import MissionResult

PROPERTIES = (Column("property", elastic=True), Column("verdict"), Column("", elastic=True))
CUTS = (Column("objective", elastic=True), Column("fails without", elastic=True))

MOST_POINTS = 3
"""So many ways to lose success are shown."""

MOST_NAMES = 12
"""So many names are listed of what never happens."""


def format_missions(results: Sequence[MissionResult], style: Style, limit: int | None = None) -> str:
    """A section per mission; `limit` is the width that tables keep to."""
    lines: list[str] = []
    for result in results:
        lines += [*_mission(result, style, limit), ""]
    return "".join(line + "\n" for line in lines[:-1])


def _mission(result: MissionResult, style: Style, limit: int | None) -> Iterator[str]:
    yield style.paint(Role.MESSAGE, f"mission {result.mission.name}")
    yield ""
    yield from _sizes(result)
    yield ""
    rows = [_property(verdict, result) for verdict in result.verdicts]
    yield from format_table(PROPERTIES, rows, style, limit=limit)
    yield ""
    yield from _cuts(result, style, limit)
    yield from _lost(result)
    yield from _never(result)
    yield ""
    role = Role.HELP if result.holds else Role.ERROR
    yield f"  {style.paint(role, f'mission {result.mission.name} {result.answer}')} ({result.seconds:.2f} s)"


def _sizes(result: MissionResult) -> Iterator[str]:
    net = result.net
    yield f"  net                 {grouped(len(net.places))} places, {grouped(len(net.transitions))} transitions"
    if result.graph is not None:
        graph = result.graph
        sizes = f"{grouped(len(graph.markings))} stable states, {grouped(len(graph.events))} transitions"
        yield f"  alternatives graph  {sizes}; {grouped(len(graph.rules))} rules of the controller"
    elif result.exceeded is not None:
        yield f"  alternatives graph  more than {grouped(result.exceeded.budget)} stable states: not built"
        states = sum(len(one.graph.markings) for one in result.local)
        edges = sum(len(one.graph.events) for one in result.local)
        sizes = f"{grouped(states)} stable states, {grouped(edges)} transitions in all"
        yield f"  local graphs        {len(result.local)} objectives; {sizes}"
    match result.markings:
        case BudgetExceeded(budget, _):
            yield f"  markings graph      more than {grouped(budget)} states"
        case None:
            pass
        case found:
            yield f"  markings graph      {grouped(found.states)} states, {grouped(found.edges)} transitions"


def _property(verdict: Verdict, result: MissionResult) -> Row:
    match verdict.holds:
        case True:
            cell = Cell("holds", Role.HELP)
        case False:
            cell = Cell("fails", Role.ERROR)
        case None:
            cell = Cell("undecided", Role.WARNING)
    return (verdict.name, cell, _shown(verdict, result))


def _shown(verdict: Verdict, result: MissionResult) -> str:
    """What shows it: the events, the note, or how far confluence was followed."""
    words = [run_text(verdict.witness)] if verdict.witness else []
    words += [verdict.note] if verdict.note else []
    if verdict.name == "deterministic" and verdict.holds and result.confluence is not None and not words:
        words = [f"all orders of {grouped(result.confluence.cascades)} cascades followed"]
    return ": ".join(words)


def _cuts(result: MissionResult, style: Style, limit: int | None) -> Iterator[str]:
    rows: list[Row] = [(f"mission {result.mission.name}", sets_text(result.cuts))]
    objectives = result.analysis.objectives if result.analysis else ()
    locals_ = [cuts for one in result.local for cuts in one.analysis.objectives]
    grouped_: dict[str, list[str]] = {}
    for cuts in (*objectives, *locals_):
        grouped_.setdefault(sets_text(cuts.cuts), []).append(cuts.path)
    for text, paths in grouped_.items():
        rows += [(path, text) for path in paths]
    yield "  cuts: the smallest sets of devices whose loss forces failure"
    yield from format_table(CUTS, rows, style, "    ", limit=limit)


def sets_text(sets: Sequence[Sequence[str]]) -> str:
    """Sets of names: `{A} or {B, C}`; a dash for none."""
    if not sets:
        return "-"
    if () in sets:
        return "(fails with all devices in service)"
    return " or ".join("{" + ", ".join(one) + "}" for one in sets)


def _lost(result: MissionResult) -> Iterator[str]:
    lost = result.analysis.lost if result.analysis else None
    if lost is None:
        return
    yield ""
    if not lost.states:
        yield "  success stays possible until failure is declared"
        return
    states = grouped(len(lost.states))
    yield f"  success is lost, but failure not yet declared, in {states} states; the shortest ways there:"
    for point in lost.points[:MOST_POINTS]:
        yield f"    {run_text(point.events)}"


def _never(result: MissionResult) -> Iterator[str]:
    never = result.analysis.never if result.analysis else None
    if never is None or not (never.events or never.transitions):
        return
    yield ""
    for what, names in (("events that never happen", never.events), ("ways that are never taken", never.transitions)):
        if names:
            more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
            yield f"  {what}: {', '.join(names[:MOST_NAMES])}{more}"
