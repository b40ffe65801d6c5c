"""What is wrong with a mission before any state of it is looked at: production, alternatives, objectives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.model.mission_exclusive import rivals
from mauve.model.mission_ports import check_ports
from mauve.model.mission_tree import NEVER, Dependence, blocks, closure, elementary, that_matter
from mauve.model.missions import Activity, Block, Mission, MissionPart, Parallel, Recover, Ref, Retry
from mauve.source import Span
from mauve.syntax.ast import missions as written

MOST_NAMED = 4
"""So many names are listed in a message."""


# ------------------------------------------------------------------------------------------------ declarations
def check_declarations(part: MissionPart, report: Report) -> None:
    """Resources and activities, whatever missions use them."""
    dependence = Dependence(part.hardware, part.activities)
    _check_producers(part, report)
    _check_cycles(part, dependence, report)
    for activity in part.activities:
        _check_alternatives(activity, dependence, report)
        check_ports(activity, part, report)


def _check_producers(part: MissionPart, report: Report) -> None:
    """MV702 nobody produces it, MV703 two do, MV708 hardware is produced."""
    devices = {device.name: device for device in part.hardware}
    makers: dict[str, tuple[Activity, Ref]] = {}
    for activity in part.activities:
        for name in activity.offers:
            ref = next(ref for one in activity.alternatives for ref in one.produces if ref.name == name)
            if name in devices:
                message = f"`{activity.name}` produces `{name}`, which is hardware: it is there by itself"
                labels = (Label(devices[name].span, "declared as hardware"),)
                help_ = Fix(f"declare a software resource, which `{activity.name}` produces while it runs")
                report.add(Diagnostic("MV708", message, Label(ref.span), labels=labels, help=help_))
            elif name in makers:
                first, where = makers[name]
                message = f"`{name}` is produced by `{first.name}` and by `{activity.name}`"
                labels = (Label(where.span, f"`{first.name}` produces it here"),)
                help_ = Fix("make them alternatives of one activity, or two resources")
                report.add(Diagnostic("MV703", message, Label(ref.span, "and here"), labels=labels, help=help_))
            else:
                makers[name] = activity, ref
    told = set()
    for activity in part.activities:
        for ref in (ref for one in activity.alternatives for ref in one.consumes):
            if ref.name not in devices and ref.name not in makers and ref.name not in told:
                told.add(ref.name)
                declared = next(each.span for each in part.software if each.name == ref.name)
                message = f"`{activity.name}` consumes `{ref.name}`, which no activity produces"
                labels = (Label(declared, "declared here"),)
                help_ = Fix(f"write `produces {ref.name}` in the activity that makes it")
                report.add(Diagnostic("MV702", message, Label(ref.span), labels=labels, help=help_))


def _check_cycles(part: MissionPart, dependence: Dependence, report: Report) -> None:
    """MV704: activities that wait for each other's products; a warning where some alternative avoids it."""
    producers = {name: activity for activity in reversed(part.activities) for name in activity.offers}
    done: set[str] = set()
    told: set[frozenset[str]] = set()
    for start in part.activities:
        names = [start.name]
        walk: list[Ref] = []
        pending = [_consumed(start)]
        while pending and start.name not in done:
            ref = next(pending[-1], None)
            if ref is None:
                done.add(names.pop())
                pending.pop()
                if walk:
                    walk.pop()
                continue
            maker = producers.get(ref.name)
            if maker is None or maker.name in done:
                continue
            if maker.name in names:
                at = names.index(maker.name)
                if frozenset(names[at:]) not in told:
                    told.add(frozenset(names[at:]))
                    report.add(_cycle(names[at:], [*walk[at:], ref], dependence))
                continue
            names.append(maker.name)
            walk.append(ref)
            pending.append(_consumed(maker))


def _consumed(activity: Activity) -> Iterator[Ref]:
    return (ref for one in activity.alternatives for ref in one.consumes)


def _cycle(names: list[str], walk: list[Ref], dependence: Dependence) -> Diagnostic:
    stuck = [name for name in names if dependence.activity(name) == NEVER]
    chain = ", ".join(f"`{name}` needs `{ref.name}`" for name, ref in zip(names, walk, strict=True))
    labels = tuple(Label(ref.span, f"`{name}` needs it") for name, ref in zip(names, walk, strict=True))
    if stuck:
        message = f"these activities wait for each other for ever: {chain}, which only `{names[0]}` makes"
        help_ = Fix("give one of them an alternative that does without")
        return Diagnostic("MV704", message, labels[0], labels=labels[1:], help=help_)
    message = f"these activities may wait for each other: {chain}, which `{names[0]}` makes"
    seen = "whether each can wait for the other for ever is seen in the graph (`live`, `bounded`)"
    note = f"other alternatives avoid it; {seen}"
    return Diagnostic("MV704", message, labels[0], Severity.WARNING, labels[1:], notes=(note,))


def _check_alternatives(activity: Activity, dependence: Dependence, report: Report) -> None:
    """MV707 the same conditions twice, MV706 never reached because a better one is always possible."""
    for index, one in enumerate(activity.alternatives):
        for better in activity.alternatives[:index]:
            if better.needs == one.needs and better.offers == one.offers:
                message = f"the alternatives `{better.name}` and `{one.name}` of `{activity.name}` are the same"
                labels = (Label(better.span, "tried first"),)
                note = "they consume the same resources, so the second one is never chosen"
                primary = Label(one.span, "never chosen")
                report.add(Diagnostic("MV707", message, primary, Severity.WARNING, labels, notes=(note,)))
                break
            sure = all(dependence.resource(need) == () for need in better.needs)
            if sure or better.needs <= one.needs:
                message = f"the alternative `{one.name}` of `{activity.name}` is never chosen"
                labels = (Label(better.span, f"`{better.name}` is tried first"),)
                why = f"whenever `{one.name}` is possible, `{better.name}` is, too: it needs no more"
                if sure:
                    why = f"`{better.name}` needs nothing that could fail"
                help_ = Fix("give it a larger priority, or remove it")
                primary = Label(one.span)
                report.add(Diagnostic("MV706", message, primary, Severity.WARNING, labels, "", (why,), help_))
                break


# ------------------------------------------------------------------------------------------------ missions
def check_mission(mission: Mission, report: Report) -> None:
    """What objectives of a mission need, and what their failures lead to."""
    dependence = Dependence(mission.hardware, mission.activities)
    _check_possible(mission, dependence, report)
    _check_single(mission, dependence, report)
    _check_vanishing(mission, report)
    for block in blocks(mission.root):
        if isinstance(block, Parallel):
            _check_independence(mission, block, report)
        _check_reactions(block, dependence, report)


def _check_possible(mission: Mission, dependence: Dependence, report: Report) -> None:
    """MV710: an objective needs an activity that can never run."""
    for one in {objective.name: objective for objective in elementary(mission.root)}.values():
        possible = all(dependence.activity(ref.name) != NEVER for ref in one.activities)
        clash = rivals(mission, one) if possible else None
        if clash is not None:
            message = f"the objective `{one.name}` always fails: it needs `{clash.resource}` twice"
            note = f"`{clash.first}` and `{clash.second}` both take it, and it serves one activity at a time"
            help_ = Fix(f"give one of them an alternative without `{clash.resource}`")
            report.add(Diagnostic("MV710", message, Label(one.span), notes=(note,), help=help_))
        for ref in one.activities:
            if dependence.activity(ref.name) != NEVER:
                continue
            chain, why = _impossible(mission, ref.name, dependence)
            message = f"the objective `{one.name}` always fails: `{ref.name}` can never run"
            labels = (Label(ref.span, "needed here"),)
            help_ = Fix(f"make one alternative of `{chain[-2]}` possible")
            note = f"{' -> '.join(f'`{name}`' for name in chain)}: {why}"
            report.add(Diagnostic("MV710", message, Label(one.span), labels=labels, notes=(note,), help=help_))


def _impossible(mission: Mission, name: str, dependence: Dependence) -> tuple[list[str], str]:
    """A chain of activities from one that can never run to the reason."""
    chain = [name]
    while True:
        activity = mission.activity(chain[-1])
        needs = [n for one in activity.alternatives for n in sorted(one.needs) if dependence.resource(n) == NEVER]
        need = needs[0]
        producer = mission.producer(need)
        if producer is None:
            return [*chain, need], "nobody produces it"
        if producer.name in chain:
            return [*chain, need], f"`{producer.name}`, which makes it, needs it first"
        if dependence.activity(producer.name) != NEVER:
            return [*chain, need], f"no alternative of `{producer.name}` that makes it is possible"
        chain.append(producer.name)


def _check_single(mission: Mission, dependence: Dependence, report: Report) -> None:
    """MV714: one device whose loss alone makes an objective that matters fail."""
    accepted = {ref.name for ref in mission.accepts}
    for device in mission.hardware:
        hit = dict.fromkeys(
            one.name
            for one in that_matter(mission.root)
            if any(cut == {device.name} for ref in one.activities for cut in dependence.activity(ref.name))
        )
        if not hit or device.name in accepted:
            continue
        message = f"the loss of `{device.name}` alone makes {named(list(hit))} fail (mission `{mission.name}`)"
        help_ = Fix(
            f"give what needs it an alternative without it, or write `accepts single failure of {device.name}` in the "
            "mission"
        )
        labels = (Label(mission.span, "in this mission"),)
        report.add(Diagnostic("MV714", message, Label(device.span), Severity.WARNING, labels, help=help_))


def named(names: Sequence[str]) -> str:
    """A few names in words."""
    listed = [f"`{name}`" for name in names[:MOST_NAMED]]
    if len(names) > MOST_NAMED:
        listed = [*listed[: MOST_NAMED - 1], f"{len(names) - MOST_NAMED + 1} more"]
    return listed[0] if len(listed) == 1 else f"{', '.join(listed[:-1])} and {listed[-1]}"


def _check_vanishing(mission: Mission, report: Report) -> None:
    """MV717: an activity that an objective starts stops offering, in another alternative, what somebody uses."""
    started = {ref.name: ref for one in elementary(mission.root) for ref in one.activities}
    for activity in mission.activities:
        if activity.name not in started:
            continue
        for name in activity.offers:
            users = [user.name for user in mission.activities if name in user.needs and user.name != activity.name]
            lacking = next((one for one in activity.alternatives if name not in one.offers), None)
            if not users or lacking is None:
                continue
            message = f"`{name}` vanishes from {named(users)} when `{activity.name}` runs as `{lacking.name}`"
            offering = next(ref for one in activity.alternatives for ref in one.produces if ref.name == name)
            labels = (
                Label(offering.span, "produced by another alternative"),
                Label(started[activity.name].span, f"an objective starts `{activity.name}`, whatever it offers"),
            )
            help_ = Fix(f"let every alternative produce `{name}`, or split `{activity.name}` in two activities")
            report.add(Diagnostic("MV717", message, Label(lacking.span), labels=labels, help=help_))


def _check_independence(mission: Mission, block: Parallel, report: Report) -> None:
    """MV715: an optional child does what a mandatory one requires."""
    required: dict[str, tuple[str, str]] = {}
    for child in block.children:
        if child.mandatory:
            activities = [ref.name for one in elementary(child.step.block) for ref in one.activities]
            for name, way in closure(mission, activities).items():
                required.setdefault(name, (child.step.block.name, str(way)))
    for child in block.children:
        if child.mandatory:
            continue
        for ref in (ref for one in elementary(child.step.block) for ref in one.activities):
            if ref.name not in required:
                continue
            other, chain = required[ref.name]
            name = child.step.block.name
            message = f"the optional `{name}` fails together with the mandatory `{other}`: both need `{ref.name}`"
            note = f"`{other}` requires it by {chain}"
            labels = (Label(ref.span, "needed here"),)
            primary = Label(child.step.span)
            report.add(Diagnostic("MV715", message, primary, Severity.WARNING, labels, notes=(note,)))


def _check_reactions(block: Block, dependence: Dependence, report: Report) -> None:
    """MV718 a recovery that is impossible after every loss it is meant for, MV719 a retry that cannot help."""
    steps = [c.step for c in block.children] if isinstance(block, Parallel) else getattr(block, "steps", ())
    for step in steps:
        cuts = dependence.block(step.block)
        if not cuts or cuts == NEVER:
            continue
        listed = " or ".join("{" + ", ".join(sorted(cut)) + "}" for cut in cuts[:MOST_NAMED])
        match step.on_failure:
            case Recover(recovery, _, span):
                own = dependence.block(recovery)
                if all(any(mine <= cut for mine in own) for cut in cuts):
                    name = step.block.name
                    message = f"the recovery of `{name}` is impossible after every loss that makes `{name}` fail"
                    notes = (
                        f"`{name}` fails with {listed} out of service, and the recovery needs the same",
                        "it can run only where an activity reports failure with all devices in service",
                    )
                    help_ = Fix("recover with activities that do without these devices")
                    report.add(Diagnostic("MV718", message, Label(span), Severity.WARNING, (), "", notes, help_))
            case Retry(_, span):
                if not any(dependence.recovers(cut) for cut in cuts):
                    message = f"trying `{step.block.name}` again does not bring back what it lacks"
                    note = f"it fails with {listed} out of service, and nothing of that may recover"
                    help_ = Fix("write `may recover` at the hardware where that is so, or leave `retry` out")
                    report.add(Diagnostic("MV719", message, Label(span), Severity.WARNING, (), "", (note,), help_))
            case _:
                pass


# ------------------------------------------------------------------------------------------------ unused
def check_unused(parts: Sequence[written.MissionPart], missions: Sequence[Mission], report: Report) -> None:
    """MV711: what the checked file declares and no mission reaches."""
    used = {device.name for mission in missions for device in mission.hardware}
    used |= {resource.name for mission in missions for resource in mission.software}
    used |= {activity.name for mission in missions for activity in mission.activities}
    pursued = {block.name for mission in missions for block in blocks(mission.root)}
    for part in parts:
        match part:
            case written.MissionDecl():
                continue
            case written.ObjectiveDecl():
                kind, reached = "objective", part.name.text in pursued
            case written.ActivityDecl():
                kind, reached = "activity", part.name.text in used
            case _:
                kind, reached = "resource", part.name.text in used
        if not reached:
            span: Span = part.name.span
            message = f"no mission reaches the {kind} `{part.name}`"
            report.add(Diagnostic("MV711", message, Label(span), Severity.WARNING))
