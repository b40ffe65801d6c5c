"""Petri nets with priorities: places, transitions, and an initial marking; 1-safe by construction of the templates.

A marking is an integer: bit p is set where place p holds its token. Only transitions of the highest enabled level may
fire; those of level 0 are the events. A marking is stable where nothing above level 0 is enabled (mission paper,
section 6, with five levels in place of two).
"""

from __future__ import annotations

from enum import Enum, IntEnum

from mauve.records import record


class Level(IntEnum):
    """Who goes first: resources, then the choice of alternatives, then stops, then the mission; events last."""

    EVENT = 0
    MISSION = 1
    STOP = 2
    CHOICE = 3
    RESOURCE = 4


@record
class Transition:
    """Consumes the places of `before`, fills those of `after` (indices); a place in both is only read.

    `event` is the name of the event of a transition of level 0, shared by all transitions it can fire; "" above.
    """

    name: str
    before: tuple[int, ...]
    after: tuple[int, ...]
    level: Level
    event: str = ""


class EventKind(Enum):
    """Who reports an event: the mission's user, an objective's activities, its timer, or the driver of a resource."""

    START = "EV_START"
    OK = "EV_OK"
    FAIL = "EV_FAIL"
    TIMEOUT = "EV_TIMEOUT"
    LOST = "EV_OOS"
    RECOVERED = "EV_RD"
    OTHER = "EV"
    """Of an environment that a test puts around a part of a mission."""


@record
class Event:
    """An event by name, as the paper has it (`Filming_EV_OK`); `subject` is the path of an objective, or a resource."""

    name: str
    kind: EventKind
    subject: str = ""


@record
class Meanings:
    """What marked places say to a person; each entry begins with the index of a place.

    objectives: the path of an elementary objective that is pursued; running: activity and alternative; failed: an
    activity that an objective asked for and that has no alternative left; lost: hardware that is out of service;
    outcomes: "success" and "failure".
    """

    objectives: tuple[tuple[int, str], ...] = ()
    running: tuple[tuple[int, str, str], ...] = ()
    failed: tuple[tuple[int, str], ...] = ()
    lost: tuple[tuple[int, str], ...] = ()
    outcomes: tuple[tuple[int, str], ...] = ()


@record
class Net:
    """Names of places and transitions are unique; indices follow the order of declaration, which is canonical.

    `groups` names for each place the part of the mission it belongs to: a resource, an activity, the path of an
    objective, or "" for the mission itself. No stable marking of a sound mission holds a place of `transient`. The
    places of each of `units` hold one token together in every marking (place invariants that `verify` checks).
    """

    name: str
    places: tuple[str, ...]
    transitions: tuple[Transition, ...]
    initial: tuple[int, ...]
    events: tuple[Event, ...] = ()
    meanings: Meanings = Meanings()
    groups: tuple[str, ...] = ()
    transient: tuple[int, ...] = ()
    units: tuple[tuple[int, ...], ...] = ()


def marking(places: tuple[int, ...]) -> int:
    """The marking with a token in each of these places."""
    return sum(1 << place for place in set(places))


def marked(net: Net, state: int) -> tuple[str, ...]:
    """The names of the places that hold a token in a marking, in order of declaration."""
    return tuple(name for place, name in enumerate(net.places) if state >> place & 1)
