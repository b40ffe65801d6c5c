"""The exact method: the maximum over concrete runs, never above the trace, never below a simulation."""

from __future__ import annotations

import random
from itertools import product
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.timing import exact
from mauve.timing.bill import deadline_bill, worst_bill
from mauve.timing.exact import undominated
from mauve.timing.psm import reachable_edges
from mauve.timing.response import Caveat, Method, analyse
from mauve.timing.task import Task, constant, frames, machine
from mauve.timing.traces import PsmCurve

from .systems import load_cases, read_tasks, simulate, systems
from .test_psm import psm_of, psms


@pytest.mark.parametrize("case", load_cases("machines.json"), ids=lambda case: case["name"])
def test_the_published_examples(case: dict[str, Any]) -> None:
    result = analyse(read_tasks(case), Method.EXACT).result("low")
    assert (result.wcrt, result.method, result.caveats) == (case["expected"]["exact"], Method.EXACT, ())


def all_runs(one: Task, jobs: int) -> list[tuple[int, ...]]:
    """The costs of every run of a task whose work is one machine."""
    curve = one.work[0].curve
    assert isinstance(curve, PsmCurve)
    _, edges = reachable_edges(curve.psm)

    def walk(state: int, left: int) -> list[tuple[int, ...]]:
        if not left:
            return [()]
        out = edges[state] or [(0, state)]
        return [(cost, *rest) for cost, target in out for rest in walk(target, left - 1)]

    return [run for state in range(len(edges)) for run in walk(state, jobs)]


@st.composite
def two_machines(draw: st.DrawFn) -> list[Task]:
    high = [
        Task(f"m{number}", 9 - number, period, period, (machine(draw(psms(max_states=3, max_cost=5))),))
        for number, period in enumerate((draw(st.integers(6, 12)), draw(st.integers(8, 16))))
    ]
    return [*high, Task("low", 1, 30, 30, (constant("low", draw(st.integers(1, 8))),))]


@settings(max_examples=80, deadline=None)
@given(two_machines())
def test_the_exact_response_is_the_maximum_over_all_combinations_of_runs(tasks: list[Task]) -> None:
    result = analyse(tasks, Method.EXACT).result("low")
    bound = analyse(tasks).result("low").wcrt
    if bound is None or bound > 30:
        assert result.wcrt == bound
        return
    own = tasks[2].demand(1)
    jobs = [-(-bound // one.period) for one in tasks[:2]]
    worst = 0
    distinct = [set(all_runs(one, count)) for one, count in zip(tasks, jobs, strict=False)]
    for runs in product(*distinct):
        at = 1
        while True:
            then = own + sum(
                sum(run[: -(-at // one.period)]) for run, one in zip(runs, tasks, strict=False)
            )
            if then <= at:
                break
            at = then
        worst = max(worst, at)
    assert result.wcrt == worst


@settings(max_examples=100, deadline=None)
@given(systems(), st.integers(0, 2**32))
def test_exact_lies_between_simulation_and_trace_and_its_bill_adds_up(tasks: list[Task], seed: int) -> None:
    found, bound = analyse(tasks, Method.EXACT), analyse(tasks)
    rng = random.Random(seed)
    seen = [simulate(tasks, 120, rng) for _ in range(3)]
    for result in found.results:
        above = bound.result(result.task).wcrt
        assert (result.wcrt is None) == (above is None)
        if result.wcrt is None or above is None:
            continue
        assert max(run[result.task] for run in seen) <= result.wcrt <= above
        bill = worst_bill(found, result.task)
        assert bill is not None
        assert bill.excess == 0
        if not result.schedulable:
            late = deadline_bill(found, result.task)
            assert late is not None
            assert late.excess > 0 or late.window == 0


def test_where_it_does_not_apply_it_says_so() -> None:
    tasks = [
        Task("a", 2, 10, 10, (frames("a", (3, 1)),), jitter=1),
        Task("b", 1, 30, 30, (constant("b", 5),)),
    ]
    result = analyse(tasks, Method.EXACT).result("b")
    assert (result.method, result.caveats) == (Method.TRACE, (Caveat.FELL_BACK,))
    assert result.wcrt == analyse(tasks).result("b").wcrt


def test_a_response_beyond_the_period_is_left_to_the_trace() -> None:
    tasks = [Task("high", 2, 12, 12, (frames("high", (5,)),)), Task("m", 1, 8, 20, (frames("m", (6, 3)),))]
    result = analyse(tasks, Method.EXACT).result("m")
    assert (result.wcrt, result.caveats) == (14, (Caveat.FELL_BACK,))


def test_a_limit_leaves_a_sound_bound_and_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    case = load_cases("machines.json")[0]
    monkeypatch.setattr(exact, "COMPARISONS", 1)
    result = analyse(read_tasks(case), Method.EXACT).result("low")
    assert (result.wcrt, result.caveats) == (26, (Caveat.GAVE_UP,))
    monkeypatch.undo()
    monkeypatch.setattr(exact, "COMBINATIONS", 0)
    result = analyse(read_tasks(case), Method.EXACT).result("low")
    assert (result.wcrt, result.caveats) == (26, (Caveat.GAVE_UP,))


def test_the_charges_are_the_costs_of_a_run() -> None:
    crossing = psm_of(("s", 10, "h"), ("h", 1, "s"), ("s", 6, "m"), ("m", 9, "n"), ("n", 1, "s"))
    tasks = [Task("a", 2, 20, 20, (machine(crossing),)), Task("low", 1, 99, 99, (constant("low", 11),))]
    (charge,) = analyse(tasks, Method.EXACT).result("low").charges
    assert charge.task == "a"
    assert charge.costs[:2] == (10, 1)


@given(st.lists(st.tuples(st.integers(0, 3), st.integers(0, 3), st.integers(0, 3)), min_size=1, max_size=8))
def test_undominated_runs_dominate_all(runs: list[tuple[int, ...]]) -> None:
    kept = undominated(runs)
    for run in runs:
        assert any(all(a >= b for a, b in zip(other, run, strict=True)) for other in kept)
    for one in kept:
        assert not any(other != one and all(a >= b for a, b in zip(other, one, strict=True)) for other in kept)


@st.composite
def one_machine(draw: st.DrawFn) -> list[Task]:
    period = draw(st.integers(3, 6))
    high = Task("m", 2, period, period, (machine(draw(psms(max_states=3, max_cost=4))),))
    return [high, Task("low", 1, 16, 16, (constant("low", draw(st.integers(1, 5))),))]


@settings(max_examples=40, deadline=None)
@given(one_machine())
def test_the_exact_response_is_that_of_unit_steps_over_all_offsets_and_runs(tasks: list[Task]) -> None:
    """Every run of the machine, every offset, one job of the low task released at time 0, no formula in between."""
    result = analyse(tasks, Method.EXACT).result("low")
    high, low = tasks
    if result.wcrt is None or result.wcrt > low.period:
        return
    worst = 0
    for run in set(all_runs(high, -(-result.wcrt // high.period) + 2)):
        for offset in range(high.period):
            pending, left, now, job = 0, low.demand(1), 0, 0
            # The machine's job before time 0 may still be unfinished then.
            pending = max(0, run[0] - (high.period - offset)) if offset else 0
            job = 1 if offset else 0
            while left:
                if now >= offset and (now - offset) % high.period == 0 and job < len(run):
                    pending += run[job]
                    job += 1
                if pending:
                    pending -= 1
                else:
                    left -= 1
                now += 1
            worst = max(worst, now)
    assert result.wcrt == worst
