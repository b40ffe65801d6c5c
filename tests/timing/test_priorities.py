"""Assignments of priorities against all permutations, and ranges against one analysis for each priority."""

from __future__ import annotations

import random
import time
from itertools import permutations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.records import changed
from mauve.timing.priorities import Policy, assign, optimal, priority_ranges, rate_monotonic, with_priorities
from mauve.timing.response import analyse
from mauve.timing.task import Kind, Section, Task, constant


def task(name: str, period: int, cost: int, deadline: int = 0, priority: int = 0, **rest: object) -> Task:
    return Task(name, priority, period, deadline or period, (constant(name, cost),), **rest)  # type: ignore[arg-type]


LEHOCZKY = [task("t1", 100, 52, 110), task("t2", 140, 52, 154)]
"""Lehoczky 1990, example 2: both monotonic orders put t1 above t2, and miss."""


def test_audsley_finds_what_both_monotonic_orders_miss() -> None:
    for policy in (Policy.RATE_MONOTONIC, Policy.DEADLINE_MONOTONIC):
        assert not analyse(with_priorities(LEHOCZKY, assign(LEHOCZKY, policy))).schedulable
    found = assign(LEHOCZKY, Policy.OPTIMAL)
    assert found.priorities == (("t1", 1), ("t2", 2))
    assert analyse(with_priorities(LEHOCZKY, found)).schedulable


def test_what_no_assignment_schedules_names_the_tasks_that_are_stuck() -> None:
    found = optimal([task("a", 10, 6), task("b", 10, 5), task("c", 100, 1, 1000)])
    assert found.priorities is None
    assert set(found.stuck) <= {"a", "b", "c"} and len(found.stuck) >= 2
    with pytest.raises(ValueError, match="no assignment"):
        with_priorities([], found)


def test_given_priorities_stay_and_interrupts_come_above() -> None:
    irq = Task("irq", 9, 50, 50, (constant("irq", 1),), kind=Kind.INTERRUPT)
    tasks = [irq, task("a", 20, 2, priority=7), task("b", 10, 2, priority=3)]
    assert assign(tasks, Policy.GIVEN).priorities == (("a", 7), ("b", 3))
    assert [one.priority for one in with_priorities(tasks, assign(tasks, Policy.RATE_MONOTONIC))] == [3, 1, 2]


@st.composite
def sets(draw: st.DrawFn) -> list[Task]:
    """Up to four tasks with sections, jitter, arbitrary deadlines, some never preempted."""
    tasks = []
    for number in range(draw(st.integers(2, 4))):
        period = draw(st.integers(5, 20))
        cost = draw(st.integers(1, 6))
        name = f"t{number}"
        resources = draw(st.lists(st.sampled_from("rs"), max_size=2, unique=True))
        sections = tuple(Section(r, name, r, draw(st.integers(1, cost))) for r in resources)
        tasks.append(
            task(
                name,
                period,
                cost,
                draw(st.integers(period // 2, 2 * period)),
                draw(st.integers(1, 4)),
                jitter=draw(st.integers(0, 3)),
                sections=sections,
                preemptive=draw(st.integers(0, 3)) > 0,
            )
        )
    return tasks


def holds(tasks: list[Task], order: tuple[int, ...]) -> bool:
    return analyse([changed(one, priority=p) for one, p in zip(tasks, order, strict=True)], steps=4000).schedulable


@settings(max_examples=50, deadline=None)
@given(sets())
def test_an_assignment_is_found_exactly_when_one_exists(tasks: list[Task]) -> None:
    found = optimal(tasks, steps=4000)
    any_order = any(holds(tasks, order) for order in permutations(range(1, len(tasks) + 1)))
    assert (found.priorities is not None) == any_order
    if found.priorities is not None:
        assert holds(tasks, tuple(priority for _, priority in found.priorities))


@settings(max_examples=30, deadline=None)
@given(sets())
def test_the_ranges_are_the_priorities_that_hold(tasks: list[Task]) -> None:
    for place, one in enumerate(priority_ranges(tasks, steps=4000)):
        for priority in range(-1, 7):
            moved = [changed(t, priority=priority) if at == place else t for at, t in enumerate(tasks)]
            assert (priority in one) == analyse(moved, steps=4000).schedulable


def test_ranges_are_intervals_with_open_ends() -> None:
    tasks = [task("a", 10, 2, priority=5), task("b", 20, 3, 4, priority=9), task("c", 1000, 10, priority=2)]
    a, b, c = priority_ranges(tasks)
    assert a.ranges == ((3, 8),)
    assert b.ranges == ((6, None),)
    assert c.ranges == ((None, 4),)
    assert priority_ranges(tasks[:1])[0].ranges == ((None, None),)


def random_set(count: int, rng: random.Random) -> list[Task]:
    shares = [rng.random() for _ in range(count)]
    periods = [int(10 ** rng.uniform(4, 6)) for _ in range(count)]
    costs = [max(1, int(0.7 * s / sum(shares) * t)) for s, t in zip(shares, periods, strict=True)]
    ranks = rate_monotonic(periods)
    return [task(f"t{n}", t, c, 0, ranks[n]) for n, (t, c) in enumerate(zip(periods, costs, strict=True))]


def test_fifty_tasks_take_well_under_a_second() -> None:
    tasks = random_set(50, random.Random(1))
    start = time.process_time()
    assert optimal(tasks).priorities is not None
    assert all(one.now in one for one in priority_ranges(tasks))
    assert time.process_time() - start < 2, "ten times the usual"
