"""Worst-case response times: other tools' answers, the formula read literally, simulations that never exceed them."""

from __future__ import annotations

import random
import time
from fractions import Fraction
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.records import field_names
from mauve.timing.priorities import rate_monotonic
from mauve.timing.response import Caveat, Method, Reason, analyse, interference_on
from mauve.timing.task import (
    Interrupt,
    Kind,
    Platform,
    Task,
    Workload,
    constant,
    frames,
    machine,
    on_platform,
    table,
    total_load,
    trace_length,
)

from .systems import load_cases, read_tasks, simulate, systems
from .test_psm import psm_of


def task(name: str, priority: int, period: int, work: int | Workload, deadline: int = 0, **rest: int) -> Task:
    part = constant(name, work) if isinstance(work, int) else work
    return Task(name, priority, period, deadline or period, (part,), **rest)


def responses(tasks: list[Task], method: Method = Method.TRACE) -> dict[str, int | None]:
    return {result.task: result.wcrt for result in analyse(tasks, method, steps=4000).results}


# ------------------------------------------------------------------ known answers


@pytest.mark.parametrize("case", load_cases("tasksets.json"), ids=lambda case: case["name"])
def test_the_answers_of_other_tools(case: dict[str, Any]) -> None:
    assert responses(read_tasks(case)) == case["expected"]


@pytest.mark.parametrize("case", load_cases("machines.json"), ids=lambda case: case["name"])
@pytest.mark.parametrize("method", [Method.SPORADIC, Method.PAPER, Method.TRACE])
def test_machines_by_each_method(case: dict[str, Any], method: Method) -> None:
    assert responses(read_tasks(case), method)["low"] == case["expected"][method.value]


def test_runs_from_the_initial_state_alone_would_miss_the_response_of_50() -> None:
    boot = machine(psm_of(("boot", 1, "run"), ("run", 9, "run")))
    assert responses([task("a", 2, 10, boot), task("low", 1, 100, 5)])["low"] == 50


def test_a_later_job_can_be_the_worst_when_the_deadline_exceeds_the_period() -> None:
    cycle = [task("high", 2, 12, 5), task("m", 1, 8, frames("m", (6, 3)), deadline=12)]
    found = analyse(cycle).result("m")
    assert (found.wcrt, found.worst_job, found.schedulable, found.slack) == (14, 3, False, -2)
    paper = analyse(cycle, Method.PAPER).result("m")
    assert (paper.wcrt, paper.schedulable) == (11, True)
    assert Caveat.LATER_JOBS in paper.caveats


def test_a_full_load_is_answered_where_the_busy_period_ends() -> None:
    tasks = [task("c", 3, 20, 5), task("b", 2, 40, 10), task("a", 1, 80, 40)]
    assert total_load(tasks) == 1
    found = analyse(tasks).result("a")
    assert (found.wcrt, found.busy_period, found.schedulable) == (80, 80, True)


def test_a_full_load_with_blocking_repeats_and_is_answered_without_an_end() -> None:
    tasks = [task("high", 2, 4, 2), task("low", 1, 8, 4, deadline=20, blocking=3)]
    found = analyse(tasks).result("low")
    assert (found.wcrt, found.busy_period) == (15, None)


def test_a_full_load_is_not_taken_to_repeat_before_the_machine_does() -> None:
    """The first jobs grow by the long-run mean already, and yet the dearest pair of transitions comes later."""
    late = psm_of(("boot", 9, "a"), ("a", 1, "b"), ("b", 1, "b"), ("b", 0, "c"), ("c", 9, "d"), ("d", 1, "d"))
    tasks = [task("high", 2, 2, 1), task("low", 1, 2, machine(late), deadline=99)]
    found = analyse(tasks).result("low")
    assert (found.wcrt, found.worst_job) == (32, 4)


def test_a_full_load_of_a_machine_that_is_not_proven_to_repeat_is_unknown_with_its_reason() -> None:
    two_rates = machine(psm_of(("w", 2, "w"), ("w", 1, "x"), ("x", 1, "x")))
    tasks = [task("high", 2, 4, two_rates), task("low", 1, 8, 4, deadline=99, blocking=3)]
    found = analyse(tasks, steps=500).result("low")
    assert (found.wcrt, found.reason, found.schedulable) == (None, Reason.FULL_LOAD, False)


def test_an_overload_names_who_causes_it_and_leaves_more_urgent_tasks_alone() -> None:
    tasks = [task("a", 3, 10, 2), task("b", 2, 10, 7), task("c", 1, 100, 15), task("idle", 1, 10, 0)]
    found = analyse(tasks)
    assert found.result("b").wcrt == 9
    assert found.result("c").reason is Reason.OVERLOAD
    assert found.result("c").responsible == ("b", "a", "c")
    assert not found.schedulable


def test_an_enormous_busy_period_is_given_up_not_waited_for() -> None:
    tasks = [task("a", 2, 1_000_003, 500_000), task("b", 1, 1_000_033, 500_017, deadline=10**12)]
    start = time.process_time()
    found = analyse(tasks, steps=1000).result("b")
    assert time.process_time() - start < 1
    assert found.wcrt is None
    assert found.reason is Reason.LIMIT


def test_equal_priorities_delay_each_other_both_ways() -> None:
    assert responses([task("a", 1, 20, 3), task("b", 1, 20, 4)]) == {"a": 7, "b": 7}


def test_a_task_of_no_cost_still_waits_for_the_more_urgent_ones() -> None:
    assert responses([task("a", 2, 10, 4), task("empty", 1, 10, 0)])["empty"] == 4
    assert responses([task("empty", 1, 10, 0)]) == {"empty": 0}


def test_a_slow_region_runs_in_one_of_several_jobs_and_regions_add_up() -> None:
    both = Task("m", 2, 10, 10, (constant("fast", 2), constant("slow", 5, period=30)))
    assert both.trace(4) == (7, 2, 2, 7)
    assert both.load == Fraction(2, 10) + Fraction(5, 30)
    assert responses([both, task("low", 1, 100, 20)])["low"] == 38


def test_context_switches_ticks_and_interrupts_of_the_platform_count() -> None:
    tasks = [task("a", 2, 100, 20), task("b", 1, 200, 30)]
    platform = Platform(3, (Interrupt("tick", 50, 1, Kind.TICK), Interrupt("uart", 40, 2)))
    found = analyse(on_platform(tasks, platform))
    # a: 26 + tick 1 + uart 2 = 29; b: 36 + a 26 = 62, then 2 ticks and 2 uart: 68
    assert {result.task: result.wcrt for result in found.results} == {"a": 29, "b": 68}
    assert found.task("a").overhead == 6


def test_the_paper_method_says_what_it_leaves_out() -> None:
    tasks = [task("a", 2, 10, 2, jitter=3), task("b", 1, 20, 4, blocking=5)]
    found = analyse(tasks, Method.PAPER).result("b")
    assert found.wcrt == 6
    assert found.caveats == (Caveat.JITTER, Caveat.BLOCKING)
    assert analyse(tasks).result("b").wcrt == 13


def test_a_release_exactly_at_the_response_does_not_delay_it() -> None:
    tasks = [task("a", 2, 5, 2), task("b", 1, 20, 3)]
    assert responses(tasks, Method.PAPER)["b"] == responses(tasks)["b"] == 5


def test_a_curve_extended_beyond_its_computed_part_is_said() -> None:
    two_rates = machine(psm_of(("w", 2, "w"), ("w", 1, "x"), ("x", 1, "x")))
    two_rates.curve._cap = 4  # type: ignore[attr-defined]
    found = analyse([task("a", 2, 4, two_rates), task("low", 1, 100, 40)]).result("low")
    assert (found.wcrt, found.caveats) == (80, (Caveat.ESTIMATED,))


def test_the_paper_looks_at_k_activations() -> None:
    tasks = [task("a", 2, 10, 1), task("b", 1, 35, 1, deadline=25)]
    assert [trace_length(one, tasks) for one in tasks] == [3, 1]


def test_the_shorter_period_is_more_urgent_and_ties_go_by_declaration() -> None:
    assert rate_monotonic((10, 1, 10, 20)) == (3, 4, 2, 1)


@pytest.mark.parametrize("rest", [{"period": 0}, {"jitter": -1}, {"deadline": -5}, {"blocking": -1}])
def test_a_task_that_cannot_be_is_refused(rest: dict[str, int]) -> None:
    values = {"period": 10, "deadline": 10, **rest}
    with pytest.raises(ValueError, match=r"positive|negative"):
        Task("a", 1, work=(constant("a", 1),), **values)
    with pytest.raises(ValueError, match="one name"):
        analyse([task("a", 1, 10, 1), task("a", 2, 10, 1)])
    with pytest.raises(ValueError, match="multiple"):
        Task("a", 1, 10, 10, (constant("slow", 1, period=15),))


# ------------------------------------------------------------------ the formula read literally


def literal(tasks: list[Task], one: Task) -> tuple[int, int] | None:
    """Response and busy period by the formula of the module, with no shortcut; None beyond 4000."""
    others = [t for t in tasks if t is not one and t.priority >= one.priority]

    def count(window: int, t: Task) -> int:
        return -((window + t.jitter) // -t.period)

    def fixed(right: Any) -> int | None:
        at = right(1)
        while at <= 4000 and right(at) != at:
            at = right(at)
        return at if at <= 4000 else None

    busy = fixed(lambda x: one.blocking + sum(t.demand(count(x, t)) for t in [*others, one]))
    if busy is None:
        return None
    worst = 0
    for q in range(1, -((busy + one.jitter) // -one.period) + 1):
        own = one.demand(q)
        w = fixed(lambda x, own=own: one.blocking + own + sum(t.demand(count(x, t)) for t in others) if x else 0)
        if w is None:
            return None
        worst = max(worst, one.jitter + w - (q - 1) * one.period)
    return worst, busy


@settings(max_examples=200, deadline=None)
@given(systems(), st.integers(0, 5))
def test_the_shortcuts_change_nothing(tasks: list[Task], blocking: int) -> None:
    tasks = [Task(**{**_fields(t), "blocking": blocking if t.priority > 1 else 0}) for t in tasks]
    found = analyse(tasks, steps=4000)
    for one in tasks:
        reference = literal(tasks, one)
        result = found.result(one.name)
        level = total_load([one, *interference_on(one, tasks).tasks])
        if reference is not None:
            assert level > 1 or (result.wcrt, result.busy_period) == reference
        elif level < Fraction(9, 10):
            assert result.wcrt is not None


@st.composite
def full_loads(draw: st.DrawFn) -> list[Task]:
    """A load of exactly 1: some random tasks and a last one that takes what they leave."""
    above = draw(systems(overhead=False, size=2))
    left = 1 - total_load(above)
    if left <= 0:
        above, left = [], Fraction(1)
    scale = draw(st.integers(1, 2))
    period, cost = left.denominator * scale, left.numerator * scale
    work = frames("low", (cost + 1, cost - 1)) if draw(st.booleans()) else constant("low", cost)
    return [*above, Task("low", 0, period, period, (work,), blocking=draw(st.integers(0, 5)))]


@settings(max_examples=80, deadline=None)
@given(full_loads())
def test_a_full_load_is_answered_as_a_long_look_would(tasks: list[Task]) -> None:
    found = analyse(tasks, steps=3000).result("low")
    *above, low = tasks
    if found.wcrt is None:
        assert found.reason is Reason.FULL_LOAD
        return
    def due(q: int, window: int) -> int:
        return low.blocking + low.demand(q) + sum(t.demand(-((window + t.jitter) // -t.period)) for t in above)

    at, worst = 1, 0
    for q in range(1, 400):
        while (then := due(q, at)) > at:
            at = then
        worst = max(worst, low.jitter + at - (q - 1) * low.period)
        if found.busy_period is not None and at + low.jitter <= q * low.period:
            break
    assert found.wcrt == worst


def _fields(one: Task) -> dict[str, Any]:
    return {name: getattr(one, name) for name in field_names(one)}


# ------------------------------------------------------------------ laws


@settings(max_examples=200, deadline=None)
@given(systems(), st.integers(0, 2**32))
def test_no_simulation_exceeds_the_bound(tasks: list[Task], seed: int) -> None:
    bounds = responses(tasks)
    rng = random.Random(seed)
    for _ in range(4):
        for name, seen in simulate(tasks, 160, rng).items():
            bound = bounds[name]
            assert bound is None or seen <= bound


@settings(max_examples=100, deadline=None)
@given(systems(jitter=False, size=3), st.integers(1, 8), st.integers(0, 2**32))
def test_no_simulation_exceeds_the_bound_above_a_task_that_cannot_be_preempted(
    tasks: list[Task], cost: int, seed: int
) -> None:
    blocked = [Task(**{**_fields(t), "blocking": cost}) for t in tasks]
    tasks = [*blocked, task("locked", 0, 30, cost)]
    bounds = responses(tasks)
    rng = random.Random(seed)
    for _ in range(4):
        for name, seen in simulate(tasks, 160, rng, locked="locked").items():
            bound = bounds[name]
            assert bound is None or seen <= bound


@settings(max_examples=100, deadline=None)
@given(systems(), st.integers(0, 3), st.sampled_from(["cost", "jitter", "blocking", "overhead", "period"]))
def test_more_of_anything_never_lowers_a_response(tasks: list[Task], index: int, what: str) -> None:
    index %= len(tasks)
    old = tasks[index]
    more = _fields(old)
    match what:
        case "cost":
            more["work"] = (*old.work, constant("more", 1))
        case "period":
            more["work"] = tuple(part for part in old.work if not part.period)
            old = Task(**more)
            more["period"] = max(1, old.period - 1)
        case _:
            more[what] += 1
    before = responses([*tasks[:index], old, *tasks[index + 1 :]])
    after = responses([*tasks[:index], Task(**more), *tasks[index + 1 :]])
    for name, response in before.items():
        now = after[name]
        if name == old.name and what == "period":
            continue
        assert response is None or now is None or now >= response


@settings(max_examples=100, deadline=None)
@given(systems())
def test_the_methods_are_ordered(tasks: list[Task]) -> None:
    paper, trace, sporadic = (responses(tasks, method) for method in (Method.PAPER, Method.TRACE, Method.SPORADIC))
    for name, value in trace.items():
        if value is not None:
            assert paper[name] is not None
            assert paper[name] <= value  # type: ignore[operator]
            assert sporadic[name] is None or value <= sporadic[name]  # type: ignore[operator]


def test_a_table_below_its_own_slope_still_gives_the_least_fixed_point() -> None:
    tasks = [task("a", 2, 10, table("a", (6, 6, 6, 20))), task("b", 1, 100, 17)]
    assert responses(tasks)["b"] == 23


def test_a_table_of_consecutive_jobs_is_a_workload() -> None:
    assert responses([task("a", 2, 10, table("a", (6, 8, 14))), task("b", 1, 30, 7)]) == {"a": 6, "b": 15}


# ------------------------------------------------------------------ speed


@pytest.mark.parametrize(("count", "limit"), [(10, 0.002), (50, 0.03), (200, 0.4)])
def test_plain_sets_are_fast(count: int, limit: float) -> None:
    """Ten times the budget of an idle machine, against accidents; benchmarks/ measures the budget itself."""
    rng = random.Random(count)
    sets = []
    for _ in range(5):
        shares = [rng.random() for _ in range(count)]
        periods = sorted(int(10 ** rng.uniform(4, 6)) for _ in range(count))
        costs = [max(1, int(0.75 * s / sum(shares) * t)) for s, t in zip(shares, periods, strict=True)]
        sets.append([task(f"t{n}", count - n, t, c) for n, (t, c) in enumerate(zip(periods, costs, strict=True))])
    start = time.process_time()
    found = [analyse(tasks) for tasks in sets]
    assert (time.process_time() - start) / 5 < limit
    assert all(result.wcrt is not None for analysis in found for result in analysis.results)


def test_a_task_without_cost_that_is_not_preempted_has_a_response() -> None:
    assert responses([task("empty", 1, 10, 0, preemptive=False)]) == {"empty": 0}
    assert responses([task("a", 2, 10, 4), task("empty", 1, 10, 0, preemptive=False)])["empty"] == 4
