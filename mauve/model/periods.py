"""Periods of regions and instances (seed 000, equations (1) and (3): greatest common divisors)."""

from __future__ import annotations

from collections.abc import Iterable
from math import gcd

from mauve.model.model import Activity, Instance, Region


def region_period(region: Region) -> int | None:
    """The period of a region: the gcd of those of its activities; where none has one, of those of its nested regions;
    None where nothing gives one (it then steps with what surrounds it)."""
    own = common_period(
        period for state in region.states for activity in state.activities if (period := activity_period(activity))
    )
    return own or common_period(
        period for state in region.states for nested in state.regions if (period := region_period(nested))
    )


def activity_period(activity: Activity) -> int | None:
    """`every` of an activity, or the least separation of a `once` activity where one is given."""
    return activity.every or activity.apart or None


def instance_period(instance: Instance) -> int | None:
    """How often an instance as a whole is activated: the gcd of the periods of its regions, its own for those that
    have none. None where nothing says it."""
    regions = [region_period(region) for region in instance.component.regions]
    own = instance.period.value if instance.period is not None else None
    periods = [period or own for period in regions] or [own]
    known = [period for period in periods if period is not None]
    return gcd(*known) if known and len(known) == len(periods) else None


def common_period(periods: Iterable[int]) -> int | None:
    """The gcd of some periods; None for none."""
    known = list(periods)
    return gcd(*known) if known else None
