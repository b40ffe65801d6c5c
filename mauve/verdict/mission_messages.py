"""What a mission's verdicts say to its author: diagnostics at the checks, with the events that show it."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.mission.contention import Contention
from mauve.mission.formula import Verdict
from mauve.mission.graph import StateView
from mauve.model.missions import Claim, Ltl, Mission
from mauve.source import Span
from mauve.verdict.missions import MissionResult

LONGEST_RUN = 30
"""So many events of a run are listed."""


def report_mission(result: MissionResult, report: Report) -> None:
    """Diagnostics of what does not hold (MV709, MV713, MV721), is undecided (MV725), or too large (MV720)."""
    if result.exceeded is not None:
        report.add(_too_large(result))
    told = set()
    for asked in result.asked:
        told.add(asked.verdict.name if isinstance(asked.written, Claim) else "")
        if asked.verdict.holds is None:
            report.add(_undecided(asked.verdict, asked.written, asked.written.span))
        elif not asked.verdict.holds:
            report.add(_fails(result, asked.verdict, asked.written))
    stuck = result.confluence is not None and (result.confluence.stuck or result.confluence.endless)
    for name in ("bounded", "deterministic", *(("live",) if stuck else ()), "success_reachable"):
        if name not in told and result.verdict(name).holds is False:
            report.add(_fails(result, result.verdict(name), None))
    success, sound = result.verdict("success_reachable"), ("bounded", "deterministic")
    if success.name not in told and success.holds is None and all(result.verdict(x).holds is not False for x in sound):
        report.add(_undecided(success, None, result.mission.span))


def _fails(result: MissionResult, verdict: Verdict, written: Claim | Ltl | None) -> Diagnostic:
    """What is said about a property that is violated."""
    mission, name = result.mission, verdict.name
    span = written.span if written is not None else mission.span
    data: tuple[tuple[str, object], ...] = (("property", name), ("witness", list(verdict.witness)))
    run = run_text(verdict.witness)
    formula = isinstance(written, Ltl)
    if name == "deterministic" and result.contentions and not formula:
        return _contention(result, span)
    if name.startswith("success_reachable") and not formula:
        plain = name == "success_reachable"
        message = f"the mission `{mission.name}` cannot succeed" + ("" if plain else " after these losses")
        note = _point_of_no_return(result) if plain else f"{run}: from then on no success is possible"
        help_ = Fix("give an activity on the way an alternative that does without, or recover from the failure")
        return Diagnostic("MV713", message, Label(span), notes=(note,) if note else (), help=help_, data=data)
    what = written.name if isinstance(written, Ltl) else name
    message = f"`{what}` does not hold for the mission `{mission.name}`"
    notes = [f"it is violated by {run}" if verdict.witness else "it is violated from the start"]
    notes += [verdict.note] if verdict.note else []
    help_ = Fix("step through these events with `mauvec mission FILE --simulate`")
    return Diagnostic("MV721", message, Label(span), notes=tuple(notes), help=help_, data=data)


def run_text(events: tuple[str, ...]) -> str:
    """Events joined by commas, long runs shortened."""
    if not events:
        return "(no event)"
    if len(events) > LONGEST_RUN:
        return ", ".join(events[:LONGEST_RUN]) + f", and {len(events) - LONGEST_RUN} more"
    return ", ".join(events)


def _point_of_no_return(result: MissionResult) -> str:
    points = result.analysis.lost.points if result.analysis else ()
    if not points:
        return ""
    if not points[0].events:
        return "no sequence of events leads to success, from the very start"
    return f"after {run_text(points[0].events)} no success is possible"


def _undecided(verdict: Verdict, written: Claim | Ltl | None, span: Span) -> Diagnostic:
    what = written.name if isinstance(written, Ltl) else verdict.name
    notes = (verdict.note,) if verdict.note else ()
    return Diagnostic("MV725", f"`{what}` could not be decided", Label(span), notes=notes)


def _too_large(result: MissionResult) -> Diagnostic:
    """MV720, with the resources and retries that multiply the states."""
    mission, exceeded = result.mission, result.exceeded
    assert exceeded is not None
    spans = {device.name: device.span for device in mission.hardware}
    most = [(name, factor) for name, factor in exceeded.factors if factor > 1000][:8]
    times = ", ".join(f"`{name}` by {factor / 1000:g}" for name, factor in most)
    message = f"the mission `{mission.name}` has more than {exceeded.budget} stable states"
    rest = len(exceeded.factors) - len(most)
    what = "resources" if all(name in spans for name, _ in most) else "resources and retries"
    note = f"these {what} multiply them: {times}" + (f", and {rest} more" if rest > 0 else "")
    labels = tuple(Label(spans[name], f"times {factor / 1000:g}") for name, factor in most[:4] if name in spans)
    local = f"each of its {len(result.local)} objectives is analysed on a graph of its own"
    less = "" if what == "resources" else "retry less often, "
    help_ = Fix(f"{less}leave out `may fail` or `may recover` where it does not matter, or make several missions")
    notes = (note, local) if result.local else (note,)
    return Diagnostic("MV720", message, Label(mission.span), Severity.WARNING, labels, "", notes, help_)


# ------------------------------------------------------------------------------------------------ contention
def _contention(result: MissionResult, span: Span) -> Diagnostic:
    """MV709: two paths to one resource, one event, two outcomes."""
    mission, verdict = result.mission, result.verdict("deterministic")
    rival = _rival(result)
    who = f"`{rival.first[-2]}` and `{rival.second[-2]}`"
    message = f"{who} compete for `{rival.resource}`, and who gets it is left to chance"
    labels = tuple(
        Label(found, f"`{chain[-2]}` takes it")
        for chain in (rival.first, rival.second)
        if (found := _taken(mission, chain)) is not None
    )
    notes = [" -> ".join(f"`{name}`" for name in chain) for chain in (rival.first, rival.second)]
    if verdict.witness:
        notes.append(f"the last event of {run_text(verdict.witness)} has two outcomes")
    fired = result.confluence.divergences if result.confluence else ()
    if fired:
        first = min(fired, key=lambda one: one.state)
        notes += [f"either {outcome_text(first.outcomes[0])}", f"or {outcome_text(first.outcomes[1])}"]
    help_ = Fix("do one after the other, or let one of them do with something else")
    if all(device.name != rival.resource for device in mission.hardware):
        help_ = Fix(f"do one after the other, or declare `{rival.resource}` as `shared` if it can serve both")
    asked = Label(span, "checked here" if span != mission.span else "in this mission")
    primary, *rest = (*labels, asked)
    return Diagnostic("MV709", message, primary, labels=tuple(rest), notes=tuple(notes), help=help_)


def _rival(result: MissionResult) -> Contention:
    """The contention that the divergence is about: its outcomes differ in what its consumers do."""
    fired = result.confluence.divergences if result.confluence else ()
    for one in fired[:1]:
        first, second = one.outcomes
        differ = {name for name, _ in set(first.running) ^ set(second.running)} | set(first.failed) ^ set(second.failed)
        for rival in result.contentions:
            if {rival.first[-2], rival.second[-2]} & differ:
                return rival
    return result.contentions[0]


def _taken(mission: Mission, chain: tuple[str, ...]) -> Span | None:
    """Where the last activity of a chain consumes its resource."""
    for activity in mission.activities:
        if activity.name == chain[-2]:
            refs = (ref for one in activity.alternatives for ref in one.consumes if ref.name == chain[-1])
            return next((ref.span for ref in refs), None)
    return None


def outcome_text(view: StateView) -> str:
    """A stable state in a few words."""
    said = [activity if one == "only" else f"{activity}.{one}" for activity, one in view.running]
    words = [f"running {', '.join(said)}" if said else "nothing runs"]
    words += [f"failed {', '.join(view.failed)}"] if view.failed else []
    words += [view.outcome] if view.outcome else []
    return "; ".join(words)
