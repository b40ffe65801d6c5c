"""Whether an objective can have all it needs at one time, where exclusive resources serve one activity each."""

from __future__ import annotations

from collections.abc import Mapping

from mauve.model.missions import Activity, Elementary, Mission
from mauve.records import record

MOST_TRIALS = 2_000
"""After so many choices of alternatives it is taken for possible: nothing is reported that is not certain."""


@record
class Rivals:
    """Two activities that an objective always needs together, and the exclusive resource that both take."""

    resource: str
    first: str
    second: str


def rivals(mission: Mission, objective: Elementary) -> Rivals | None:
    """Why no choice of alternatives serves the objective; None where one does, or the search is given up."""
    return _Search(mission).why_not(tuple(ref.name for ref in objective.activities))


class _Search:
    """Chooses an alternative for each activity needed, and takes back what does not fit."""

    def __init__(self, mission: Mission) -> None:
        self.activities = {activity.name: activity for activity in mission.activities}
        self.producers = {name: activity.name for activity in mission.activities for name in activity.offers}
        shared = {resource.name for resource in mission.software if resource.shared}
        self.exclusive = {name for activity in mission.activities for name in activity.needs} - shared
        self.trials = 0
        self.found: Rivals | None = None

    def why_not(self, needed: tuple[str, ...]) -> Rivals | None:
        """The first rivals met, where every choice has some."""
        return None if self._fits(needed, {}, {}) else self.found

    def _fits(self, needed: tuple[str, ...], chosen: Mapping[str, frozenset[str]], taken: Mapping[str, str]) -> bool:
        """Whether the activities still needed can be served beside those chosen, with what these offer."""
        self.trials += 1
        if self.trials > MOST_TRIALS:
            return True
        pending = [name for name in needed if name not in chosen]
        if not pending:
            return True
        activity = self.activities[pending[0]]
        ways = range(len(activity.alternatives))
        return any(self._chosen(activity, number, pending, chosen, taken) for number in ways)

    def _chosen(
        self,
        activity: Activity,
        number: int,
        pending: list[str],
        chosen: Mapping[str, frozenset[str]],
        taken: Mapping[str, str],
    ) -> bool:
        one = activity.alternatives[number]
        for need in sorted(one.needs & self.exclusive):
            if taken.get(need, activity.name) != activity.name:
                self.found = self.found or Rivals(need, taken[need], activity.name)
                return False
        makers = [self.producers[need] for need in one.needs if need in self.producers]
        if any(need in self.producers and need not in chosen.get(self.producers[need], {need}) for need in one.needs):
            return False
        mine = dict.fromkeys(one.needs & self.exclusive, activity.name)
        return self._fits((*pending[1:], *makers), {**chosen, activity.name: one.offers}, {**taken, **mine})

