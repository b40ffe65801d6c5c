"""Periods and priorities: written, missing, contradicting."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st
from written import BOARD, model_of

from mauve.model.model import Setting
from mauve.model.periods import instance_period, region_periods
from mauve.model.priorities import contradiction, rate_monotonic
from mauve.units import MS

TASKS = st.lists(st.tuples(st.integers(1, 9), st.none() | st.integers(0, 6)), max_size=12)


def test_a_shorter_period_is_more_urgent_and_ties_go_by_order() -> None:
    assert rate_monotonic([(10, None), (1, None), (10, None), (5, None)]) == (2, 4, 1, 3)
    assert rate_monotonic([]) == ()


def test_missing_priorities_go_between_the_written_ones() -> None:
    assert rate_monotonic([(10, 20), (1, None), (100, None), (10, None)]) == (20, 21, 0 + 1, 2)
    assert rate_monotonic([(1, 3), (5, None), (10, 2)]) == (3, 2, 2), "no number is left: the lower one is shared"


@given(TASKS)
def test_written_priorities_stay_and_missing_ones_follow_the_periods(tasks: list[tuple[int, int | None]]) -> None:
    found = rate_monotonic(tasks)
    assert all(priority in (None, given) for (_, priority), given in zip(tasks, found, strict=True))
    missing = sorted((period, index) for index, (period, priority) in enumerate(tasks) if priority is None)
    ranks = [found[index] for _, index in missing]
    assert ranks == sorted(ranks, reverse=True)
    assert all(rank >= 0 for rank in found)


@given(TASKS)
def test_without_written_ones_all_differ(tasks: list[tuple[int, int | None]]) -> None:
    found = rate_monotonic([(period, None) for period, _ in tasks])
    assert sorted(found) == list(range(1, len(tasks) + 1))


@given(st.lists(st.tuples(st.integers(1, 5), st.integers(1, 5)), max_size=8))
def test_a_contradiction_is_a_pair_that_contradicts_and_is_found_if_there_is_one(pairs: list[tuple[int, int]]) -> None:
    tasks = [(f"t{n}", period, priority) for n, (period, priority) in enumerate(pairs)]
    found = contradiction(tasks)
    by_name = {task[0]: task for task in tasks}
    if found is None:
        assert not any(a[1] < b[1] and a[2] < b[2] for a in tasks for b in tasks)
    else:
        low, high = by_name[found[0]], by_name[found[1]]
        assert low[1] < high[1] and low[2] < high[2]


def _instance(regions: str, attributes: str) -> str:
    return f"""
component Worker {{
  codel work wcet 1ms
  behaviour {{
{regions}
  }}
}}
architecture R {{
  instance w: Worker {{ {attributes} }}
}}
{BOARD}
deployment d of R {{
  node n on desk {{
  }}
}}
"""


def _region(name: str, run: str) -> str:
    return f"region {name} {{\n initial state On {{\n {run}\n }}\n }}\n"


def test_the_period_of_an_instance_is_the_gcd_of_its_regions() -> None:
    regions = _region("a", "run work every 100ms") + _region("b", "run work once, at least 150ms apart")
    model = model_of(_instance(regions, "priority 1"))
    assert instance_period(model.architectures[0].instances[0]) == 50 * MS
    regions = _region("a", "run work every 100ms") + _region("b", "run work")
    model = model_of(_instance(regions, "priority 1  period 30ms"))
    assert instance_period(model.architectures[0].instances[0]) == 10 * MS


def test_neither_separations_nor_nested_periods_slow_down_what_has_a_period() -> None:
    slow = _region("a", "run work once, at least 150ms apart")
    model = model_of(_instance(slow, "priority 1  period 30ms"))
    assert instance_period(model.architectures[0].instances[0]) == 30 * MS
    nested = _region("a", "run work\n" + _region("b", "run work every 90ms"))
    model = model_of(_instance(nested, "priority 1  period 30ms"))
    (instance,) = model.architectures[0].instances
    assert instance_period(instance) == 30 * MS and region_periods(instance) == (30 * MS, 90 * MS)


def test_defaults_are_marked() -> None:
    model = model_of(_instance(_region("a", "run work"), "period 30ms"))
    (instance,) = model.architectures[0].instances
    assert instance.priority == Setting(1, None, "rate monotonic")
    assert instance.deadline == Setting(30 * MS, None, "the period")
    model = model_of(_instance(_region("a", "run work"), "period 30ms  priority 7  deadline 20ms"))
    (instance,) = model.architectures[0].instances
    assert instance.priority is not None and instance.priority.value == 7 and not instance.priority.default
