"""A mission as one Petri net: the templates of its resources, activities and objectives, connected.

Five levels of priority, where the paper has two, keep it 1-safe and its outcome independent of the order of internal
steps: resources first, then the choice of alternatives, then the stop of what nobody asks for, then the mission.
"""

from __future__ import annotations

from collections.abc import Mapping

from mauve.mission.activities import Parts, activity_template, reachable
from mauve.mission.cones import Wiring
from mauve.mission.draft import Draft
from mauve.mission.flatten import askers, flatten
from mauve.mission.net import Event, EventKind, Level, Net
from mauve.mission.objectives import mission_template
from mauve.mission.plan import Hardware, Mission, OnRecovery
from mauve.mission.resources import Access, Product, exclusive, hardware, shared
from mauve.records import changed


def build_net(mission: Mission, stems: Mapping[str, str] | None = None) -> Net:
    """The net of a mission that has no `faults`: hardware, software, activities, then the tree of objectives.

    stems: by path, what the events of an elementary objective are named after; if None the shortest unique ending.
    """
    draft = Draft(mission.name)
    wiring = Wiring(mission)
    root = flatten(mission)
    widths = askers(root)
    upgrading = {one.name: _upgrading(wiring, one) for one in mission.hardware}
    news: dict[str, tuple[int, ...]] = {}
    accesses: dict[str, dict[str, Access]] = {one.name: {} for one in mission.activities}
    for one in mission.hardware:
        consumers = wiring.consumers.get(one.name, ())
        chain = range(len(upgrading[one.name]))
        news[one.name] = tuple(draft.place(one.name, f"news{index + 1}", transient=True) for index in chain)
        first = news[one.name][0] if chain else None
        access = hardware(draft, one, len(consumers) > 1, first)
        for consumer in consumers:
            accesses[consumer][one.name] = access
    products: dict[str, dict[str, Product]] = {one.name: {} for one in mission.activities}
    for software in mission.software:
        consumers = wiring.consumers.get(software.name, ())
        if software.shared and consumers:
            product, given = shared(draft, software, consumers)
        else:
            product, access = exclusive(draft, software, len(consumers) > 1)
            given = dict.fromkeys(consumers, access)
        for consumer in consumers:
            accesses[consumer][software.name] = given[consumer]
        if software.name in wiring.producers:
            products[wiring.producers[software.name]][software.name] = product
    parts = {
        one.name: activity_template(draft, one, widths.get(one.name, 0), accesses[one.name], products[one.name])
        for one in mission.activities
    }
    for one in mission.hardware:
        _upgrades(draft, wiring, one, upgrading[one.name], news[one.name], parts)
    mission_template(draft, root, parts, stems)
    return draft.net()


def hardware_alone(resource: Hardware) -> Net:
    """A hardware resource in the environment of figure 10, which takes it, gives it back, and accepts its loss.

    ERROROK is an internal step, though the figure calls it an event: the text lists the state before it as transient.
    """
    draft = Draft(resource.name)
    name = resource.name
    access = hardware(draft, resource, contended=False, crossing=False)
    other = EventKind.OTHER
    take, release = Event(f"{name}_EV_TAKE", other, name), Event(f"{name}_EV_RELEASE", other, name)
    draft.fire(f"{name}.TAKE", Level.EVENT, (access.available,), (access.take,), event=take)
    draft.fire(f"{name}.RELEASE", Level.EVENT, (access.answer,), (access.release,), event=release)
    if access.error is not None:
        draft.fire(f"{name}.ERROROK", Level.RESOURCE, (access.answer, access.error), ())
    net = draft.net()
    around = sorted(net.transitions, key=lambda one: 0 if one.event in (take.name, release.name) else 1)
    return changed(net, transitions=tuple(around))


def _upgrading(wiring: Wiring, resource: Hardware) -> tuple[str, ...]:
    """The activities that evaluate again when a resource recovers, each after those whose products it can need.

    Each is one that wants to upgrade, and of which some alternative but the last depends on the resource.
    """
    if not (resource.may_fail and resource.may_recover):
        return ()
    return tuple(
        one.name
        for one in wiring.producers_first()
        if one.on_recovery is OnRecovery.UPGRADE and resource.name in wiring.below(reachable(one)[:-1])
    )


def _upgrades(
    draft: Draft,
    wiring: Wiring,
    resource: Hardware,
    upgrading: tuple[str, ...],
    news: tuple[int, ...],
    parts: Mapping[str, Parts],
) -> None:
    """The news of a recovery passes from activity to activity; one that runs a lesser alternative evaluates again.

    Its level is below that of stops, so that each acts on what the one before it has settled.
    """
    level = Level.MISSION
    for index, name in enumerate(upgrading):
        part, alternatives = parts[name], reachable(wiring.activities[name])
        here, onward = news[index], news[index + 1 : index + 2]
        label = f"{name}.upgrade({resource.name})"
        draft.fire(f"{label}.idle", level, (here,), onward, reads=(part.idle,))
        if part.failed is not None:
            draft.fire(f"{label}.failed", level, (here,), onward, reads=(part.failed,))
        for number, (run, back) in enumerate(zip(part.runs, part.restarts, strict=True)):
            if resource.name in wiring.below(alternatives[:number]):
                draft.fire(f"{label}.{number + 1}", level, (here, run), (part.first, *back, *onward))
            else:
                draft.fire(f"{label}.{number + 1}", level, (here,), onward, reads=(run,))
