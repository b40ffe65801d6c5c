"""A mission in the report of a check: a line of sizes, a line of properties."""

from __future__ import annotations

from collections.abc import Iterator

from mauve.diagnostics.style import Role, Style
from mauve.report.check_text import grouped
from mauve.report.mission_text import sets_text
from mauve.verdict.missions import MissionResult


def mission_lines(result: MissionResult, style: Style, limit: int | None) -> Iterator[str]:
    """What a check says of a mission; `mauvec mission` tells more."""
    name = result.mission.name
    yield style.paint(Role.MESSAGE, f"mission {name}")
    if result.graph is not None:
        yield f"  {grouped(len(result.graph.markings))} stable states, {grouped(len(result.graph.events))} transitions"
    elif result.exceeded is not None:
        yield f"  too many states for one graph; {len(result.local)} objectives on graphs of their own"
    else:
        yield "  no graph: the mission is not sound"
    words = {True: "holds", False: "fails", None: "undecided"}
    yield "  " + "; ".join(f"{verdict.name} {words[verdict.holds]}" for verdict in result.verdicts)
    if not result.cuts:
        yield "  no loss of devices forces failure"
    else:
        cannot = "cannot succeed, whatever is in service" if () in result.cuts else ""
        yield f"  {cannot or f'fails without {sets_text(result.cuts)}'}"
    role = Role.HELP if result.holds else Role.ERROR
    yield f"  {style.paint(role, f'mission {name} {result.answer}')}"
