"""Walks over the tree of a mission, and what its activities depend on."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence

from mauve.model.missions import (
    Activity,
    Block,
    Continue,
    Elementary,
    Hardware,
    Mission,
    Parallel,
    Recover,
    Step,
)
from mauve.records import record

Cut = frozenset[str]
"""Names of devices that are out of service together."""

Cuts = tuple[Cut, ...]
"""Minimal cuts: each one alone is enough. The empty cut says that it can never work, no cuts that it always can."""

NEVER: Cuts = (frozenset(),)

MOST_CUTS = 500
"""Of more minimal cuts, the smallest are kept."""


def steps_of(block: Block) -> tuple[Step, ...]:
    """The steps directly in a block; none in an elementary objective."""
    match block:
        case Elementary():
            return ()
        case Parallel(_, children):
            return tuple(child.step for child in children)
        case _:
            return block.steps


def blocks(block: Block) -> Iterator[Block]:
    """A block and all in it, those of recoveries included."""
    yield block
    for step in steps_of(block):
        yield from blocks(step.block)
        if isinstance(step.on_failure, Recover):
            yield from blocks(step.on_failure.block)


def elementary(block: Block) -> Iterator[Elementary]:
    """The elementary objectives of a block, each as often as it stands there."""
    return (one for one in blocks(block) if isinstance(one, Elementary))


def that_matter(block: Block) -> Iterator[Elementary]:
    """The elementary objectives whose failure makes the block fail, unless something is recovered."""
    match block:
        case Elementary():
            yield block
        case Parallel(_, children):
            for child in children:
                if child.mandatory and not isinstance(child.step.on_failure, Continue):
                    yield from that_matter(child.step.block)
        case _:
            for step in block.steps:
                if not isinstance(step.on_failure, Continue):
                    yield from that_matter(step.block)


# ------------------------------------------------------------------------------------------------ dependencies
@record
class Chain:
    """How an activity comes to be used: `names` begin with an objective or activity and end with the activity."""

    names: tuple[str, ...]

    def __str__(self) -> str:
        return " -> ".join(f"`{name}`" for name in self.names)


def closure(mission: Mission, activities: Iterable[str], start: tuple[str, ...] = ()) -> dict[str, Chain]:
    """The activities, and the producers of all they consume, each with a shortest chain of activities and resources
    that leads to it."""
    found: dict[str, Chain] = {}
    queue = [(name, (*start, name)) for name in activities]
    for name, names in queue:
        if name in found:
            continue
        found[name] = Chain(names)
        for need in mission.activity(name).needs:
            producer = mission.producer(need)
            if producer is not None and producer.name not in found:
                queue.append((producer.name, (*names, need, producer.name)))
    return found


class Dependence:
    """Minimal cuts of activities and blocks of a mission: which devices, lost together, make them impossible.

    Exclusive use is not considered: a device that another activity holds counts as there.
    """

    def __init__(self, hardware: Iterable[Hardware], activities: Sequence[Activity]) -> None:
        self._hardware = {device.name: device for device in hardware}
        self._activities = {activity.name: activity for activity in activities}
        self._producers = {name: activity for activity in reversed(activities) for name in activity.offers}
        self._known: dict[str, Cuts] = {}
        self._open: list[str] = []
        self._looped = False

    def activity(self, name: str) -> Cuts:
        """What makes every alternative of an activity impossible."""
        return self._of(self._activities[name], None)

    def resource(self, name: str) -> Cuts:
        """What makes a resource unobtainable."""
        device = self._hardware.get(name)
        if device is not None:
            return (frozenset({name}),) if device.may_fail else ()
        producer = self._producers.get(name)
        return self._of(producer, name) if producer is not None else NEVER

    def _of(self, activity: Activity, offer: str | None) -> Cuts:
        """The cuts of the alternatives together, of those that offer a resource where one is asked for."""
        key = f"{activity.name}.{offer or ''}"
        if key in self._known:
            return self._known[key]
        if activity.name in self._open:
            self._looped = True  # nothing runs because it runs itself; what rests on this is not kept
            return NEVER
        outer, self._looped = self._looped, False
        self._open.append(activity.name)
        cuts: Cuts = NEVER
        for one in activity.alternatives:
            if offer is None or offer in one.offers:
                cuts = both(cuts, either(self.resource(need) for need in sorted(one.needs)))
        self._open.pop()
        if not self._looped or not self._open:
            self._known[key] = cuts
            self._looped = False
        self._looped = self._looped or outer
        return cuts

    def recovers(self, cut: Cut) -> bool:
        """Whether a device of a cut may come back."""
        return any(self._hardware[name].may_recover for name in cut)

    def block(self, block: Block) -> Cuts:
        """What makes a block impossible, what it does on failures considered."""
        match block:
            case Elementary(_, activities):
                return either(self.activity(ref.name) for ref in activities)
            case Parallel(_, children):
                return either(self.step(child.step) for child in children if child.mandatory)
            case _:
                return either(self.step(step) for step in block.steps)

    def step(self, step: Step) -> Cuts:
        """As `block`, of a step."""
        match step.on_failure:
            case Continue():
                return ()
            case Recover(block, True):
                return both(self.block(step.block), self.block(block))
            case _:
                return self.block(step.block)


def either(several: Iterable[Cuts]) -> Cuts:
    """The cuts of what needs all of several things: any cut of any of them."""
    return _minimal(cut for cuts in several for cut in cuts)


def both(left: Cuts, right: Cuts) -> Cuts:
    """The cuts of what needs one of two things: a cut of each."""
    return _minimal(a | b for a in left for b in right)


def _minimal(cuts: Iterable[Cut]) -> Cuts:
    """The cuts that contain no other, smallest first."""
    kept: list[Cut] = []
    for cut in sorted(set(cuts), key=lambda cut: (len(cut), sorted(cut))):
        if len(kept) < MOST_CUTS and not any(smaller <= cut for smaller in kept):
            kept.append(cut)
    return tuple(kept)
