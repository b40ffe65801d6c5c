"""What the documents say a mission does, executed without a net: an oracle for the templates.

Blocks are continuations, activities a handful of sets. After an event everything comes to rest: what lost something
judges its alternatives anew (producers first), then what nobody asks for stops, then the mission goes on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator

from mauve.mission.flatten import Fork, Leaf, Link, Node, Series, flatten, leaves, short_names
from mauve.mission.graph import StateView
from mauve.mission.plan import Activity, Alternative, Continue, Mission, OnRecovery, Recover, Retry

Then = Callable[[], None]


class Interpreter:
    """A mission at rest between events; `step` takes one of `possible`, `view` tells what is seen."""

    def __init__(self, mission: Mission) -> None:
        self.mission = mission
        self.hardware = {one.name: one for one in mission.hardware}
        self.activities = {one.name: one for one in mission.activities}
        self.maker = {made: one.name for one in mission.activities for made in one.produces}
        self.order = list(self._producers_first())
        self.root = flatten(mission)
        self.stems = short_names(tuple(leaf.path for leaf in leaves(self.root)))
        self.lost: set[str] = set()
        self.runs: dict[str, int] = {}
        """The alternative of each activity that runs."""
        self.offered: dict[str, set[str]] = {name: set() for name in self.activities}
        self.holds: set[tuple[str, str]] = set()
        self.judging: set[str] = set()
        self.failed: set[str] = set()
        self.pursued: dict[str, tuple[Leaf, Then, Then]] = {}
        self.in_error: set[str] = set()
        self.outcome = "initial"

    # ---------------------------------------------------------------------------------------------- what is seen
    def possible(self) -> dict[str, Then]:
        """The events that can happen, and what each does."""
        found: dict[str, Then] = {}
        if self.outcome == "initial":
            found["MISSION_EV_START"] = self._start
        for path, (leaf, ok, fail) in self.pursued.items():
            stem = self.stems[path]
            if path not in self.in_error:
                found[f"{stem}_EV_OK"] = self._ending(path, ok)
            found[f"{stem}_EV_FAIL"] = self._ending(path, fail)
            if leaf.objective.timeout is not None:
                found[f"{stem}_EV_TIMEOUT"] = self._ending(path, fail)
        for name, device in self.hardware.items():
            if device.may_fail and name not in self.lost:
                found[f"{name}_EV_OOS"] = lambda name=name: self._lose(name)  # type: ignore[misc]
            if device.may_fail and device.may_recover and name in self.lost:
                found[f"{name}_EV_RD"] = lambda name=name: self._recover(name)  # type: ignore[misc]
        return found

    def step(self, event: str) -> None:
        """An event, and all that follows it."""
        self.possible()[event]()
        self._rest()
        self._errors()

    def view(self) -> StateView:
        """As the graph shows a state, each list sorted."""
        running = {(name, self.activities[name].alternatives[at].name) for name, at in self.runs.items()}
        outcome = self.outcome if self.outcome in ("success", "failure") else ""
        lists = sorted(self.pursued), sorted(running), sorted(self.lost), sorted(self.failed)
        return StateView(tuple(lists[0]), tuple(lists[1]), tuple(lists[2]), outcome, tuple(lists[3]))

    # ---------------------------------------------------------------------------------------------- events
    def _start(self) -> None:
        self.outcome = ""
        self._enter(self.root, lambda: self._end("success"), lambda: self._end("failure"))

    def _end(self, outcome: str) -> None:
        self.outcome = outcome

    def _ending(self, path: str, then: Then) -> Then:
        def end() -> None:
            del self.pursued[path]
            self.in_error.discard(path)
            self._rest()
            then()

        return end

    def _lose(self, device: str) -> None:
        self.lost.add(device)
        self._gone(device)

    def _recover(self, device: str) -> None:
        """Those that upgrade judge anew, producers first, where a better alternative depends on the device."""
        self.lost.remove(device)
        for name in self.order:
            activity = self.activities[name]
            better = activity.alternatives[: self.runs.get(name, 0)]
            if activity.on_recovery is OnRecovery.UPGRADE and any(device in self._below(one) for one in better):
                self._judge_anew(name)
                self._rest()

    def _below(self, alternative: Alternative) -> set[str]:
        found = set(alternative.consumes)
        for resource in alternative.consumes:
            if resource in self.maker:
                for one in self.activities[self.maker[resource]].alternatives:
                    found |= self._below(one)
        return found

    # ---------------------------------------------------------------------------------------------- activities
    def _asked(self, name: str) -> bool:
        """Whether an objective asks for it."""
        return any(name in leaf.objective.activities for leaf, _, _ in self.pursued.values())

    def _rest(self) -> None:
        """Until no activity judges, none runs in vain, and none that is asked for is idle."""
        while True:
            judge = next((name for name in self.order if name in self.judging), None)
            if judge is not None:
                self._judge(judge)
                continue
            self.failed = {name for name in self.failed if self._asked(name)}
            waiting = [name for name in self.order if self._asked(name) and name not in {*self.runs, *self.failed}]
            if waiting:
                self._judge(waiting[0])
                continue
            vain = next((name for name in self.order if name in self.runs and not self._wanted(name)), None)
            if vain is None:
                return
            del self.runs[vain]
            self.offered[vain] = set()
            self.holds = {(user, resource) for user, resource in self.holds if user != vain}

    def _wanted(self, name: str) -> bool:
        return self._asked(name) or any(self.maker.get(resource) == name for _, resource in self.holds)

    def _gone(self, resource: str) -> None:
        for user in [user for user, held in self.holds if held == resource]:
            self._judge_anew(user)

    def _judge_anew(self, name: str) -> None:
        """It gives back all it holds; what it offers stays up."""
        self.holds = {(user, resource) for user, resource in self.holds if user != name}
        self.runs.pop(name, None)
        self.judging.add(name)

    def _judge(self, name: str) -> None:
        """Takes the best alternative that is possible; what it does not offer goes down."""
        self.judging.discard(name)
        offers: set[str] = set()
        for index, way in enumerate(self.activities[name].alternatives):
            if self._possible(way):
                self.holds |= {(name, resource) for resource in way.consumes}
                self.runs[name] = index
                offers = set(way.produces)
                break
        else:
            if self._asked(name):
                self.failed.add(name)
        withdrawn, self.offered[name] = self.offered[name] - offers, offers
        for resource in withdrawn:
            self._gone(resource)

    def _possible(self, way: Alternative) -> bool:
        """Whether all it consumes is to be had; producers start for it."""
        if self.lost & set(way.consumes):
            return False
        provided = [self._provided(one) for one in way.consumes if one not in self.hardware]
        return all(provided)

    def _provided(self, resource: str) -> bool:
        maker = self.maker[resource]
        if maker in self.judging or (maker not in self.runs and maker not in self.failed):
            self._judge(maker)
        return resource in self.offered[maker]

    def _producers_first(self) -> Iterator[str]:
        done: set[str] = set()

        def visit(activity: Activity) -> Iterator[str]:
            if activity.name not in done:
                done.add(activity.name)
                for resource in activity.consumes:
                    if resource in self.maker:
                        yield from visit(self.activities[self.maker[resource]])
                yield activity.name

        for one in self.mission.activities:
            yield from visit(one)

    # ---------------------------------------------------------------------------------------------- objectives
    def _errors(self) -> None:
        """An objective one of whose activities has failed waits for its failure to be reported."""
        for path, (leaf, _, _) in self.pursued.items():
            if self.failed & set(leaf.objective.activities):
                self.in_error.add(path)

    def _enter(self, node: Node, ok: Then, fail: Then) -> None:
        match node:
            case Leaf(path):
                self.pursued[path] = (node, ok, fail)
                self._rest()
                self._errors()
            case Series(_, links):
                self._after(list(links), ok, fail)
            case Fork(_, children):
                results: list[bool] = []

                def ended(good: bool) -> None:
                    results.append(good)
                    if len(results) == len(children):
                        (ok if all(results) else fail)()

                for link, mandatory in children:
                    self._step(link, lambda: ended(True), lambda needed=mandatory: ended(not needed))  # type: ignore[misc]

    def _after(self, links: list[Link], ok: Then, fail: Then) -> None:
        if not links:
            ok()
        else:
            self._step(links[0], lambda: self._after(links[1:], ok, fail), fail)

    def _step(self, link: Link, ok: Then, fail: Then, tried: int = 0) -> None:
        match link.step.on_failure:
            case Continue():
                self._enter(link.node, ok, ok)
            case Retry(times) if tried < times:
                self._enter(link.node, ok, lambda: self._step(link, ok, fail, tried + 1))
            case Recover(_, resume) if link.recovery is not None:
                recovery = link.recovery
                self._enter(link.node, ok, lambda: self._enter(recovery, ok if resume else fail, fail))
            case _:
                self._enter(link.node, ok, fail)
