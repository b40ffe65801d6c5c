"""Tasks that are not preempted, last sections, and resources: the formula read literally, and unit steps."""

from __future__ import annotations

import random
from dataclasses import dataclass
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.records import changed
from mauve.timing.bill import deadline_bill, worst_bill
from mauve.timing.response import Caveat, Method, Reason, analyse
from mauve.timing.shrink import What, shrink_to_fit
from mauve.timing.task import Kind, Section, Task, constant, frames, total_load

from .systems import systems


def task(name: str, priority: int, period: int, cost: int, deadline: int = 0, **rest: Any) -> Task:
    return Task(name, priority, period, deadline or period, (constant(name, cost),), **rest)


def rigid(*tasks: Task) -> list[Task]:
    return [changed(one, preemptive=False) for one in tasks]


def responses(tasks: list[Task]) -> list[int | None]:
    return [result.wcrt for result in analyse(tasks, steps=4000).results]


def test_the_push_through_job_is_seen() -> None:
    """Davis, Burns, Bril and Lukkien 2007: the second job of C is the worst, though the first ends within T."""
    tasks = rigid(task("A", 3, 2500, 1000), task("B", 2, 3500, 1000, 3250), task("C", 1, 3500, 1000, 3250))
    found = analyse(tasks)
    assert [result.wcrt for result in found.results] == [2000, 3000, 3500]
    assert (found.result("C").worst_job, found.result("C").section, found.result("C").busy_period) == (2, 1000, 7000)


def test_a_bill_of_a_job_that_is_not_preempted_adds_up() -> None:
    tasks = rigid(task("A", 3, 2500, 1000), task("B", 2, 3500, 1000, 3250), task("C", 1, 3500, 1000, 3250))
    analysis = analyse(tasks)
    for result in analysis.results:
        bill = worst_bill(analysis, result.task)
        assert bill is not None and bill.due == bill.window == result.finish
    missed = deadline_bill(analysis, "C")
    assert missed is not None and missed.excess > 0
    fits = {one.what: one.at_most for one in shrink_to_fit(analysis, "C") if one.name == "C"}
    assert fits[What.WORK] is not None and 0 < fits[What.WORK] < 1000


def test_equal_priorities_without_preemption_delay_each_other_both_ways() -> None:
    assert responses(rigid(task("a", 1, 20, 3), task("b", 1, 20, 4))) == [7, 7]


def test_interrupts_preempt_what_no_task_does() -> None:
    irq = Task("irq", 9, 10, 10, (constant("irq", 1),), kind=Kind.INTERRUPT)
    found = analyse([irq, *rigid(task("a", 2, 100, 15), task("b", 1, 200, 8))])
    # a starts at 8 + irq at 0 = 9, runs 15 and 2 interrupts at 10 and 20 = 26
    assert found.result("a").wcrt == 26


def test_a_last_section_defers_and_blocks() -> None:
    tasks = [task("high", 2, 10, 4), task("low", 1, 30, 9, tail=5)]
    # low starts its last section at 4 + 4 = 8 before high's second release, then runs 5: 13; preemptive it were 17
    assert responses(tasks) == [9, 13]
    assert responses([tasks[0], changed(tasks[1], tail=0)]) == [4, 17]


def test_methods_on_tasks_that_are_not_preempted() -> None:
    tasks = rigid(task("a", 2, 20, 3), task("b", 1, 30, 4))
    exact = analyse(tasks, Method.EXACT).result("b")
    assert (exact.method, exact.caveats) == (Method.TRACE, (Caveat.FELL_BACK,))
    paper = analyse(tasks, Method.PAPER).result("a")
    assert (paper.wcrt, paper.caveats) == (3, (Caveat.BLOCKING, Caveat.NO_PREEMPTION))


def test_a_full_load_without_preemption_repeats_or_is_refused() -> None:
    tasks = rigid(task("high", 2, 4, 2), task("low", 1, 8, 4))
    found = analyse(tasks, steps=4000)
    assert total_load(tasks) == 1
    assert [result.wcrt for result in found.results] == [6, 6]
    above = [*tasks, *rigid(task("idle", 0, 16, 0))]
    assert analyse(above, steps=4000).result("low").wcrt == 6
    blocked = [changed(one, blocking=3) for one in tasks]
    repeated = analyse(blocked, steps=4000).result("low")
    assert (repeated.wcrt, repeated.busy_period) == (11, None)
    odd = rigid(Task("two", 2, 4, 4, (frames("two", (2, 2)),)), task("low", 1, 9, 5))
    assert analyse(odd, steps=200).result("low").reason is Reason.OVERLOAD


def test_an_overload_without_preemption_is_told_at_once() -> None:
    # The times grow by a factor at each step: a hundred thousand steps would make numbers of ten thousand digits.
    tasks = rigid(task("a", 3, 5, 4), task("b", 2, 15, 4), task("c", 1, 10, 3, jitter=4), task("d", 1, 6, 4))
    analysis = analyse(tasks)
    assert [result.wcrt is None for result in analysis.results] == [False, True, True, True]
    for name in "bcd":
        bill = deadline_bill(analysis, name)
        assert bill is not None and bill.due > bill.window
    tight = [*rigid(task("a", 2, 8, 5)), task("b", 1, 8, 4, tail=1)]
    bill = deadline_bill(analyse(tight), "b")
    assert bill is not None and bill.excess > 0


# ------------------------------------------------------------------ the formula read literally


def literal(tasks: list[Task], one: Task) -> int | None:
    """The response by the formula of the module with no shortcut, for tasks without interrupts; None beyond 3000."""
    others = [t for t in tasks if t is not one and t.priority >= one.priority]
    lower = [t.demand(1) if not t.preemptive else t.tail for t in tasks if t.priority < one.priority]
    blocking = max([one.blocking, *lower])

    def fixed(right: Any, at: int) -> int | None:
        while at <= 3000 and right(at) != at:
            at = right(at)
        return at if at <= 3000 else None

    def ceil(x: int, t: Task) -> int:
        return -((x + t.jitter) // -t.period)

    busy = fixed(lambda x: blocking + sum(t.demand(ceil(x, t)) for t in [*others, one]), 1)
    if busy is None:
        return None
    dearest = one.demand(1)
    section = dearest if not one.preemptive else min(one.tail, dearest)
    worst = 0
    for q in range(1, max(1, ceil(busy, one)) + 1):
        base = blocking + one.demand(q - 1) + dearest - section
        start = fixed(lambda x, b=base: b + sum(t.demand((x + t.jitter) // t.period + 1) for t in others), 0)
        if start is None:
            return None
        worst = max(worst, one.jitter + start + section - (q - 1) * one.period)
    return worst


@st.composite
def mixed(draw: st.DrawFn) -> list[Task]:
    tasks = []
    for one in draw(systems(size=3)):
        tail = draw(st.integers(0, 4))
        tasks.append(changed(one, preemptive=draw(st.booleans()), tail=tail if tail <= one.demand(1) else 0))
    return tasks


@settings(max_examples=40, deadline=None)
@given(mixed())
def test_the_shortcuts_change_nothing(tasks: list[Task]) -> None:
    found = analyse(tasks, steps=4000)
    for one in tasks:
        if one.preemptive and not one.tail:
            continue
        reference, result = literal(tasks, one), found.result(one.name)
        load = sum(t.load for t in tasks if t.priority >= one.priority)
        if load < 1 and reference is not None:
            assert result.wcrt == reference


# ------------------------------------------------------------------ unit steps


@dataclass
class Job:
    task: int
    arrival: int
    release: int
    cost: int
    done: int = 0


def simulate(tasks: list[Task], horizon: int, rng: random.Random) -> list[int]:
    """The greatest response of each task: immediate ceilings, random offsets, jitters, costs, places of sections."""
    ceilings: dict[str, int] = {}
    for one in tasks:
        for section in one.sections:
            ceilings[section.resource] = max(one.priority, ceilings.get(section.resource, one.priority))
    top = max(one.priority for one in tasks)
    jobs: list[Job] = []
    for index, one in enumerate(tasks):
        at = rng.randrange(one.period)
        while at < horizon:
            cost = one.demand(1) if rng.random() < 0.7 else rng.randint(1, one.demand(1))
            jobs.append(Job(index, at, at + rng.choice([0, one.jitter]), cost))
            at += one.period + (rng.randrange(3) if rng.random() < 0.2 else 0)
    queues = [sorted((j for j in jobs if j.task == index), key=lambda j: j.arrival) for index in range(len(tasks))]
    places = [_places(one, rng, ceilings, top) for one in tasks]

    def level(job: Job) -> tuple[int, int]:
        """Effective priority; within a section ahead of equals."""
        one = tasks[job.task]
        spots = list(places[job.task])
        if not one.preemptive:
            spots.append((0, job.cost, top))
        elif one.tail:
            spots.append((max(0, job.cost - one.tail), job.cost, top))
        inside = [ceiling for start, end, ceiling in spots if start < job.done < min(end, job.cost)]
        return (max([one.priority, *inside]), bool(inside))

    worst = [0] * len(tasks)
    for now in range(horizon):
        ready = [queue[0] for queue in queues if queue and queue[0].release <= now]
        if not ready:
            continue
        best = max(level(job) for job in ready)
        job = rng.choice([job for job in ready if level(job) == best])
        job.done += 1
        if job.done == job.cost:
            worst[job.task] = max(worst[job.task], now + 1 - job.arrival)
            queues[job.task].pop(0)
    return worst


def _places(one: Task, rng: random.Random, ceilings: dict[str, int], top: int) -> list[tuple[int, int, int]]:
    """Where the sections of a job lie: one inside the other, or one after the other; two locks never change hands."""
    found: list[tuple[int, int, int]] = []
    for section in sorted(one.sections, key=lambda s: -s.length):
        starts = range(one.demand(1) - section.length + 1)
        apart = [at for at in starts if all(_apart(at, at + section.length, start, end) for start, end, _ in found)]
        if apart:
            start = rng.choice(apart)
            found.append((start, start + section.length, top if section.above_all else ceilings[section.resource]))
    return found


def _apart(start: int, end: int, other: int, last: int) -> bool:
    return end <= other or last <= start or (other <= start and end <= last)


@st.composite
def sharing(draw: st.DrawFn) -> list[Task]:
    tasks = []
    for number in range(draw(st.integers(2, 4))):
        period, cost = draw(st.integers(8, 30)), draw(st.integers(1, 7))
        name = f"t{number}"
        resources = draw(st.lists(st.sampled_from(["r", "s"]), max_size=2, unique=True))
        sections = [Section(r, name, r, draw(st.integers(1, cost))) for r in resources]
        if draw(st.integers(0, 4)) == 0:
            sections.append(Section("", name, "np", draw(st.integers(1, cost)), above_all=True))
        kind = draw(st.integers(0, 5))
        tasks.append(
            task(
                name,
                draw(st.integers(1, 4)),
                period,
                cost,
                2 * period,
                jitter=draw(st.sampled_from([0, 0, 3])),
                sections=tuple(sections),
                preemptive=kind > 1,
                tail=draw(st.integers(1, cost)) if kind == 2 else 0,
            )
        )
    return tasks


@settings(max_examples=50, deadline=None)
@given(sharing(), st.integers(0, 2**32))
def test_no_simulation_exceeds_the_bound(tasks: list[Task], seed: int) -> None:
    bounds = responses(tasks)
    rng = random.Random(seed)
    for _ in range(3):
        for bound, seen in zip(bounds, simulate(tasks, 150, rng), strict=True):
            assert bound is None or seen <= bound


TWO = [((9, 14), (3, 5)), ((7, 10), (2, 4)), ((6, 17), (2, 6)), ((5, 9), (2, 3))]


@pytest.mark.parametrize(("periods", "costs"), TWO)
def test_the_bound_without_preemption_is_met_but_for_the_unit_in_which_the_lower_job_starts(
    periods: tuple[int, int], costs: tuple[int, int]
) -> None:
    """All offsets of two tasks: the lower job must start one unit before, so B is one unit less in whole steps."""
    tasks = rigid(task("a", 2, periods[0], costs[0]), task("b", 1, periods[1], costs[1]))
    bounds = responses(tasks)
    worst = [0, 0]
    for offset in range(periods[1]):
        for lead in range(periods[0]):
            releases = [range(lead, 150, periods[0]), range(offset, 150, periods[1])]
            pending = [list(each) for each in releases]
            now = 0
            while now < 140:
                ready = [index for index in (0, 1) if pending[index] and pending[index][0] <= now]
                if not ready:
                    now += 1
                    continue
                index = ready[0]
                now += costs[index]
                worst[index] = max(worst[index], now - pending[index].pop(0))
    assert [bounds[0] - 1, bounds[1]] == worst  # type: ignore[operator]
