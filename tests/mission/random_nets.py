"""Random small nets with levels, sound or not, to compare ways of following their cascades."""

from __future__ import annotations

from random import Random

from mauve.mission.cascades import Masks, armed
from mauve.mission.net import Event, EventKind, Level, Net, Transition

GO = Event("GO", EventKind.OTHER)


def random_net(random: Random, size: int) -> tuple[Net, int]:
    """A net of a few levels with one event, its places in pairs that mostly pass a token on, and a stable marking.

    The event is the last transition; it can happen in that marking.
    """
    places = range(2 * size)
    state = random.getrandbits(2 * size) | 1
    steps: list[Transition] = []
    for index in range(random.randint(size, 2 * size)):
        before = random.sample(places, random.choice((1, 1, 2, 2, 3)))
        reads = [one for one in before[1:] if random.random() < 0.3]
        after = [one ^ 1 if random.random() < 0.6 else random.choice(places) for one in before if one not in reads]
        after += random.sample(places, random.choice((0, 0, 1)))
        filled = tuple(dict.fromkeys((*reads, *after)))
        if all(state >> one & 1 for one in before) or set(before) <= set(filled):
            continue
        level = Level(random.choice((1, 2, 2, 4, 4, 4)))
        steps.append(Transition(f"t{index}", tuple(before), filled, level))
    free = [one for one in places if not state >> one & 1]
    chosen = random.sample(free, min(len(free), random.randint(1, 4)))
    steps.append(Transition("go", (0,), tuple(chosen), Level.EVENT, "GO"))
    initial = tuple(one for one in places if state >> one & 1)
    return Net("small", tuple(f"p{one}" for one in places), tuple(steps), initial, (GO,)), state


def is_stable(table: Masks, state: int) -> bool:
    """Whether no transition above the events is enabled."""
    live = armed(table, state)
    return not any(live >> index & 1 and not needed & ~state for index, needed in enumerate(table.before))
