"""Responses per transition and per state: the greatest is the task's, and no simulated job exceeds its own."""

from __future__ import annotations

import random

from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.records import changed
from mauve.timing.psm import Psm
from mauve.timing.response import Method, analyse
from mauve.timing.task import Task, constant, machine
from mauve.timing.transitions import state_responses, transition_responses

from .systems import systems
from .test_psm import psm_of, psms


def test_a_cheap_transition_responds_sooner() -> None:
    work = machine(psm_of(("idle", 1, "idle"), ("idle", 8, "plan"), ("plan", 2, "idle")))
    tasks = [Task("high", 2, 10, 10, (constant("high", 3),)), Task("m", 1, 20, 20, (work,))]
    found = transition_responses(analyse(tasks), "m")
    assert [(one.transition.source, one.transition.target, one.wcrt) for one in found] == [
        ("idle", "idle", 4),
        ("idle", "plan", 14),
        ("plan", "idle", 5),
    ]
    assert [(one.state, one.wcrt) for one in state_responses(found)] == [("idle", 14), ("plan", 5)]


def test_the_first_transition_may_be_the_last_job_of_a_busy_period() -> None:
    """After the dear transition its cheap successor is late, though it costs little itself."""
    work = machine(psm_of(("a", 9, "b"), ("b", 1, "a")))
    tasks = [Task("high", 2, 12, 12, (constant("high", 4),)), Task("m", 1, 8, 30, (work,))]
    found = {one.transition.source: (one.wcrt, one.worst_job) for one in transition_responses(analyse(tasks), "m")}
    assert found["a"][0] == analyse(tasks).result("m").wcrt
    assert found["b"] == (10, 2)


def test_methods_without_machines_and_tasks_without_responses_have_none() -> None:
    work = machine(psm_of(("a", 9, "b"), ("b", 1, "a")))
    assert transition_responses(analyse([Task("m", 1, 8, 30, (work,))], Method.SPORADIC), "m") == ()
    assert transition_responses(analyse([Task("m", 1, 4, 30, (work,))]), "m") == ()


@settings(max_examples=50, deadline=None)
@given(systems(), psms(max_states=4, max_cost=6), st.booleans())
def test_the_greatest_is_the_response_of_the_task(tasks: list[Task], psm: Psm, preemptive: bool) -> None:
    one = Task("m", 1, 15, 15, (machine(psm),), preemptive=preemptive)
    analysis = analyse([*tasks, one], steps=4000)
    found = transition_responses(analysis, "m", steps=4000)
    wcrt = analysis.result("m").wcrt
    if wcrt is not None and found:
        assert all(each.wcrt <= wcrt for each in found)
        if preemptive and all(each.own for each in found):
            assert max(each.wcrt for each in found) == wcrt


@settings(max_examples=50, deadline=None)
@given(systems(size=3), psms(max_states=4, max_cost=6), st.integers(0, 2**32))
def test_no_simulated_job_exceeds_the_response_of_its_transition(tasks: list[Task], psm: Psm, seed: int) -> None:
    """Unit steps from a synchronous release with the greatest jitter, over random runs."""
    rng = random.Random(seed)
    one = Task("m", 0, rng.randint(4, 12), 99, (machine(psm),), jitter=rng.choice([0, 3]))
    every = [*(changed(t, jitter=0, priority=t.priority + 1) for t in tasks), one]
    bounds = {(each.transition.source, each.transition.target, each.transition.cost): each.wcrt
              for each in transition_responses(analyse(every, steps=4000), "m", steps=4000)}
    if not bounds:
        return
    from .systems import random_costs

    count = 30
    state, run = psm.initial, []
    for _ in range(rng.randrange(6)):
        out = [t for t in psm.transitions if t.source == state]
        state = rng.choice(out).target if out else state
    for _ in range(count):
        out = [t for t in psm.transitions if t.source == state]
        if not out:
            return
        taken = rng.choice(out)
        run.append(taken)
        state = taken.target
    horizon = 120
    work = [0] * (horizon + 1)
    for other in every[:-1]:
        for job, cost in enumerate(random_costs(other, horizon // other.period + 1, rng)):
            work[min(horizon, job * other.period)] += cost
    releases = [max(job * one.period - one.jitter, 0) for job in range(count)]
    pending, job, left = 0, 0, run[0].cost
    for now in range(horizon):
        pending += work[now]
        while job < count and not left and releases[job] <= now and not pending:
            taken = run[job]
            nominal = job * one.period - one.jitter
            assert now - nominal <= bounds[taken.source, taken.target, taken.cost]
            job += 1
            left = run[job].cost if job < count else 0
        if pending:
            pending -= 1
        elif job < count and releases[job] <= now:
            left -= 1
            if not left:
                taken = run[job]
                nominal = job * one.period - one.jitter
                assert now + 1 - nominal <= bounds[taken.source, taken.target, taken.cost]
                job += 1
                left = run[job].cost if job < count else 0
