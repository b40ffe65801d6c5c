"""What an activity or an objective can come to need: the closure over the producers of software resources."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property

from mauve.mission.flatten import Leaf
from mauve.mission.plan import Activity, Alternative, Mission


class Wiring:
    """Who produces and who consumes what in a mission."""

    def __init__(self, mission: Mission) -> None:
        self.mission = mission
        self.activities = {one.name: one for one in mission.activities}

    @cached_property
    def producers(self) -> dict[str, str]:
        """The activity that offers each software resource."""
        found: dict[str, str] = {}
        for activity in self.mission.activities:
            for name in activity.produces:
                found.setdefault(name, activity.name)
        return found

    @cached_property
    def consumers(self) -> dict[str, tuple[str, ...]]:
        """The activities that can take each resource, in the order of the mission."""
        found: dict[str, list[str]] = {}
        for activity in self.mission.activities:
            for name in activity.consumes:
                found.setdefault(name, []).append(activity.name)
        return {name: tuple(names) for name, names in found.items()}

    def closure(self, activities: Iterable[str]) -> tuple[str, ...]:
        """These activities and all that produce what they can need, in the order of the mission."""
        found: set[str] = set()
        todo = [name for name in activities if name in self.activities]
        while todo:
            name = todo.pop()
            if name in found:
                continue
            found.add(name)
            for resource in self.activities[name].consumes:
                if resource in self.producers:
                    todo.append(self.producers[resource])
        return tuple(name for name in self.activities if name in found)

    def resources(self, activities: Iterable[str]) -> frozenset[str]:
        """All that the closure of these activities can take."""
        return frozenset(one for name in self.closure(activities) for one in self.activities[name].consumes)

    def below(self, alternatives: Iterable[Alternative]) -> frozenset[str]:
        """All resources on which these alternatives depend."""
        taken = [one for alternative in alternatives for one in alternative.consumes]
        producers = [self.producers[one] for one in taken if one in self.producers]
        return frozenset(taken) | self.resources(producers)

    def producers_first(self) -> tuple[Activity, ...]:
        """The activities so that each comes after those it can need; where these form a cycle, it is cut somewhere."""
        order: dict[str, Activity] = {}
        entered: set[str] = set()
        for root in self.activities:
            stack = [(root, False)]
            while stack:
                name, left = stack.pop()
                if left:
                    order.setdefault(name, self.activities[name])
                elif name not in entered:
                    entered.add(name)
                    stack.append((name, True))
                    needs = [self.producers[one] for one in self.activities[name].consumes if one in self.producers]
                    stack.extend((one, False) for one in reversed(needs))
        return tuple(order.values())


def needed(wiring: Wiring, leaf: Leaf) -> tuple[str, ...]:
    """The activities that an elementary objective can start, directly or through what they need."""
    return wiring.closure(leaf.objective.activities)
