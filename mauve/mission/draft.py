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
        """The net as far as it is written."""
        return Net(
            self.name,
            tuple(self.places),
            tuple(self.transitions.values()),
            tuple(self.initial),
            tuple(self.events.values()),
            Meanings(
                tuple(self.objectives),
                tuple(self.running),
                tuple(self.failed),
                tuple(self.lost),
                tuple(self.outcomes),
            ),
            tuple(self.places.values()),
            tuple(self.transient),
            tuple(tuple(unit) for unit in self.units.values()),
        )
