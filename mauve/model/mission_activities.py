"""Resources and activities of missions: names bound, alternatives in order, types and components found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.missions import Activity, Alternative, Hardware, Mode, Ref, Runs, Software
from mauve.model.model import Architecture, Component
from mauve.model.names import Scope, duplicate, unknown
from mauve.model.types import BUILT_IN, Type
from mauve.model.typing import TypeTable
from mauve.records import record
from mauve.source import Span
from mauve.syntax import ast
from mauve.syntax.ast import missions as written


@record
class Home:
    """What one module sees of the rest of the model: its scope and types, and the components and architectures of
    all modules. `tied` says that there is an architecture part at all."""

    scope: Scope
    types: TypeTable
    components: Mapping[int, Component]
    architectures: Sequence[Architecture]
    tied: bool


@record
class Things:
    """The declared resources and activities of all modules by name: one space of names."""

    hardware: Mapping[str, written.HardwareDecl]
    software: Mapping[str, written.ResourceDecl]
    activities: Mapping[str, written.ActivityDecl]

    def resources(self) -> dict[str, Span]:
        """The names of all resources and where they are declared."""
        spans = {name: hardware.name.span for name, hardware in self.hardware.items()}
        return spans | {name: software.name.span for name, software in self.software.items()}


def declared(parts: Sequence[written.MissionPart], report: Report) -> Things:
    """The first declaration of each name; others are MV103."""
    seen: dict[str, Span] = {}
    things = Things({}, {}, {})
    for part in parts:
        if isinstance(part, (written.ObjectiveDecl, written.MissionDecl)):
            continue
        if part.name.text in seen:
            report.add(duplicate("resources or activitie", part.name, seen[part.name.text]))
            continue
        seen[part.name.text] = part.name.span
        table: dict[str, object]
        match part:
            case written.HardwareDecl():
                table = things.hardware  # type: ignore[assignment]
            case written.ResourceDecl():
                table = things.software  # type: ignore[assignment]
            case written.ActivityDecl():
                table = things.activities  # type: ignore[assignment]
        table[part.name.text] = part
    return things


def resolve_hardware(decl: written.HardwareDecl) -> Hardware:
    """A device."""
    return Hardware(decl.name.text, decl.may_fail, decl.may_recover, decl.name.span)


def resolve_software(decl: written.ResourceDecl, home: Home, report: Report) -> Software:
    """A software resource. In a file without components its type is a word for the reader."""
    name, type_ = decl.name, None
    if decl.may is not None:
        message = f"`{name}` is software: it is lost with the activity that produces it, and not by itself"
        help_ = Fix("declare it as `hardware`, or write `may fail` at the hardware that its producer consumes")
        report.add(Diagnostic("MV708", message, Label(decl.may), labels=(Label(name.span),), help=help_))
    if decl.type is not None:
        type_ = _type(decl.type, home)
    shared = written.Sharing.SHARED in decl.sharing
    return Software(name.text, type_, shared, written.Sharing.SINK in decl.sharing, name.span)


def _type(ref: ast.TypeRef, home: Home) -> Type | None:
    known = str(ref.path) in BUILT_IN or home.scope.find(ref.path, (ast.StructDecl, ast.EnumDecl)) is not None
    return home.types.resolve(ref) if known or home.tied else None


# ------------------------------------------------------------------------------------------------ activities
def resolve_activity(decl: written.ActivityDecl, things: Things, home: Home, report: Report) -> Activity:
    """An activity with its alternatives in falling priority; what is in error is reported and left out."""
    consumes, produces = (_refs(names, things, report) for names in (decl.consumes, decl.produces))
    runs = _runs(decl, home, report)
    component = runs.component if runs else None
    alternatives = []
    for each in _by_priority(decl, report):
        mode = _mode(each.mode or decl.mode, component, report)
        own = _refs(each.consumes, things, report), _refs(each.produces, things, report)
        both = _once((*consumes, *own[0])), _once((*produces, *own[1]))
        alternatives.append(Alternative(each.name.text, *both, mode, each.name.span))
    if not alternatives:
        mode = _mode(decl.mode, component, report)
        alternatives = [Alternative("", _once(consumes), _once(produces), mode, decl.name.span)]
    return Activity(decl.name.text, tuple(alternatives), bool(decl.upgrade), runs, decl.name.span)


def _once(refs: Sequence[Ref]) -> tuple[Ref, ...]:
    """Each name once, at its first place."""
    return tuple({ref.name: ref for ref in reversed(refs)}[name] for name in dict.fromkeys(ref.name for ref in refs))


def _refs(names: Sequence[ast.Name], things: Things, report: Report) -> tuple[Ref, ...]:
    known = things.resources()
    found = []
    for name in names:
        if name.text in known:
            found.append(Ref(name.text, name.span))
            continue
        message = f"there is no resource `{name}`"
        if name.text in things.activities:
            message = f"`{name}` is an activity, not a resource"
        report.add(unknown("MV702", message, "not declared", name.span, known, "a resource"))
    return tuple(found)


def _by_priority(decl: written.ActivityDecl, report: Report) -> list[written.AlternativeDecl]:
    """The alternatives, the most urgent first; those without a priority come last, in the order written."""
    names: dict[str, Span] = {}
    ranks: dict[int, written.AlternativeDecl] = {}
    ranked: list[tuple[int, written.AlternativeDecl]] = []
    rest: list[written.AlternativeDecl] = []
    for each in decl.alternatives:
        if each.name.text in names:
            report.add(duplicate("alternative", each.name, names[each.name.text]))
            continue
        names[each.name.text] = each.name.span
        if each.priority is None:
            rest.append(each)
            continue
        if not each.priority.is_integer:
            message = f"`{each.priority.text}` is no priority"
            report.add(Diagnostic("MV401", message, Label(each.priority.span, "a whole number is expected")))
            rest.append(each)
            continue
        rank = each.priority.integer
        if rank in ranks:
            message = f"two alternatives of `{decl.name}` have the priority {rank}: none is tried first"
            labels = (Label(ranks[rank].span, f"`{ranks[rank].name}` has it, too"),)
            help_ = Fix("give each alternative a priority of its own; the largest is tried first")
            report.add(Diagnostic("MV705", message, Label(each.priority.span), labels=labels, help=help_))
        ranks.setdefault(rank, each)
        ranked.append((rank, each))
    return [each for _, each in sorted(ranked, key=lambda pair: -pair[0])] + rest


# ------------------------------------------------------------------------------------------------ components
def _runs(decl: written.ActivityDecl, home: Home, report: Report) -> Runs | None:
    """The component that carries an activity out, by its name or by that of an instance."""
    if decl.runs is None:
        modes = [m for m in (decl.mode, *(each.mode for each in decl.alternatives)) if m is not None and m.state]
        for mode in modes[:1]:
            message = f"`mode {mode.name}` is a state of no component: `{decl.name}` does not say what it runs"
            help_ = Fix(f"write `runs COMPONENT` in `{decl.name}`")
            report.add(Diagnostic("MV716", message, Label(mode.span), help=help_))
        return None
    path, text = decl.runs, str(decl.runs)
    found = home.scope.find(path, (ast.ComponentDecl,))
    if found is not None:
        return Runs(text, home.components.get(id(found)), "", path.span)
    instances = {i.name: i for architecture in home.architectures for i in architecture.instances}
    if text in instances:
        return Runs(text, instances[text].component, text, path.span)
    if not home.tied:
        return Runs(text, None, "", path.span)
    known = {n: d.name.span for n, d in home.scope.of_kind((ast.ComponentDecl,)).items()}
    known |= {name: instance.span for name, instance in instances.items()}
    message = f"there is no component or instance `{text}`"
    report.add(unknown("MV101", message, home.scope.where(), path.span, known, "a component or instance"))
    return Runs(text, None, "", path.span)


def _mode(decl: written.ModeDecl | None, component: Component | None, report: Report) -> Mode | None:
    """The mode, its state looked up in the component's behaviour (MV303)."""
    if decl is None:
        return None
    if decl.state is None or component is None:
        return Mode(decl.name.text, (), "", decl.span)
    *path, state = (part.text for part in decl.state.parts)
    places = [place for place in _states(component) if place[1] == state]
    found = [place for place in places if not path or list(place[0][-len(path) :]) == path]
    if not found:
        known = {name: span for _, name, span in _states(component)}
        message = f"`{component.name}` has no state `{decl.state}`"
        report.add(unknown("MV303", message, "unknown", decl.state.span, known, "a state"))
        return Mode(decl.name.text, (), "", decl.span)
    if len(found) > 1:
        ways = ", ".join(f"`{'.'.join((*region, name))}`" for region, name, _ in found)
        message = f"`{component.name}` has several states `{decl.state}`"
        help_ = Fix(f"name its region: {ways}")
        report.add(Diagnostic("MV303", message, Label(decl.state.span), help=help_))
    region, name, _ = found[0]
    return Mode(decl.name.text, region, name, decl.span)


def _states(component: Component) -> list[tuple[tuple[str, ...], str, Span]]:
    """All states with the path of their regions."""
    found: list[tuple[tuple[str, ...], str, Span]] = []
    open_ = [((region.name,) if region.name else (), region) for region in component.regions]
    while open_:
        path, region = open_.pop(0)
        for state in region.states:
            found.append((path, state.name, state.span))
            open_ += [((*path, nested.name) if nested.name else path, nested) for nested in state.regions]
    return found
