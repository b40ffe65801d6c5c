"""Periods of regions and instances (seed 000, equations (1) and (3): greatest common divisors)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import gcd

from mauve.model.model import Component, Instance, Region, RunCodel, Step


def region_period(region: Region, around: int | None) -> int | None:
    """The period of a region: the gcd of those of its activities, where one of them is periodic; else `around`, that of
    the region or the instance around it; where there is none either, what the separations of its `once` activities or
    its nested regions say. None where nothing gives one."""
    activities = [activity for state in region.states for activity in state.activities]
    periods = [period for activity in activities if (period := activity.every or activity.apart)]
    if around is None or any(activity.every for activity in activities):
        around = common_period(periods) or around
    return around or common_period(
        period for state in region.states for nested in state.regions if (period := region_period(nested, None))
    )


def instance_period(instance: Instance) -> int | None:
    """How often an instance as a whole is activated: the gcd of the periods of its regions, its own for those that
    have none. None where nothing says it."""
    own = _own(instance)
    periods = [region_period(region, own) for region in instance.component.regions] or [own]
    known = [period for period in periods if period is not None]
    return gcd(*known) if known and len(known) == len(periods) else None


def reading_period(instance: Instance, port: str) -> int | None:
    """The longest time between two activations of a region of a periodic instance that reads a port: what arrives
    in between waits. That of the instance where no region does."""
    found = [
        period
        for region, period in _activated(instance.component.regions, _own(instance))
        if any(port in _read(step, instance.component) for step in _steps(region))
    ]
    return instance_period(instance) if not found or None in found else max(p for p in found if p is not None)


def region_periods(instance: Instance) -> tuple[int, ...]:
    """The periods of all regions of an instance, nested ones included, that have one."""
    return tuple(period for _, period in _activated(instance.component.regions, _own(instance)) if period is not None)


def _own(instance: Instance) -> int | None:
    return instance.period.value if instance.period is not None else None


def _activated(regions: tuple[Region, ...], around: int | None) -> Iterator[tuple[Region, int | None]]:
    """Regions and those nested in them, with how often they are activated."""
    for region in regions:
        period = region_period(region, around)
        yield region, period
        for state in region.states:
            yield from _activated(state.regions, period)


def _steps(region: Region) -> Iterator[Step]:
    """The steps and guards of the states of a region."""
    for state in region.states:
        for activity in state.activities:
            yield from activity.steps
        for transition in state.transitions:
            yield from (*transition.guards, *transition.do)


def _read(step: Step, component: Component) -> tuple[str, ...]:
    return component.codel(step.codel).reads if isinstance(step, RunCodel) else step.arguments


def common_period(periods: Iterable[int]) -> int | None:
    """The gcd of some periods; None for none."""
    known = list(periods)
    return gcd(*known) if known else None
