"""Random missions, mostly without activities that want one exclusive resource, and the features that each one has."""

from __future__ import annotations

from random import Random

from mauve.mission.cones import Wiring
from mauve.mission.contention import contentions
from mauve.mission.flatten import flatten, leaves
from mauve.mission.plan import (
    Abort,
    Activity,
    Alternative,
    Child,
    Continue,
    Elementary,
    Hardware,
    Mission,
    OnFailure,
    OnRecovery,
    Parallel,
    Recover,
    Retry,
    Sequence,
    Software,
    Step,
)
from mauve.records import changed

FEATURES = ("overlap", "two products", "shared", "upgrade", "retry", "recover", "differing products", "parallel")


def random_mission(seed: int, contended: bool = False) -> Mission:
    """A mission of a few resources and objectives, drawn from a seed; free of contention unless `contended`."""
    random = Random(seed)
    hardware = tuple(
        Hardware(f"h{n}", may_fail=(fails := random.random() < 0.9), may_recover=fails and random.random() < 0.85)
        for n in range(random.randint(1, 4))
    )
    activities: list[Activity] = []
    software: list[Software] = []
    available = [one.name for one in hardware]
    for number in range(random.randint(1, 4)):
        made = [f"s{number}{letter}" for letter in "ab"[: random.choice((1, 1, 2))]]
        activities.append(_activity(random, f"p{number}", available, made))
        made = [one for one in made if one in activities[-1].produces]
        software += [Software(one, shared=random.random() < 0.4) for one in made]
        available += made
    users = [_activity(random, f"a{n}", available, []) for n in range(random.randint(1, 4))]
    activities += users
    names = [one.name for one in users] + [one.name for one in activities if random.random() < 0.15]
    root = _block(random, "root", names, 2)
    mission = Mission("random", root, tuple(activities), tuple(software), hardware)
    return _used(mission if contended else _without_contention(random, mission))


def features(mission: Mission) -> set[str]:
    """Which of FEATURES a mission has."""
    found = set()
    for one in mission.activities:
        sets = [set(alternative.consumes) for alternative in one.alternatives]
        offers = {frozenset(alternative.produces) for alternative in one.alternatives}
        pairs = [(x, y) for number, x in enumerate(sets) for y in sets[number + 1 :]]
        found |= {"overlap"} if any(x & y and x != y for x, y in pairs) else set()
        found |= {"two products"} if any(len(alternative.produces) > 1 for alternative in one.alternatives) else set()
        found |= {"differing products"} if len(offers) > 1 else set()
        found |= {"upgrade"} if one.on_recovery is OnRecovery.UPGRADE and len(sets) > 1 else set()
    consumers = Wiring(mission).consumers
    found |= (
        {"shared"} if any(one.shared and len(consumers.get(one.name, ())) > 1 for one in mission.software) else set()
    )
    for step in _steps(mission.root):
        match step.on_failure:
            case Retry():
                found.add("retry")
            case Recover():
                found.add("recover")
            case _:
                pass
        found |= {"parallel"} if isinstance(step.block, Parallel) else set()
    return found


def _steps(block: Sequence | Parallel) -> list[Step]:
    own = list(block.steps) if isinstance(block, Sequence) else [child.step for child in block.children]
    below = []
    for step in own:
        if not isinstance(step.block, Elementary):
            below += _steps(step.block)
        if isinstance(step.on_failure, Recover):
            below += _steps(step.on_failure.block)
    return own + below


def _activity(random: Random, name: str, available: list[str], made: list[str]) -> Activity:
    common = random.choice(available) if random.random() < 0.4 else None
    alternatives = []
    for number in range(random.choice((1, 1, 2, 2, 3))):
        taken = random.sample(available, min(len(available), random.choice((1, 1, 2, 2, 3))))
        if common is not None and common not in taken:
            taken[0] = common
        if not made and random.random() < 0.08:
            taken = []
        offered = made if random.random() < 0.65 else random.sample(made, random.randint(0, len(made)))
        alternatives.append(Alternative(f"x{number}", tuple(taken), tuple(offered)))
    recovery = OnRecovery.UPGRADE if random.random() < 0.45 else OnRecovery.KEEP
    return Activity(name, tuple(alternatives), recovery)


def _block(random: Random, name: str, activities: list[str], depth: int) -> Sequence:
    steps = tuple(_step(random, f"{name}{n}", activities, depth) for n in range(random.choice((1, 1, 2, 2, 3))))
    return Sequence(name, steps)


def _step(random: Random, name: str, activities: list[str], depth: int, flat: bool = False) -> Step:
    kind = random.random()
    block: Elementary | Sequence | Parallel
    if depth and kind < 0.3 and not flat:
        count = random.choice((2, 2, 3))
        steps = [_step(random, f"{name}c{n}", activities, depth - 1, flat=random.random() < 0.7) for n in range(count)]
        needed = random.randrange(count)
        block = Parallel(name, tuple(Child(step, n == needed or random.random() < 0.5) for n, step in enumerate(steps)))
    elif depth and kind < 0.45 and not flat:
        block = _block(random, name, activities, depth - 1)
    else:
        count = min(len(activities), random.choice((0, 1, 1, 1, 2)))
        block = Elementary(name, tuple(random.sample(activities, count)), 10**12 if random.random() < 0.1 else None)
    return Step(block, _on_failure(random, name, activities, depth))


def _on_failure(random: Random, name: str, activities: list[str], depth: int) -> OnFailure:
    kind = random.random()
    if kind < 0.12:
        return Continue()
    if kind < 0.24:
        return Retry(random.randint(1, 2))
    if kind < 0.36 and depth:
        return Recover(_block(random, f"{name}r", activities, 0), resume=random.random() < 0.5)
    return Abort()


def _without_contention(random: Random, mission: Mission) -> Mission:
    """Shares what may be shared, and takes the rest from the second of two activities that want it."""
    while found := contentions(mission):
        one = found[0]
        software = {soft.name: soft for soft in mission.software}
        if one.resource in software and random.random() < 0.7:
            software[one.resource] = changed(software[one.resource], shared=True)
            mission = changed(mission, software=tuple(software.values()))
            continue
        loser = one.second[-2]
        activities = tuple(
            changed(activity, alternatives=tuple(_without(way, one.resource) for way in activity.alternatives))
            if activity.name == loser
            else activity
            for activity in mission.activities
        )
        mission = changed(mission, activities=activities)
    return mission


def _without(alternative: Alternative, resource: str) -> Alternative:
    return changed(alternative, consumes=tuple(one for one in alternative.consumes if one != resource))


def _used(mission: Mission) -> Mission:
    """Without what no objective needs."""
    wiring = Wiring(mission)
    needed = wiring.closure(name for leaf in leaves(flatten(mission)) for name in leaf.objective.activities)
    taken = wiring.resources(needed)
    activities = tuple(one for one in mission.activities if one.name in needed)
    made = {name for one in activities for name in one.produces}
    return changed(
        mission,
        activities=activities,
        software=tuple(one for one in mission.software if one.name in taken | made),
        hardware=tuple(one for one in mission.hardware if one.name in taken),
    )
