"""The simulation of a schedule: known schedules to the unit, table III of the C-Forge paper, laws of every run."""

from __future__ import annotations

import time
from collections import Counter

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.report.simulation_views import Wait, waits
from mauve.timing.psm import CostPart, PsmTransition, make_psm
from mauve.timing.response import Method, analyse
from mauve.timing.simulation.choices import generator, steps
from mauve.timing.simulation.engine import simulate
from mauve.timing.simulation.horizon import Asked, horizon
from mauve.timing.simulation.outcome import Activity, Outcome
from mauve.timing.simulation.system import (
    Arrivals,
    Execution,
    Hold,
    Jitter,
    Locked,
    Offsets,
    Order,
    Processor,
    Protocol,
    Runs,
    Settings,
    SimTask,
    executed,
    hyperperiod,
    simulated,
)
from mauve.timing.suspension import with_waits
from mauve.timing.task import Interrupt, Kind, Platform, Section, Task, Workload, constant, frames, machine, on_platform

from .systems import systems
from .test_psm import psm_of


def task(name: str, priority: int, period: int, work: int | Workload, deadline: int = 0, **rest: object) -> Task:
    part = constant(name, work) if isinstance(work, int) else work
    return Task(name, priority, period, deadline or period, (part,), **rest)  # type: ignore[arg-type]


def on(*tasks: Task | SimTask) -> Processor:
    return Processor("p", tuple(one if isinstance(one, SimTask) else simulated(one) for one in tasks))


def chart(outcome: Outcome) -> str:
    """Who runs in each unit of time; lower case outside of sections, upper case inside, `-` for nobody."""
    cells = ["-"] * outcome.end
    for one in outcome.segments:
        signs = {Activity.WORK: one.task, Activity.SECTION: one.task.upper(), Activity.SWITCH: "*"}
        cells[one.start : one.end] = [signs[one.activity]] * (one.end - one.start)
    return "".join(cells)


# ------------------------------------------------------------------ known schedules


def test_rate_monotonic_schedule_to_the_unit() -> None:
    found = simulate(on(task("a", 3, 4, 1), task("b", 2, 6, 2), task("c", 1, 12, 3)), Settings(12))
    assert chart(found) == "abbcacbbac--"
    c = found.measures("c")
    assert (c.greatest, c.worst_job, c.preemptions, c.busy) == (10, 1, 2, 3)
    assert (found.preemptions, found.switches, found.idle, found.misses) == (2, 8, 2, 0)
    assert [(job.task, job.number, job.response) for job in found.jobs][:3] == [("a", 1, 1), ("b", 1, 3), ("a", 2, 1)]
    assert found.measures("a").mean == 1


def test_the_ceiling_keeps_the_holder_running_and_no_protocol_does_not() -> None:
    first = SimTask(task("l", 1, 40, 8), (Hold((), 1), Hold(("R",), 9)))
    second = SimTask(task("h", 2, 5, 1), (Hold(("R",), 1),))
    held = simulate(Processor("p", (first, second)), Settings(20))
    assert chart(held) == "HlLLLLLLLHH----H----"
    assert (held.measures("h").greatest, held.measures("h").blocked) == (5, 4)
    assert [w.wait for w in waits(held) if w.task == "h"] == [Wait.BLOCKED]
    free = simulate(Processor("p", (first, second)), Settings(20, protocol=Protocol.NONE))
    assert free.measures("h").greatest == 1


def test_without_preemption_a_job_runs_to_its_end_but_for_interrupts() -> None:
    tasks = on_platform(
        [task("l", 1, 20, 6, preemptive=False), task("h", 2, 5, 1)], Platform(0, (Interrupt("i", 7, 1),))
    )
    found = simulate(on(*tasks), Settings(20))
    assert chart(found) == "ihlllllilhh---ih----"
    assert found.measures("l").preemptions == 0
    assert found.measures("h").blocked == 3


def test_the_tail_of_a_job_is_not_preempted() -> None:
    found = simulate(on(task("l", 1, 20, 6, tail=3), task("h", 2, 5, 1)), Settings(20))
    assert chart(found) == "hllllllh--h----h----"
    assert (found.measures("h").greatest, found.measures("h").blocked) == (3, 2)


def test_context_switches_lie_around_the_work_of_each_job() -> None:
    tasks = on_platform([task("a", 2, 10, 2), task("b", 1, 20, 5)], Platform(1))
    found = simulate(on(*tasks), Settings(20))
    assert chart(found) == "*aa**bbbbb*aa**-----"
    assert found.measures("b").greatest == 15


def test_equal_priorities_take_turns_by_the_order_asked_for() -> None:
    tasks = on(task("b", 1, 10, 2), task("a", 1, 10, 3))
    assert chart(simulate(tasks, Settings(10, order=Order.FIFO))) == "bbaaa-----"
    assert chart(simulate(tasks, Settings(10, order=Order.NAME))) == "aaabb-----"
    assert chart(simulate(tasks, Settings(10, order=Order.DECLARED))) == "bbaaa-----"


def test_an_overload_ends_at_the_window_with_all_that_is_late() -> None:
    found = simulate(on(task("a", 2, 4, 3), task("b", 1, 8, 4)), Settings(80))
    b = found.measures("b")
    assert (found.end, found.idle, b.released, b.finished) == (80, 0, 10, 5)
    assert b.misses == 10 and found.measures("a").misses == 0
    assert sum(job.finish is None for job in found.jobs) == 5


def test_jobs_without_work_end_when_nothing_goes_before_them() -> None:
    found = simulate(on(task("a", 2, 4, 4), task("e", 1, 4, 0)), Settings(12))
    assert found.measures("e").greatest == 4
    alone = simulate(on(task("e", 1, 2, 0)), Settings(5000))
    assert (alone.measures("e").greatest, alone.busy, alone.switches) == (0, 0, 0)


def test_worst_jitter_is_the_critical_instant_of_the_analysis() -> None:
    tasks = [task("a", 2, 10, 3, jitter=12), task("b", 1, 20, 4)]
    found = simulate(on(*tasks), Settings(60))
    assert found.measures("b").greatest == analyse(tasks).result("b").wcrt == 13
    assert [job.arrival for job in found.jobs if job.task == "a"][:3] == [-12, -2, 8]


def test_nothing_to_simulate_is_a_simulation() -> None:
    found = simulate(Processor("p", ()), Settings(10))
    assert (found.end, found.idle, found.jobs, found.cut) == (10, 10, (), False)
    assert hyperperiod([]) == 1


def test_two_tasks_of_one_name_are_refused() -> None:
    with pytest.raises(ValueError, match="one name"):
        on(task("a", 1, 10, 1), task("a", 2, 10, 1))


# ------------------------------------------------------------------ the C-Forge paper

COSTS = {"DC": 12, "MS1": 34, "MS2": 15, "Nav": 6, "OA": 10, "Path": 42, "Pilot": 6}

SHARED = {
    "Nav": [(1, "Pilot")],
    "Path": [(2, "Nav")],
    "MS2": [(14, "OA")],
    "DC": [(2, "MS1"), (1, "OA")],
    "OA": [(5, "MS1"), (2, "MS2")],
}
"""How long a component starts in a section that it shares with another: a reconstruction that explains the table."""

DEPLOYMENTS = {
    2: {
        "DC": (2, 150, 85), "MS1": (5, 100, 50), "MS2": (3, 150, 76), "Nav": (6, 100, 12), "OA": (4, 150, 75),
        "Path": (1, 500, 254), "Pilot": (7, 100, 7),
    },
    3: {
        "DC_and_OA": (2, 150, 85), "MS1": (4, 100, 53), "MS2": (3, 150, 70), "Nav_and_Pilot": (5, 100, 12),
        "Path": (1, 500, 254),
    },
    5: {"MS1_and_100": (3, 100, 46), "MS2_and_150": (2, 150, 85), "Path": (1, 500, 254)},
}  # fmt: skip
"""Threads as (priority, period, response time in table III)."""

MERGED = {
    "DC_and_OA": ("OA", "DC"),
    "Nav_and_Pilot": ("Nav", "Pilot"),
    "MS1_and_100": ("MS1", "Nav", "Pilot"),
    "MS2_and_150": ("MS2", "DC", "OA"),
}
"""What the threads of several components execute, in order; others are named as their component."""


def deployment(number: int) -> Processor:
    """The threads of a deployment; a section shared inside one thread protects nothing."""
    threads = DEPLOYMENTS[number]
    home = {component: thread for thread in threads for component in MERGED.get(thread, (thread,))}
    uses: dict[str, list[Hold]] = {thread: [] for thread in threads}
    locked: dict[str, list[Locked]] = {thread: [] for thread in threads}
    for component, shares in SHARED.items():
        holds = []
        for length, partner in shares:
            if home[partner] != home[component]:
                resource = (f"{component}/{partner}",)
                holds.append(Hold(resource, length))
                uses[home[partner]].append(Hold(resource, 0))
        locked[home[component]].append(Locked(component, tuple(holds)))
    found = []
    for thread, (priority, period, _) in threads.items():
        work = tuple(constant(component, COSTS[component]) for component in MERGED.get(thread, (thread,)))
        one = Task(thread, priority, period, period, work)
        found.append(SimTask(one, tuple(uses[thread]), tuple(locked[thread])))
    return Processor("pc", tuple(found))


@pytest.mark.parametrize("number", DEPLOYMENTS)
def test_table_3_of_c_forge_is_what_an_eager_ceiling_simulates(number: int) -> None:
    """All 15 response times, which no blocking term explains; a ceiling raised on entry gives the plain ones."""
    published = {thread: response for thread, (_, _, response) in DEPLOYMENTS[number].items()}
    eager = simulate(deployment(number), Settings(3000, order=Order.NAME, protocol=Protocol.EAGER))
    assert {one.task: one.greatest for one in eager.tasks} == published
    immediate = simulate(deployment(number), Settings(3000))
    plain = {one.task: one.wcrt for one in analyse([t.task for t in deployment(number).tasks]).results}
    assert {one.task: one.greatest for one in immediate.tasks} == plain


# ------------------------------------------------------------------ choices


def first(work: Workload, runs: Runs, count: int, length: int = 8, seed: int = 0) -> list[int]:
    source = steps(work, runs, length, generator(Settings(1, seed=seed), "x"))
    return [sum(part.cost for part in next(source)[1]) for _ in range(count)]


def test_worst_runs_are_witnesses_of_the_workload_curve() -> None:
    psm = psm_of(("s", 10, "h"), ("h", 1, "s"), ("s", 6, "m"), ("m", 9, "n"), ("n", 1, "s"))
    work = machine(psm)
    for length in range(1, 12):
        assert sum(first(work, Runs.WORST, length, length)) == work.curve.total(length)
    assert first(work, Runs.FIRST, 4) == [10, 1, 10, 1]


def test_random_runs_reach_every_start() -> None:
    psm = psm_of(("boot", 1, "run"), ("run", 9, "run"))
    starts = Counter(first(machine(psm), Runs.RANDOM, 1, seed=seed)[0] for seed in range(40))
    assert set(starts) == {1, 9}
    assert {first(frames("f", (1, 2, 3)), Runs.RANDOM, 1, seed=seed)[0] for seed in range(40)} == {1, 2, 3}
    assert first(frames("f", (1, 9, 3)), Runs.WORST, 3, 1) == [9, 3, 1]


def test_a_slow_part_runs_in_one_of_several_jobs() -> None:
    both = Task("a", 1, 10, 10, (constant("a", 1), constant("b", 3, period=30)))
    assert chart(simulate(on(both), Settings(40))).count("a") == 4 + 6


def test_the_horizon_is_the_hyperperiod_within_reach() -> None:
    tasks = on(task("a", 2, 4, 1), task("b", 1, 6, 2))
    assert horizon((tasks,), Asked()).length == 12
    far = on(task("a", 2, 1_000_003, 1), task("b", 1, 999_983, 2))
    reach = horizon((far,), Asked())
    assert not reach.whole and reach.length < 10**11
    assert horizon((far,), Asked(length=77)).length == 77
    assert horizon((tasks,), Asked(end=100)).length == 100
    late = on(task("a", 2, 4, 3), task("b", 1, 8, 1), task("c", 0, 8, 1, deadline=40))
    assert horizon((late,), Asked()).length == 8


# ------------------------------------------------------------------ laws


@settings(max_examples=40, deadline=None)
@given(
    systems(),
    st.integers(0, 99),
    st.sampled_from(Runs),
    st.sampled_from(Offsets),
    st.sampled_from(Jitter),
    st.sampled_from(Execution),
    st.sampled_from(Order),
)
def test_every_run_is_a_schedule(
    tasks: list[Task], seed: int, runs: Runs, offsets: Offsets, jitter: Jitter, execution: Execution, order: Order
) -> None:
    """One job at a time, none before its release, none idle while work is ready, jobs of a task in order."""
    choices = Settings(120, seed, offsets, runs, jitter, Arrivals.SPORADIC, execution, order)
    found = simulate(on(*tasks), choices)
    assert found == simulate(on(*tasks), choices)
    at = 0
    executed: Counter[tuple[str, int]] = Counter()
    jobs = {(job.task, job.number): job for job in found.jobs}
    for one in found.segments:
        assert at <= one.start < one.end <= found.end
        if one.start > at:
            waiting = [job for job in jobs.values() if job.release < one.start and (job.finish or 121) > at]
            assert not [job for job in waiting if job.cost and job.release <= at < (job.finish or 121)]
        at = one.end
        job = jobs[one.task, one.job]
        assert job.release <= one.start and (job.finish is None or one.end <= job.finish)
        executed[one.task, one.job] += one.end - one.start
    assert all(job.cost == executed[key] for key, job in jobs.items())
    assert sum(executed.values()) == found.busy
    priorities = {one.name: one.priority for one in tasks}
    for wait in waits(found):
        running = [s for s in found.segments if s.start < wait.end and s.end > wait.start]
        assert all(priorities[s.task] >= priorities[wait.task] for s in running)


def test_a_cut_simulation_says_so() -> None:
    found = simulate(on(task("a", 1, 2, 1)), Settings(10**9, events=1000))
    assert found.cut and found.events == 1000 and found.end < 2000
    assert found.measures("a").finished > 400


def test_it_is_fast_enough_to_look_at() -> None:
    """Twenty thousand events of 20 tasks, in many times the budget of an idle machine."""
    tasks = [task(f"t{n}", 20 - n, 100 + 7 * n, 4) for n in range(20)]
    begun = time.process_time()
    found = simulate(on(*tasks), Settings(10**9, events=20_000))
    assert found.events == 20_000
    assert time.process_time() - begun < 6


def test_sections_of_a_task_become_stays_by_label() -> None:
    sections = (Section("R", "t", "", 3, "t"), Section("S", "t", "", 3, "t"), Section("Q", "t", "", 2))
    one = simulated(task("t", 1, 10, 5, sections=sections))
    assert one.locked == (Locked("t", (Hold(("R", "S"), 3),)),)
    assert one.holds == (Hold(("Q",), 2),)
    assert Kind.TASK is one.task.kind and Method.TRACE.value == "trace"


def test_a_task_that_waits_leaves_the_processor_and_stays_below_its_bound() -> None:
    """C = 5, T = 10, that waits up to 4, above a task of 5: naive 10, true 15."""
    parts = (CostPart("a", 1), CostPart("wait", 0), CostPart("b", 4))
    psm = make_psm("c", "s", [PsmTransition("s", "s", 5, parts=parts)])
    plain = task("c", 2, 10, machine(psm))
    own = constant("c", 9)
    low = task("l", 1, 100, 5)
    found = analyse([with_waits(plain, (own,), 9), low])
    waiting = SimTask(executed(with_waits(plain, (own,), 9)), waits=(("wait", 4),))
    longest = simulate(on(waiting, low), Settings(60))
    assert chart(longest) == "cllllcccclc----cccc-" + 4 * "c----cccc-"
    seen = [longest]
    seen += [
        simulate(on(waiting, low), Settings(60, seed, Offsets.RANDOM, execution=Execution.RANDOM)) for seed in range(30)
    ]
    for one in seen:
        assert (one.measures("l").greatest or 0) <= (found.result("l").wcrt or 0) == 15
        assert (one.measures("c").greatest or 0) <= 9
    assert (longest.preemptions, longest.idle) == (1, 60 - 5 * 6 - 5)
    assert [w.end - w.start for w in longest.waits] == [4] * len(longest.waits)
