"""Stepping a mission by hand or by script: events in, what changed out.

The engine is pure: a session is a net and a marking, a step makes a new one. It works on the net, so that it needs no
alternatives graph, and missions of any size can be stepped. Words of a script are names of events (`Diving_EV_OK`), or
short forms: `start`, `ok Diving`, `fail Diving`, `timeout Diving`, `lose Thruster`, `recover Thruster`.
"""

from __future__ import annotations

from mauve.mission.cascades import Masks, Unsound, cascade, masks
from mauve.mission.graph import StateView, view
from mauve.mission.net import Event, EventKind, Level, Net
from mauve.mission.stable import initial_marking
from mauve.records import changed, record

__all__ = ["Change", "Refused", "Session", "Stepped", "begin", "possible", "script", "step", "told"]

WORDS = {
    "ok": EventKind.OK,
    "fail": EventKind.FAIL,
    "timeout": EventKind.TIMEOUT,
    "lose": EventKind.LOST,
    "recover": EventKind.RECOVERED,
}


@record
class Session:
    """Where a simulation stands; make the first with `begin`."""

    net: Net
    table: Masks
    marking: int

    @property
    def view(self) -> StateView:
        """What can be seen now."""
        return view(self.net, self.marking)


@record
class Change:
    """What an event changed: objectives by path, activities with their alternatives, hardware, and the outcome."""

    begun: tuple[str, ...]
    ended: tuple[str, ...]
    started: tuple[tuple[str, str], ...]
    stopped: tuple[tuple[str, str], ...]
    lost: tuple[str, ...]
    recovered: tuple[str, ...]
    failed: tuple[str, ...]
    outcome: str


@record
class Stepped:
    """An event that was accepted. fired: how many transitions it took, that of the event included."""

    event: str
    session: Session
    change: Change
    fired: int


@record
class Refused:
    """An event that was not: why, and what would be possible."""

    event: str
    reason: str
    possible: tuple[str, ...]


def begin(net: Net) -> Session:
    """A simulation before the start of the mission."""
    return Session(net, masks(net), initial_marking(net))


def possible(session: Session) -> tuple[str, ...]:
    """The names of the events that can happen now, in the order of the mission."""
    enabled = {
        one.event
        for at, one in enumerate(session.net.transitions)
        if one.level is Level.EVENT and not session.table.before[at] & ~session.marking
    }
    return tuple(event.name for event in session.net.events if event.name in enabled)


def step(session: Session, typed: str) -> Stepped | Refused:
    """Answers an event, by its name or in short; a refusal leaves the session as it is."""
    known = _meant(session, typed)
    if isinstance(known, str):
        return Refused(typed, known, possible(session))
    for at, one in enumerate(session.net.transitions):
        if one.level is Level.EVENT and one.event == known.name and not session.table.before[at] & ~session.marking:
            try:
                done = cascade(session.table, session.marking, at)
            except Unsound:
                return Refused(known.name, "activities that need each other's products would wait for ever", ())
            after = changed(session, marking=done.result)
            return Stepped(known.name, after, _change(session.view, after.view), len(done.fired))
    return Refused(known.name, _reason(session.view, known), possible(session))


def script(session: Session, lines: list[str]) -> tuple[Stepped | Refused, ...]:
    """The answers to events, one in each line; empty lines and what follows `#` or `//` are passed over.

    A refused event changes nothing, and the script goes on.
    """
    answers: list[Stepped | Refused] = []
    for line in lines:
        typed = line.split("#")[0].split("//")[0].strip()
        if typed:
            answers.append(step(session, typed))
            if isinstance(done := answers[-1], Stepped):
                session = done.session
    return tuple(answers)


def told(answer: Stepped | Refused) -> str:
    """An answer in lines for a person."""
    if isinstance(answer, Refused):
        choice = ", ".join(answer.possible) or "none"
        return f"{answer.event}: refused, {answer.reason}\n  possible: {choice}"
    change, now = answer.change, answer.session.view
    marks = [("+", change.begun), ("-", change.ended)]
    lines = [f"  {mark} objective {path}" for mark, paths in marks for path in paths]
    old, new = dict(change.stopped), dict(change.started)
    lines += [f"  - {activity} stops{_way(one)}" for activity, one in change.stopped if activity not in new]
    lines += [f"  ~ {name} switches from {old[name]} to {one}" for name, one in new.items() if name in old]
    lines += [f"  + {activity} runs{_way(one)}" for activity, one in change.started if activity not in old]
    lines += [f"  ! {activity} has no alternative left" for activity in change.failed]
    lines += [f"  ! {name} is out of service" for name in change.lost]
    lines += [f"  + {name} is back in service" for name in change.recovered]
    lines += [f"  mission: {now.outcome}"] if change.outcome else []
    return "\n".join([answer.event, *(lines or ["  nothing changes"])])


def _way(alternative: str) -> str:
    """An alternative in words, where there is a choice."""
    return "" if alternative == "only" else f" ({alternative})"


def _meant(session: Session, typed: str) -> Event | str:
    """The event of these words, or what is wrong with them."""
    exact = next((event for event in session.net.events if event.name == typed), None)
    if exact is not None:
        return exact
    words = typed.split()
    if words == ["start"]:
        return next((event for event in session.net.events if event.kind is EventKind.START), "there is no start")
    if len(words) != 2 or words[0] not in WORDS:
        return "there is no such event"
    kind, name = WORDS[words[0]], words[1]
    fitting = [
        event
        for event in session.net.events
        if event.kind is kind and name in (event.subject, event.subject.rpartition(".")[2].partition("#")[0])
    ]
    enabled = [event for event in fitting if event.name in possible(session)]
    if len(fitting) == 1 or len(enabled) == 1:
        return (enabled or fitting)[0]
    if not fitting:
        return f"nothing called {name} has such an event"
    return f"{name} stands at several places: {', '.join(event.name for event in fitting)}"


def _reason(now: StateView, event: Event) -> str:
    """Why an event that exists is not possible now."""
    subject = event.subject
    match event.kind:
        case EventKind.START:
            return "the mission has been started"
        case EventKind.LOST:
            return f"{subject} is out of service already"
        case EventKind.RECOVERED:
            return f"{subject} is in service"
        case EventKind.OK | EventKind.FAIL | EventKind.TIMEOUT if subject not in now.objectives:
            return f"{subject} is not being pursued" + (f": the mission ended in {now.outcome}" if now.outcome else "")
        case EventKind.OK if now.failed:
            return f"{subject} cannot be reached any more: {', '.join(now.failed)} has no alternative left"
    return "it is not possible in this state"


def _change(before: StateView, after: StateView) -> Change:
    def new(old: tuple[str, ...], now: tuple[str, ...]) -> tuple[str, ...]:
        return tuple(one for one in now if one not in old)

    return Change(
        new(before.objectives, after.objectives),
        new(after.objectives, before.objectives),
        tuple(one for one in after.running if one not in before.running),
        tuple(one for one in before.running if one not in after.running),
        new(before.lost, after.lost),
        new(after.lost, before.lost),
        new(before.failed, after.failed),
        after.outcome if after.outcome != before.outcome else "",
    )
