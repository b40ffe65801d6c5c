"""Tasks that suspend themselves, against a simulation in unit steps that shares nothing with the analysis."""

from __future__ import annotations

from random import Random

import pytest

from mauve.timing.response import Analysis, Method, Reason, analyse
from mauve.timing.suspension import with_waits
from mauve.timing.task import Task, constant, frames

Jobs = list[tuple[int, int]]
"""Per frame of a task its work, and how long it waits at most when half of that is done."""


def _analysed(sets: list[tuple[int, int, Jobs]], method: Method = Method.TRACE) -> Analysis | None:
    """(priority, period, jobs) of each task, responses at their fixed point; None where there is none."""
    responses = [0] * len(sets)
    while True:
        tasks = []
        for index, (priority, period, jobs) in enumerate(sets):
            plain = Task(f"t{index}", priority, period, 10**6, (frames("work", [cost for cost, _ in jobs]),))
            if any(wait for _, wait in jobs):
                own = frames("work", [cost + wait for cost, wait in jobs])
                plain = with_waits(plain, (own,), responses[index])
            tasks.append(plain)
        analysis = analyse(tasks, method)
        found = [result.wcrt for result in analysis.results]
        if found == responses:
            return analysis
        if None in found or max(r or 0 for r in found) > 3000:
            return None
        responses = [r or 0 for r in found]


def _responses(sets: list[tuple[int, int, Jobs]], method: Method = Method.TRACE) -> list[int]:
    """The responses; empty where there is no fixed point."""
    analysis = _analysed(sets, method)
    return [] if analysis is None else [result.wcrt for result in analysis.results if result.wcrt is not None]


def test_a_task_below_one_that_waits_is_delayed_by_two_of_its_jobs() -> None:
    """C = 5, T = 10, waiting up to 4, above 5: 15, where the wait left out gives 10."""
    assert _responses([(2, 10, [(5, 4)]), (1, 100, [(5, 0)])]) == [9, 15]
    assert _responses([(2, 10, [(5, 0)]), (1, 100, [(5, 0)])]) == [5, 10]


def test_the_longest_wait_alone_is_no_jitter() -> None:
    """With a jitter of 6 for the wait of 6, w = 2 + ceil(w / 5) + 2 ceil((w + 6) / 11) ends at 5; 6 are seen."""
    sets: list[tuple[int, int, Jobs]] = [(3, 5, [(1, 0)]), (2, 11, [(2, 6)]), (1, 53, [(2, 0)])]
    assert max(_observed(sets, seed, 2500)[2] for seed in range(8)) == 6
    assert _responses(sets)[2] >= 6


def test_a_wait_for_ever_is_no_overload() -> None:
    waiting = with_waits(Task("t", 1, 10, 10, (constant("work", 2),)), (constant("work", 12),), 0)
    result = analyse([waiting]).result("t")
    assert result.wcrt is None and result.reason is Reason.WAITS


@pytest.mark.parametrize("first", range(0, 160, 40))
def test_no_simulation_exceeds_the_bound(first: int) -> None:
    for seed in range(first, first + 40):
        sets = _random(Random(seed))
        bounds = [_responses(sets, method) for method in (Method.TRACE, Method.EXACT)]
        for run in range(3 if bounds[0] else 0):
            seen = _observed(sets, 100 * seed + run, 900)
            for bound in bounds:
                assert all(s <= b for s, b in zip(seen, bound, strict=True)), (seed, run, seen, bound)


def _random(random: Random) -> list[tuple[int, int, Jobs]]:
    sets: list[tuple[int, int, Jobs]] = []
    for _ in range(random.randint(2, 4)):
        period = random.choice((6, 8, 10, 12, 15, 20, 30))
        waits = random.random() < 0.5
        jobs = [
            (random.randint(1, max(1, period // 3)), random.randint(0, period // 2) if waits else 0)
            for _ in range(random.choice((1, 1, 2)))
        ]
        sets.append((random.randint(1, 4), period, jobs))
    return sets


def _observed(sets: list[tuple[int, int, Jobs]], seed: int, horizon: int) -> list[int]:
    """The greatest response of each task in one run: random offsets and waits; ties at random."""
    random = Random(seed)
    offsets = [random.randrange(period) for _, period, _ in sets]
    phases = [random.randrange(4) for _ in sets]
    queues: list[list[list[int]]] = [[] for _ in sets]  # arrival, work before the wait, wait, work after it
    seen = [0] * len(sets)
    for now in range(horizon):
        for index, (_, period, jobs) in enumerate(sets):
            if now >= offsets[index] and (now - offsets[index]) % period == 0:
                cost, most = jobs[((now - offsets[index]) // period + phases[index]) % len(jobs)]
                before = random.choice((0, cost // 2, cost - 1, cost))
                wait = random.choice((0, most, most, random.randint(0, most)))
                queues[index].append([now, before, wait, cost - before])
        ready = []
        for index, (priority, _, _) in enumerate(sets):
            if queues[index]:
                job = queues[index][0]
                if job[1] or not job[2]:
                    ready.append((priority, random.random(), index))
        for index in range(len(sets)):
            if queues[index] and not queues[index][0][1] and queues[index][0][2]:
                queues[index][0][2] -= 1
        if ready:
            job = queues[max(ready)[2]][0]
            job[1 if job[1] else 3] -= 1
        for index in range(len(sets)):
            while queues[index] and not any(queues[index][0][1:]):
                seen[index] = max(seen[index], now + 1 - queues[index].pop(0)[0])
    return seen
