"""The modes of a mission in the report of a deployment: how many sets of tasks were checked, and the reactions."""

from __future__ import annotations

from collections.abc import Iterator

from mauve.diagnostics.style import Role, Style
from mauve.report.table import Align, Cell, Column, Row, format_table
from mauve.units import format_time
from mauve.verdict.modes import Leg, ModesResult, Reaction

REACTIONS = (
    Column("event", elastic=True),
    Column("noticed by", elastic=True),
    Column("controller", Align.RIGHT),
    Column("last to switch", elastic=True),
    Column("reaction", Align.RIGHT),
)


def mode_lines(result: ModesResult, style: Style, limit: int | None) -> Iterator[str]:
    """What is said of a mission's modes below the components of a deployment."""
    name = result.mission.name
    sets = f"{result.modes} modes with {_sets(result.mode_sets)}, {result.switches} switches with {result.switch_sets}"
    yield style.paint(Role.MESSAGE, f"  modes of the mission {name}") + f": {sets}"
    if result.failing:
        switches = sum(one.switch for one in result.failing)
        counts = f"{len(result.failing) - switches} of the sets of modes and {switches} of those of switches"
        yield "  " + style.paint(Role.ERROR, f"a deadline is missed in {counts}")
    else:
        text = "every deadline holds in each mode, and in each switch with old and new tasks together"
        yield "  " + style.paint(Role.HELP, text)
    if result.reactions:
        yield from format_table(REACTIONS, [_reaction(one) for one in result.reactions], style, limit=limit)
    elif result.mission.controller is None:
        yield "  no bound on reactions: the mission generates no controller"
    else:
        yield "  no bound on reactions: the controller has no task"


def _sets(count: int) -> str:
    return f"{count} set{'' if count == 1 else 's'} of tasks"


def _reaction(one: Reaction) -> Row:
    bound = Cell(format_time(one.bound)) if one.bound is not None else Cell("no bound", Role.ERROR)
    noticed = _leg(one.detector) if one.detector else "(outside)"
    controller = format_time(one.controller.time) if one.controller else ""
    return (one.event, noticed, controller, _leg(one.switched) if one.switched else one.unbounded, bound)


def _leg(leg: Leg) -> str:
    return f"{leg.task} {format_time(leg.wait)} + {format_time(leg.response)}"
