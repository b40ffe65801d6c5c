"""What never happens: events that no reachable stable state allows, and ways for an event to happen, never used."""

from __future__ import annotations

from mauve.mission.net import Level, marking
from mauve.mission.survey import Survey
from mauve.records import record

__all__ = ["NeverFiring", "never_firing"]


@record
class NeverFiring:
    """events: names of events that can never happen. transitions: names of transitions of events that never fire.

    A transition may be idle though its event happens: an objective's failure *after the loss of an activity* is one way
    to fail, and never used where the activities can lose nothing.
    """

    events: tuple[str, ...]
    transitions: tuple[str, ...]


def never_firing(seen: Survey) -> NeverFiring:
    """The events and event transitions that are impossible in all stable states."""
    net = seen.graph.net
    happening = set(seen.graph.events)
    idle = [
        one.name
        for one in net.transitions
        if one.level is Level.EVENT and not _enabled_somewhere(seen.graph.markings, marking(one.before))
    ]
    events = tuple(event.name for at, event in enumerate(net.events) if at not in happening)
    return NeverFiring(events, tuple(idle))


def _enabled_somewhere(markings: tuple[int, ...], needed: int) -> bool:
    return any(state & needed == needed for state in markings)
