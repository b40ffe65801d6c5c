"""A net while it is being written down: places and transitions by name, in order of declaration."""

from __future__ import annotations

from collections.abc import Iterable

from mauve.mission.net import Event, Level, Meanings, Net, Transition


class Draft:
    """Collects places, transitions and events; `net` is what came of it."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.places: dict[str, str] = {}
        self.transitions: dict[str, Transition] = {}
        self.initial: list[int] = []
        self.transient: list[int] = []
        self.events: dict[str, Event] = {}
        self.objectives: list[tuple[int, str]] = []
        self.running: list[tuple[int, str, str]] = []
        self.failed: list[tuple[int, str]] = []
        self.lost: list[tuple[int, str]] = []
        self.outcomes: list[tuple[int, str]] = []
        self.units: dict[str, list[int]] = {}

    def place(self, group: str, name: str, marked: bool = False, transient: bool = False, unit: str = "") -> int:
        """A new place `group.name`, with a token at first where `marked`; its index.

        All places of one unit have one token together, always.
        """
        full = f"{group}.{name}" if group else name
        while full in self.places:
            full += "'"
        index = len(self.places)
        self.places[full] = group
        if marked:
            self.initial.append(index)
        if transient:
            self.transient.append(index)
        if unit:
            self.units.setdefault(unit, []).append(index)
        return index

    def fire(
        self,
        name: str,
        level: Level,
        before: Iterable[int],
        after: Iterable[int],
        reads: Iterable[int] = (),
        event: Event | None = None,
    ) -> None:
        """A new transition that takes `before`, fills `after` and only reads `reads`."""
        while name in self.transitions:
            name += "'"
        read = tuple(reads)
        if event is not None:
            self.events.setdefault(event.name, event)
        self.transitions[name] = Transition(
            name, (*before, *read), (*after, *read), level, event.name if event is not None else ""
        )

    def net(self) -> Net:
        """The net as far as it is written, its transient places last: the numbers of stable markings stay short."""
        passing = frozenset(self.transient)
        order = [place for place in range(len(self.places)) if place not in passing] + self.transient
        at = {old: new for new, old in enumerate(order)}
        names, groups = list(self.places), list(self.places.values())
        return Net(
            self.name,
            tuple(names[old] for old in order),
            tuple(
                Transition(one.name, _moved(at, one.before), _moved(at, one.after), one.level, one.event)
                for one in self.transitions.values()
            ),
            _moved(at, self.initial),
            tuple(self.events.values()),
            Meanings(
                tuple((at[place], path) for place, path in self.objectives),
                tuple((at[place], activity, alternative) for place, activity, alternative in self.running),
                tuple((at[place], name) for place, name in self.failed),
                tuple((at[place], name) for place, name in self.lost),
                tuple((at[place], name) for place, name in self.outcomes),
            ),
            tuple(groups[old] for old in order),
            _moved(at, self.transient),
            tuple(_moved(at, unit) for unit in self.units.values()),
        )


def _moved(at: dict[int, int], places: Iterable[int]) -> tuple[int, ...]:
    return tuple([at[place] for place in places])
