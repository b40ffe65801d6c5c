"""What a plan must satisfy for its net to be sound, and what a net must satisfy by its shape."""

from __future__ import annotations

from collections import Counter

from mauve.mission.cones import Wiring
from mauve.mission.flatten import Fork, Node, Series, flatten, leaves
from mauve.mission.net import Level, Net
from mauve.mission.plan import Mission


def faults(mission: Mission) -> tuple[str, ...]:
    """Why a plan has no sound net, each as a sentence; none if it has one. Contention is looked for elsewhere."""
    wiring = Wiring(mission)
    root = flatten(mission)
    resources = [*(one.name for one in mission.hardware), *(one.name for one in mission.software)]
    counted = Counter([*resources, *(one.name for one in mission.activities)])
    found = [f"{name} is declared {times} times" for name, times in counted.items() if times > 1]
    software = {one.name for one in mission.software}
    makers: dict[str, list[str]] = {}
    for activity in mission.activities:
        if not activity.alternatives:
            found.append(f"{activity.name} has no alternative")
        ways = Counter(one.name for one in activity.alternatives)
        found += [
            f"{activity.name} has {times} alternatives called {name}" for name, times in ways.items() if times > 1
        ]
        for name in activity.produces:
            makers.setdefault(name, []).append(activity.name)
            if name not in software:
                found.append(f"{activity.name} produces {name}, which is no software resource")
        unknown = [name for name in activity.consumes if name not in resources]
        found += [f"{activity.name} consumes {name}, which is not declared" for name in unknown]
    found += [f"{name} is produced by {' and '.join(names)}" for name, names in makers.items() if len(names) > 1]
    consumed = [name for name in wiring.consumers if name in software and name not in makers]
    found += [f"{name} is consumed and produced by no activity" for name in consumed]
    found += [f"{' needs '.join((*cycle, cycle[0]))}" for cycle in production_cycles(mission)]
    for leaf in leaves(root):
        unknown = [name for name in leaf.objective.activities if name not in wiring.activities]
        found += [f"{leaf.path} does {name}, which is no activity" for name in unknown]
    found += [f"{path} has no mandatory objective" for path in _optional_only(root)]
    return tuple(found)


def production_cycles(mission: Mission) -> tuple[tuple[str, ...], ...]:
    """Activities that need each other's products, through some alternative: one shortest cycle for each that is in one.

    In such a cycle each can wait for the other for ever, even where another alternative avoids it.
    """
    wiring = Wiring(mission)
    needs = {
        one.name: tuple(dict.fromkeys(wiring.producers[name] for name in one.consumes if name in wiring.producers))
        for one in mission.activities
    }
    cycles: dict[frozenset[str], tuple[str, ...]] = {}
    for start in needs:
        paths: list[tuple[str, ...]] = [(start,)]
        seen: set[str] = set()
        for path in paths:
            after = needs.get(path[-1], ())
            if start in after:
                cycles.setdefault(frozenset(path), path)
                break
            paths.extend((*path, one) for one in after if one not in seen)
            seen.update(after)
    return tuple(cycles.values())


def _optional_only(node: Node) -> list[str]:
    """The parallel blocks of a tree of which no child is mandatory."""
    found: list[str] = []
    match node:
        case Series(_, links):
            inner = list(links)
        case Fork(path, children):
            inner = [link for link, _ in children]
            found += [] if any(mandatory for _, mandatory in children) else [path]
        case _:
            inner = []
    for link in inner:
        found += _optional_only(link.node)
        found += _optional_only(link.recovery) if link.recovery is not None else []
    return found


def verify(net: Net) -> tuple[str, ...]:
    """What is wrong with the shape of a net, each as a sentence; nothing for a net of the templates.

    Names are unique; each transition needs a place and consumes one; only transitions of level 0 have events, and all
    of them; the places of each unit keep one token.
    """
    found = [f"the place {name} stands twice" for name, times in Counter(net.places).items() if times > 1]
    names = Counter(one.name for one in net.transitions)
    found += [f"the transition {name} stands twice" for name, times in names.items() if times > 1]
    events = {event.name for event in net.events}
    for one in net.transitions:
        before, after = set(one.before), set(one.after)
        if not before - after:
            found.append(f"the transition {one.name} consumes nothing")
        if len(before) < len(one.before) or len(after) < len(one.after):
            found.append(f"the transition {one.name} names a place twice")
        if (one.level is Level.EVENT) != (one.event in events):
            found.append(f"the transition {one.name} has the event {one.event!r} at level {int(one.level)}")
    return (*found, *_leaking_units(net))


def _leaking_units(net: Net) -> tuple[str, ...]:
    found = []
    for unit in net.units:
        places = frozenset(unit)
        if len(places & frozenset(net.initial)) != 1:
            found.append(f"the places around {net.places[unit[0]]} do not have one token at first")
        for one in net.transitions:
            taken, given = len(places.intersection(one.before)), len(places.intersection(one.after))
            if taken != given or taken > 1:
                found.append(f"the transition {one.name} changes the tokens around {net.places[unit[0]]}")
    return tuple(found)
