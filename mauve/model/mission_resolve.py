"""Mission declarations -> resolved missions. The composition of the mission modules of this folder.

The missions, objectives, activities and resources of all modules are seen from everywhere.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TypeVar

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report, Severity
from mauve.model.mission_activities import Home, declared, resolve_activity, resolve_hardware, resolve_software
from mauve.model.mission_checks import check_declarations, check_mission, check_unused
from mauve.model.mission_claims import (
    Known,
    block_names,
    resolve_accepts,
    resolve_claims,
    resolve_controller,
    resolve_formulas,
)
from mauve.model.mission_objectives import Tree
from mauve.model.mission_tree import elementary
from mauve.model.missions import Activity, Mission, MissionPart
from mauve.model.missions import Sequence as Steps
from mauve.model.names import duplicate
from mauve.syntax import ast
from mauve.syntax.ast import missions as written

UNBOUND = ("MV100", "MV101", "MV103", "MV702")
"""Names that are not known: what uses them would be judged wrongly."""


def resolve_missions(
    modules: Sequence[ast.Module], home_of: Callable[[ast.Module], Home], report: Report
) -> MissionPart:
    """The missions of all modules. A mission with an error in what it uses is left out, after reporting it."""
    parts = [(part, module) for module in modules for part in module.missions]
    if not parts:
        return MissionPart()
    known = len(report.diagnostics)
    things = declared([part for part, _ in parts], report)
    homes = {id(module): home_of(module) for module in modules}
    at = {id(part): homes[id(module)] for part, module in parts}
    hardware = {name: resolve_hardware(d) for name, d in things.hardware.items()}
    software = {name: resolve_software(d, at[id(d)], report) for name, d in things.software.items()}
    activities = {name: resolve_activity(d, things, at[id(d)], report) for name, d in things.activities.items()}
    _note_untied(activities.values(), homes.values(), report)
    part = MissionPart(tuple(hardware.values()), tuple(software.values()), tuple(activities.values()))
    bound = not any(d.code in UNBOUND for d in report.diagnostics[known:])
    if bound:
        check_declarations(part, report)
    objectives = _first_of_each([p for p, _ in parts if isinstance(p, written.ObjectiveDecl)], "objective", report)
    tree = Tree(objectives, {name: activity.span for name, activity in activities.items()}, report)
    missions = []
    declarations = [p for p, _ in parts if isinstance(p, written.MissionDecl)]
    for name, decl in _first_of_each(declarations, "mission", report).items():
        if decl.steps is None:
            report.add(Diagnostic("MV710", f"the mission `{name}` has no step", Label(decl.name.span)))
            continue
        root = tree.root(name, decl.steps, decl.name.span) if tree.check(decl.steps) else None
        if root is not None:
            missions.append(_mission(decl, root, part, at[id(decl)], report))
    for mission in missions if bound else ():
        check_mission(mission, report)
    if missions and len(missions) == len(declarations):
        own = {id(part) for part in modules[0].missions}
        check_unused([p for p, _ in parts if id(p) in own], missions, report)
    return MissionPart(part.hardware, part.software, part.activities, tuple(missions))


def _note_untied(activities: Iterable[Activity], homes: Iterable[Home], report: Report) -> None:
    """MV722, once: without components, `runs` is a note for the reader."""
    first = next((activity.runs for activity in activities if activity.runs is not None), None)
    if first is not None and not any(home.tied for home in homes):
        message = f"nothing in this model says what `{first.name}` is: `runs` and `mode` are not checked"
        report.add(Diagnostic("MV722", message, Label(first.span), Severity.NOTE))


def _mission(decl: written.MissionDecl, root: Steps, part: MissionPart, home: Home, report: Report) -> Mission:
    """A mission with what it uses: activities of its objectives, producers of what these consume, and so on."""
    producers = {name: activity for activity in reversed(part.activities) for name in activity.offers}
    by_name = {activity.name: activity for activity in part.activities}
    used: set[str] = set()
    open_ = [ref.name for one in elementary(root) for ref in one.activities]
    while open_:
        name = open_.pop()
        if name in used:
            continue
        used.add(name)
        open_ += [producers[need].name for need in by_name[name].needs if need in producers]
    activities = tuple(activity for activity in part.activities if activity.name in used)
    names = {name for activity in activities for name in (*activity.needs, *activity.offers)}
    hardware = tuple(each for each in part.hardware if each.name in names)
    software = tuple(each for each in part.software if each.name in names)
    others = tuple(activity for activity in part.activities if activity.name not in used)
    known = Known({a.name: a for a in activities}, {h.name: h for h in hardware}, block_names(root))
    return Mission(
        decl.name.text, root, activities, software, hardware, resolve_claims(decl, known, report),
        resolve_formulas(decl, known, report), decl.report_cuts, resolve_controller(decl, home, report),
        resolve_accepts(decl, known, report), decl.name.span, others,
    )  # fmt: skip


D = TypeVar("D", written.ObjectiveDecl, written.MissionDecl)


def _first_of_each(declarations: Iterable[D], what: str, report: Report) -> dict[str, D]:
    found: dict[str, D] = {}
    for declaration in declarations:
        name = declaration.name
        if name.text in found:
            report.add(duplicate(what, name, found[name.text].name.span))
        found.setdefault(name.text, declaration)
    return found
