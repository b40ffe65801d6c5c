"""Sensitivities against plain search: the last value that holds, and the first that does not."""

from __future__ import annotations

import random
import time
from collections.abc import Sequence
from fractions import Fraction

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.records import changed
from mauve.timing.psm import CostPart, PsmTransition, make_psm
from mauve.timing.response import analyse
from mauve.timing.sensitivity import cost_slacks, lowest_speed, period_slacks, sensitivity
from mauve.timing.shrink import What
from mauve.timing.task import Section, Task, constant, machine, total_load
from mauve.timing.traces import altered

from .systems import systems
from .test_priorities import random_set, sets, task


def holds(tasks: Sequence[Task]) -> bool:
    return analyse(tasks, steps=4000).schedulable


def test_the_slacks_of_a_textbook_set() -> None:
    tasks = [task("c", 30, 10, priority=3), task("b", 40, 10, priority=2), task("a", 50, 12, priority=1)]
    found = sensitivity(tasks)
    assert [(one.name, one.now, one.at_most) for one in found.costs] == [("c", 10, 9), ("b", 10, 9), ("a", 12, 10)]
    # a: 12 + 2 x 10 + 2 x 10 = 52 by 50; at 40 and at 30 it needs more still.
    assert found.speed.factor == Fraction(52, 50) and found.speed.exact


def with_work(tasks: list[Task], place: int, at: int, more: int) -> list[Task]:
    one = tasks[place]
    work = list(one.work)
    work[at] = changed(work[at], curve=altered(work[at].curve, more=more))
    return [*tasks[:place], changed(one, work=tuple(work)), *tasks[place + 1 :]]


@settings(max_examples=30, deadline=None)
@given(st.one_of(sets(), systems()))
def test_each_cost_may_grow_so_much_and_no_more(tasks: list[Task]) -> None:
    if not holds(tasks):
        return
    for slack in cost_slacks(tasks, steps=4000):
        if slack.what is not What.WORK:
            continue
        place = next(at for at, one in enumerate(tasks) if one.name == slack.task)
        parts = [(part.name, part.curve.total(1)) for part in tasks[place].work]
        work = parts.index((slack.name, slack.now))
        assert slack.growth is not None and slack.growth >= 0
        assert holds(with_work(tasks, place, work, slack.growth))
        assert not holds(with_work(tasks, place, work, slack.growth + 1))


@settings(max_examples=30, deadline=None)
@given(sets())
def test_each_period_may_shrink_so_much_and_no_more(tasks: list[Task]) -> None:
    for place, slack in enumerate(period_slacks(tasks, steps=4000)):

        def at(period: int, place: int = place) -> list[Task]:
            return [changed(one, period=period) if n == place else one for n, one in enumerate(tasks)]

        if slack.at_least is None:
            assert not holds(at(10 * slack.now))
        else:
            assert holds(at(slack.at_least))
            assert slack.at_least == 1 or not holds(at(slack.at_least - 1))


@settings(max_examples=30, deadline=None)
@given(st.one_of(sets(), systems(overhead=False)))
def test_the_lowest_speed_holds_and_less_does_not(tasks: list[Task]) -> None:
    found = lowest_speed(tasks, steps=4000)
    if found.factor is None or found.factor == 0:
        return

    def at(speed: Fraction) -> list[Task]:
        slower, times = speed.denominator, speed.numerator
        return [
            changed(
                one,
                period=one.period * times,
                deadline=one.deadline * times,
                jitter=one.jitter * times,
                overhead=one.overhead * slower,
                work=tuple(
                    changed(part, curve=altered(part.curve, times=slower), period=part.period * times)
                    for part in one.work
                ),
                sections=tuple(changed(section, length=section.length * slower) for section in one.sections),
            )
            for one in tasks
        ]

    assert holds(at(found.factor))
    less = found.factor - Fraction(1, 2**23)
    # Close to a load of 1 busy periods become too long for a proof, and then the lowest that is proven is given.
    assert less <= 0 or found.factor < total_load(tasks) * Fraction(1001, 1000) or not holds(at(less))


def test_a_codel_grows_in_every_transition_and_section_that_runs_it() -> None:
    def with_cost(cost: int) -> list[Task]:
        part = CostPart("C.use", cost)
        psm = make_psm(
            "m",
            "s",
            [
                PsmTransition("s", "t", 1 + cost, parts=(CostPart("C.step", 1), part)),
                PsmTransition("t", "s", 2 * cost, parts=(CostPart("C.use", 2 * cost, 2),)),
            ],
        )
        low = Task("low", 1, 40, 40, (machine(psm),), sections=(Section("r", "low", "use", cost, "C.use"),))
        return [low, Task("high", 2, 20, 9, (constant("high", 3),), sections=(Section("r", "high", "", 1),))]

    found = {one.name: one for one in cost_slacks(with_cost(4)) if one.what is What.CODEL}
    # high: 3 + blocking <= 9, so 6; low alone would allow more.
    assert (found["C.use"].now, found["C.use"].at_most, found["C.use"].growth) == (4, 6, 2)
    assert holds(with_cost(6)) and not holds(with_cost(7))


def test_jitters_that_follow_from_responses_are_settled_at_each_probe() -> None:
    tasks = [task("a", 20, 4, priority=2), task("b", 20, 5, 16, priority=1)]

    def settle(changed_tasks: Sequence[Task]) -> list[Task] | None:
        first = analyse(changed_tasks).result("a").wcrt
        return None if first is None else [changed_tasks[0], changed(changed_tasks[1], jitter=first)]

    # b: J + a + b = 2 a + 5 <= 16
    found = cost_slacks(tasks, settle=settle)
    assert [(one.name, one.at_most) for one in found] == [("a", 5), ("b", 8)]
    assert cost_slacks(tasks)[0].at_most == 11


def test_what_cannot_be_mended_is_none() -> None:
    tasks = [task("a", 10, 6, priority=2), task("b", 100, 5, 10, priority=1, jitter=11)]
    found = sensitivity(tasks)
    assert all(one.at_most is None for one in found.costs)
    assert all(one.at_least is None for one in found.periods)
    assert found.speed.factor is None
    assert lowest_speed([task("z", 10, 0)]).factor == 0


@pytest.mark.parametrize("load", [0.7])
def test_fifty_tasks_take_about_a_second(load: float) -> None:
    tasks = random_set(50, random.Random(2))
    start = time.process_time()
    found = sensitivity(tasks)
    assert time.process_time() - start < 8, "ten times the usual"
    assert found.speed.factor is not None and found.speed.factor < 1
