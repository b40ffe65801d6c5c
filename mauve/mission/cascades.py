"""What an event sets off: a cascade, always the first enabled transition of the highest level, until none is enabled.

A transition of level L is followed by all of higher levels that it wakes, before anything else happens: a *run*. When
it begins, nothing of these levels is enabled, or was woken and not looked at. So what a run does depends only on the
places that it looks at, and one that was seen before need not be fired again, in whatever cascade it comes.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import TypeAlias

from mauve.mission.net import Level, Net, marking
from mauve.records import record

LONGEST = 1_000_000
"""Transitions in one cascade; a net of the templates has none that is longer than a few hundred."""


class Unsound(Exception):
    """A cascade that no controller could execute; only missions whose activities need each other's products have one.

    run: the events that lead there, that of the cascade included, as far as they are known.
    """

    def __init__(self, transition: int, run: tuple[str, ...] = ()) -> None:
        super().__init__(transition, run)
        self.transition = transition
        self.run = run


class Unsafe(Unsound):
    """A transition would fill a place that holds its token: the net is not 1-safe."""


class EndlessCascade(Unsound):
    """The transitions after an event never come to an end."""


@record
class Masks:
    """A net for firing: per transition the places it needs, takes and fills as bits, and its level.

    Most transitions above the events need a place that only a cascade marks: the first such place of each arms it
    (arms[place] has a bit for each), and unarmed it need not be looked at. steady: those without such a place;
    by_level: those of each level. Per transition: `wakes` are those that need what it fills, `arming` the places that
    arm one of these; armed and disarmed are those that it arms and disarms.
    """

    before: tuple[int, ...]
    taken: tuple[int, ...]
    filled: tuple[int, ...]
    levels: tuple[int, ...]
    arms: tuple[int, ...]
    transient: int
    steady: int
    by_level: tuple[int, ...]
    wakes: tuple[int, ...]
    arming: tuple[int, ...]
    armed: tuple[int, ...]
    disarmed: tuple[int, ...]


def masks(net: Net) -> Masks:
    """The masks of a net."""
    passing = frozenset(net.transient)
    waiting, arms, waited = [0] * len(net.places), [0] * len(net.places), [0] * len(net.places)
    by_level = [0] * len(Level)
    steady = 0
    for index, one in enumerate(net.transitions):
        bit = 1 << index
        by_level[one.level] |= bit
        if one.level is Level.EVENT:
            continue
        arming = -1
        for place in one.before:
            waiting[place] |= bit
            if arming < 0 and place in passing:
                arming = place
        if arming < 0:
            steady |= bit
            continue
        arms[arming] |= bit
        for place in one.before:
            waited[place] |= 1 << arming
    new = [[place for place in one.after if place not in one.before] for one in net.transitions]
    gone = [[place for place in one.before if place not in one.after] for one in net.transitions]
    return Masks(
        tuple([_ones(one.before) for one in net.transitions]),
        tuple([_ones(one) for one in gone]),
        tuple([_ones(one) for one in new]),
        tuple([int(one.level) for one in net.transitions]),
        tuple(arms),
        marking(net.transient),
        steady,
        tuple(by_level),
        _united(new, waiting),
        _united(new, waited),
        _united(new, arms),
        _united(gone, arms),
    )


def _ones(places: Iterable[int]) -> int:
    found = 0
    for place in places:
        found |= 1 << place
    return found


def _united(changes: list[list[int]], by_place: list[int]) -> tuple[int, ...]:
    """For each of these sets of places, all that its places have."""
    found = []
    for change in changes:
        united = 0
        for place in change:
            united |= by_place[place]
        found.append(united)
    return tuple(found)


def armed(table: Masks, state: int) -> int:
    """The transitions above the events that are not ruled out by the transient places of a marking."""
    found = table.steady
    for place in bits(state & table.transient):
        found |= table.arms[place]
    return found


def bits(mask: int) -> Iterator[int]:
    """The positions of the ones, lowest first."""
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


@record
class Cascade:
    """What came of an event: the marking after it, the places it depended on, and the transitions in order.

    Whether a place was free to be filled is apart, in `spared`: a sound net answers that by its shape.
    """

    result: int
    tested: int
    spared: int
    fired: tuple[int, ...]


Run: TypeAlias = tuple[int, int, int, int, int, int, int, int, int, list[int]]
"""What a run clears, fills, tests, spares and writes (places), the transient places at which it looks for what may be
armed; the transitions that it disarms, arms, and wakes for later; those that it fires."""


class Runs:
    """The runs of a net that were seen, by the transition that they begin with."""

    def __init__(self, table: Masks) -> None:
        self.table = table
        self.known: list[dict[int, dict[int, Run]]] = [{} for _ in table.before]

    def cascade(self, state: int, event: int) -> Cascade:
        """What a transition of level 0 sets off in a stable marking. Raises Unsafe and EndlessCascade."""
        table = self.table
        gone, new, tested, spared, _, _, _, _, _, fired = self._run(state, event, armed(table, state), Level.EVENT)
        return Cascade(state & ~gone | new, tested, spared | table.transient, tuple(fired))

    def _run(self, start: int, chosen: int, live: int, floor: int) -> Run:
        """Fires a transition, and then all above the level `floor`; `live` are the armed transitions before it."""
        table, wakes = self.table, self.table.wakes
        before, taken, filled, by_level = table.before, table.taken, table.filled, table.by_level
        now = start
        spared = written = looked = off = on = ready = 0
        tested = before[chosen]
        fired: list[int] = []
        while chosen >= 0:
            gone, new = taken[chosen], filled[chosen]
            if now & new:
                raise Unsafe(chosen)
            spared |= new & ~written
            now = now ^ gone | new
            written |= gone | new
            fired.append(chosen)
            if len(fired) > LONGEST:
                raise EndlessCascade(chosen)
            looked |= table.arming[chosen]
            disarmed, arms = table.disarmed[chosen], table.armed[chosen]
            off, on, live = off | disarmed, on & ~disarmed | arms, live & ~disarmed | arms
            ready = (ready | wakes[chosen]) & live
            chosen = -1
            level = Level.RESOURCE + 0
            while level > floor:
                here = ready & by_level[level]
                while here:
                    low = here & -here
                    index = low.bit_length() - 1
                    missing = before[index] & ~now
                    if not missing:
                        chosen = index
                        break
                    here ^= low
                    ready ^= low
                    if not missing & (written | tested):
                        tested |= missing & -missing
                if chosen < 0:
                    level -= 1
                    continue
                if level == Level.RESOURCE:
                    tested |= before[chosen] & ~written
                    break
                run = self._seen(now, chosen, live, level)
                tested |= run[2] & ~written
                spared |= run[3] & ~written
                now = now & ~run[0] | run[1]
                written |= run[4]
                looked |= run[5]
                disarmed, arms = run[6], run[7]
                off, on, live = off | disarmed, on & ~disarmed | arms, live & ~disarmed | arms
                ready = (ready | run[8]) & live
                fired += run[9]
                if len(fired) > LONGEST:
                    raise EndlessCascade(chosen)
                chosen = -1
                level = Level.RESOURCE + 0
        return start & ~now, now & ~start, tested, spared, written, looked, off, on, ready, fired

    def _seen(self, now: int, chosen: int, live: int, level: int) -> Run:
        """The run of an enabled transition, fired only if none from a marking that looks the same was."""
        known = self.known[chosen]
        for mask, by_value in known.items():
            run = by_value.get(now & mask)
            if run is not None:
                return run
        run = self._run(now, chosen, live, level)
        looks = run[2] | run[3] | run[5]
        known.setdefault(looks, {})[now & looks] = run
        return run


def cascade(table: Masks, state: int, event: int) -> Cascade:
    """What a transition of level 0 sets off in a stable marking, remembering nothing. Raises as Runs.cascade."""
    return Runs(table).cascade(state, event)
