"""All orders of a cascade, followed in parts that have nothing to do with each other.

* A *part* is what some transitions start, all of the highest level L that is enabled in a marking: they fire, and so
  does whatever they wake of level L and above, by the rules of priority, until nothing of these levels is left that
  they woke. A part looks at the places that what fires needs and fills, and, of each transition that it wakes in
  vain, at one that is missing. It changes the places that get or lose a token in one of its orders.
* Take parts that together start with all that is enabled of level L, none of which changes what another looks at, and
  any order of the whole. What it has of one part is an order of that part, which sees what it would see alone, and
  has something of a higher level to fire just when the whole has. Nothing fires that belongs to no part: the part that
  woke it saw a place missing, which no other part fills. Conversely the parts can run one after the other in any of
  their orders, as what did not begin yet is of level L, and gives way. So the ends of the whole are the combinations
  of the ends of its parts; and it is endless, or fills a place twice, just where one of its parts does.
* The same part follows from every marking with the same tokens where it looks, so it is followed once.

Parts of which one changes what the other looks at are joined to one, whose orders are followed one by one, in steps of
a transition of level L with all of higher levels that it brings. Two ends, no end, or a place filled twice are not
described here: Unusual is raised, and the cascade has to be followed as a whole.
"""

from __future__ import annotations

from typing import TypeAlias

from mauve.mission.cascades import Masks
from mauve.mission.net import Level

DEEPEST = 60
"""Parts inside each other, beyond which a cascade is not followed here."""

LONGEST = 20_000
"""Transitions of a part one after the other, beyond which it is taken for endless."""

SHARED = 4
"""Down to this depth a transition that is alone starts a part, too; that is found again more often."""


class Unusual(Exception):
    """A cascade that is not shown to have one end, to come to it, and to fill no place twice."""


class OverBudget(Exception):
    """A cascade has more orders than may be followed."""


Part: TypeAlias = tuple[int, int, int, int, int]
"""The places that a part looks at, changes, clears and fills, and the transitions of lower levels that it wakes."""


class Orders:
    """Follows the cascades of a net, and knows the parts that it followed. `followed`: how many markings that took."""

    def __init__(self, table: Masks) -> None:
        self.table = table
        self.parts: dict[int, dict[int, dict[int, Part]]] = {}
        self.followed = 0
        self.most = 0

    def cascade(self, state: int, event: int, budget: int) -> tuple[int, int]:
        """The one end of the cascade of a transition of level 0 in all orders, and the places that it looks at.

        The marking must be stable. Raises Unusual, and OverBudget beyond so many markings.
        """
        self.most = self.followed + budget
        looks, _, cleared, filled, _ = self._alone(state, event, Level.MISSION, 0)
        return state & ~cleared | filled, looks

    def _alone(self, state: int, start: int, floor: int, depth: int) -> Part:
        """A transition, and what it brings of the levels from `floor` on."""
        table = self.table
        before, taken, filled, wakes, by_level = table.before, table.taken, table.filled, table.wakes, table.by_level
        now, chosen = state, start
        looks = changes = woken = steps = 0
        while True:
            if now & filled[chosen] or steps == LONGEST:
                raise Unusual
            steps += 1
            now = now & ~taken[chosen] | filled[chosen]
            looks |= before[chosen] | filled[chosen]
            changes |= taken[chosen] | filled[chosen]
            woken |= wakes[chosen]
            chosen = -1
            for level in range(Level.RESOURCE, floor - 1, -1):
                here = woken & by_level[level]
                if not here:
                    continue
                woken ^= here
                firing = 0
                while here:
                    low = here & -here
                    here ^= low
                    missing = before[low.bit_length() - 1] & ~now
                    if not missing:
                        firing |= low
                    elif not missing & looks:
                        looks |= missing & -missing
                if not firing:
                    continue
                if depth >= SHARED and not firing & (firing - 1):
                    chosen = firing.bit_length() - 1
                    break
                for looked, changed, gone, new, others in self._apart(now, firing, level, depth):
                    looks |= looked
                    changes |= changed
                    now = now & ~gone | new
                    woken |= others
            if chosen < 0:
                break
        self.followed += steps
        if self.followed > self.most:
            raise OverBudget
        return looks, changes, state & ~now, now & ~state, woken

    def _apart(self, state: int, firing: int, level: int, depth: int) -> list[Part]:
        """What these transitions start, all that are enabled of a level, in parts that do not touch each other."""
        todo = [(one, self._part(state, one, level, depth)) for one in _single(firing)]
        found: list[tuple[int, Part]] = []
        looked = changed = 0
        while todo:
            group, part = todo.pop()
            if part[0] & changed or part[1] & looked:
                touching = [one for one in found if part[0] & one[1][1] or part[1] & one[1][0]]
                if touching:
                    found = [one for one in found if one not in touching]
                    for one, _ in touching:
                        group |= one
                    todo.append((group, self._part(state, group, level, depth)))
                    continue
            found.append((group, part))
            looked |= part[0]
            changed |= part[1]
        return [part for _, part in found]

    def _part(self, state: int, group: int, level: int, depth: int) -> Part:
        """What these enabled transitions of one level start."""
        known = self.parts.get(group)
        if known is None:
            known = self.parts[group] = {}
        for mask in reversed(known):  # what was seen last is met again first
            part = known[mask].get(state & mask)
            if part is not None:
                return part
        if depth == DEEPEST:
            raise Unusual
        if group & (group - 1):
            part = self._together(state, group, level, depth + 1)
        else:
            part = self._alone(state, group.bit_length() - 1, level, depth + 1)
        known.setdefault(part[0], {})[state & part[0]] = part
        return part

    def _together(self, state: int, group: int, level: int, depth: int) -> Part:
        """What several enabled transitions of a level start, followed in all orders."""
        before, of_level = self.table.before, self.table.by_level[level]
        looks = changes = woken = 0
        ends: list[int] = []
        follow: dict[int, list[int]] = {state: []}
        queue = [(state, group)]
        for marking, candidates in queue:
            firing = []
            rest = 0
            for low in _single(candidates):
                index = low.bit_length() - 1
                missing = before[index] & ~marking
                if not missing:
                    firing.append(index)
                    rest |= low
                elif not missing & looks:
                    looks |= missing & -missing
            if not firing:
                ends.append(marking)
            for index in firing:
                looked, changed, gone, new, others = self._alone(marking, index, level + 1, depth)
                looks |= looked
                changes |= changed
                woken |= others
                after = marking & ~gone | new
                follow[marking].append(after)
                if after not in follow:
                    follow[after] = []
                    queue.append((after, rest & ~(1 << index) | others & of_level))
        if len(ends) != 1 or has_cycle(follow):
            raise Unusual
        (end,) = ends
        return looks, changes, state & ~end, end & ~state, woken & ~of_level


def _single(mask: int) -> list[int]:
    """The ones of a mask, each as a mask of its own."""
    found = []
    while mask:
        low = mask & -mask
        found.append(low)
        mask ^= low
    return found


def has_cycle(follow: dict[int, list[int]]) -> bool:
    """Whether the markings of a cascade, each with those after it, can come back to one of them."""
    degree = dict.fromkeys(follow, 0)
    for targets in follow.values():
        for target in targets:
            degree[target] += 1
    ready = [one for one, before in degree.items() if not before]
    for one in ready:
        for target in follow[one]:
            degree[target] -= 1
            if not degree[target]:
                ready.append(target)
    return len(ready) < len(follow)
