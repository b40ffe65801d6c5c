"""Petri nets with priorities: places, transitions, and an initial marking; 1-safe by construction of the templates.

A marking is an integer: bit p is set where place p holds its token. Only transitions of the highest enabled level may
fire; those of level 0 are the events. A marking is stable where nothing above level 0 is enabled (mission paper,
section 6, with five levels in place of two).
"""

from __future__ import annotations

from enum import IntEnum

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


@record
class Net:
    """Names of places and transitions are unique; indices follow the order of declaration, which is canonical."""

    name: str
    places: tuple[str, ...]
    transitions: tuple[Transition, ...]
    initial: tuple[int, ...]
