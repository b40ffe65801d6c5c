"""Periods of regions and threads (seed 000, equations (1) and (3): greatest common divisors)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from math import gcd

from mauve.model.model import Activity, Region


def region_period(region: Region) -> int | None:
    """The gcd of the periods of the region's activities, nested regions not included; None where none has one."""
    periods = [period for activity in own_activities(region) if (period := activity_period(activity))]
    return gcd(*periods) if periods else None


def own_activities(region: Region) -> Iterator[Activity]:
    """The activities of a region's states."""
    return (activity for state in region.states for activity in state.activities)


def activity_period(activity: Activity) -> int | None:
    """`every` of an activity, or the least separation of a `once` activity where one is given."""
    return activity.every or activity.apart or None


def common_period(periods: Iterable[int]) -> int | None:
    """The gcd of some periods; None for none."""
    known = list(periods)
    return gcd(*known) if known else None
