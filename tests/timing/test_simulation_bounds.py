"""No simulation exceeds the analysis: random systems with machines, jitter, sections, interrupts, context switches.

MAUVE_SIMULATED_SYSTEMS=5000 makes the long form.
"""

from __future__ import annotations

import os
import random

import pytest

from mauve.records import changed
from mauve.timing.psm import Psm, PsmTransition, make_psm
from mauve.timing.response import Caveat, Method, analyse
from mauve.timing.simulation.engine import simulate
from mauve.timing.simulation.outcome import Outcome
from mauve.timing.simulation.system import (
    Arrivals,
    Execution,
    Hold,
    Jitter,
    Locked,
    Offsets,
    Order,
    Processor,
    Runs,
    Settings,
    SimTask,
)
from mauve.timing.task import (
    Interrupt,
    Kind,
    Platform,
    Section,
    Task,
    Workload,
    constant,
    frames,
    machine,
    on_platform,
    table,
    total_load,
)

SYSTEMS = int(os.environ.get("MAUVE_SIMULATED_SYSTEMS", "90"))


def random_psm(name: str, rng: random.Random, most: int) -> Psm:
    states = [f"s{n}" for n in range(rng.randint(1, 4))]
    arrows = []
    for state in states:
        for target in rng.sample(states, rng.randint(0, len(states))):
            costs = [rng.randint(0, most) for _ in range(rng.choice((1, 1, 2)))]
            arrows += [PsmTransition(state, target, cost) for cost in costs]
    return make_psm(name, states[0], arrows, states)


def random_work(name: str, period: int, rng: random.Random) -> tuple[Workload, ...]:
    most = max(1, period // 3)
    match rng.randrange(7):
        case 0 | 1 | 2:
            return (machine(random_psm(name, rng, most)),)
        case 3:
            return (frames(name, [rng.randint(0, most) for _ in range(rng.randint(1, 3))]),)
        case 4:
            rises = sorted((rng.randint(0, most) for _ in range(rng.randint(1, 4))), reverse=True)
            return (table(name, [sum(rises[: n + 1]) for n in range(len(rises))]),)
        case 5:
            slow = machine(random_psm(f"{name}.slow", rng, most), period * rng.randint(1, 3))
            return slow, constant(f"{name}.fast", rng.randint(0, most // 2))
        case _:
            return (constant(name, rng.randint(0, most)),)


def random_hold(rng: random.Random) -> Hold:
    if rng.random() < 0.1:
        return Hold((), rng.randint(1, 4), above_all=True)
    return Hold(tuple(rng.sample("RST", rng.choice((1, 1, 2)))), rng.randint(0, 4))


def random_system(rng: random.Random) -> Processor:
    """Tasks with everything, and the blocking that their sections cause by the ceiling rule."""
    size = rng.randint(1, 5)
    drafts: list[SimTask] = []
    for number in range(size):
        name, period = f"t{number}", rng.randint(5, 40)
        work = random_work(name, period, rng)
        jitter = rng.randint(0, 2 * period) if rng.random() < 0.3 else 0
        deadline = rng.randint(1, 3 * period)
        holds = tuple(random_hold(rng) for _ in range(rng.choice((0, 0, 1, 2))))
        locked = tuple(
            Locked(part.name, tuple(random_hold(rng) for _ in range(rng.choice((0, 1, 2))))) for part in work
        )
        sections = tuple(
            Section(resource, name, "", hold.length, above_all=hold.above_all)
            for hold in (*holds, *(inner for part in locked for inner in part.holds))
            for resource in hold.resources or ("",)
        )
        preemptive, tail = rng.random() < 0.85, rng.randint(1, 6) if rng.random() < 0.15 else 0
        task = Task(
            name, rng.randint(1, size), period, deadline, work, jitter,
            sections=sections, preemptive=preemptive, tail=tail,
        )  # fmt: skip
        drafts.append(SimTask(task, holds, locked, sporadic=rng.random() < 0.5))
    interrupts = tuple(
        Interrupt(f"irq {n}", rng.randint(20, 60), rng.randint(0, 3), rng.choice((Kind.TICK, Kind.INTERRUPT)))
        for n in range(rng.choice((0, 0, 1, 2)))
    )
    platform = Platform(rng.choice((0, 0, 1)), interrupts)
    return on(platform, drafts)


def on(platform: Platform, drafts: list[SimTask]) -> Processor:
    tasks = on_platform([one.task for one in drafts], platform)
    found = {one.task.name: one for one in drafts}
    return Processor(
        "p", tuple(changed(found[t.name], task=t) if t.name in found else SimTask(t, sporadic=True) for t in tasks)
    )


def random_settings(rng: random.Random, length: int) -> Settings:
    return Settings(
        length=length,
        seed=rng.randrange(1000),
        offsets=rng.choice(list(Offsets)),
        runs=rng.choice(list(Runs)),
        jitter=rng.choice(list(Jitter)),
        arrivals=rng.choice(list(Arrivals)),
        execution=rng.choice((Execution.WORST, Execution.WORST, Execution.RANDOM)),
        order=rng.choice(list(Order)),
    )


def excesses(found: Outcome, bounds: dict[str, int | None]) -> list[str]:
    return [
        f"{one.task}: {one.greatest} > {bounds[one.task]} with {found.settings}"
        for one in found.tasks
        if one.kind is Kind.TASK
        and one.greatest is not None
        and (bound := bounds[one.task]) is not None
        and one.greatest > bound
    ]


def bounds_of(tasks: list[Task], method: Method) -> dict[str, int | None]:
    return {result.task: result.wcrt for result in analyse(tasks, method, steps=3000).results}


@pytest.mark.parametrize("part", range(3))
def test_no_simulated_response_exceeds_its_bound(part: int) -> None:
    rng = random.Random(part)
    compared = attained = 0
    for _ in range(SYSTEMS // 3):
        processor = random_system(rng)
        tasks = [one.task for one in processor.tasks]
        every = [bounds_of(tasks, method) for method in (Method.TRACE, Method.EXACT, Method.SPORADIC)]
        settings = [random_settings(rng, 400) for _ in range(5)]
        for one in [Settings(400), *settings]:
            found = simulate(processor, one)
            for bounds in every:
                assert not excesses(found, bounds), processor
            compared += sum(m.greatest is not None and every[0].get(m.task) is not None for m in found.tasks)
            attained += sum(m.greatest is not None and m.greatest == every[0].get(m.task) for m in found.tasks)
    assert compared > SYSTEMS
    assert attained > compared // 20, "the simulations do not come near the bounds"


def test_the_worst_runs_often_attain_the_bound() -> None:
    """Without sections, a synchronous start with worst runs is the critical instant of the trace method."""
    rng = random.Random(7)
    equal = total = 0
    for _ in range(60):
        processor = random_system(rng)
        plain = Processor("p", tuple(changed(one, holds=(), locked=()) for one in processor.tasks))
        tasks = [changed(one.task, sections=()) for one in plain.tasks]
        if total_load(tasks) >= 1:
            continue
        bounds = bounds_of(tasks, Method.TRACE)
        for one in simulate(plain, Settings(600)).tasks:
            if one.kind is Kind.TASK and one.greatest is not None:
                total += 1
                equal += one.greatest == bounds[one.task]
    assert total > 60
    assert equal > total // 2


def test_the_exact_method_was_compared() -> None:
    """What it covers is met in these systems."""
    rng = random.Random(3)
    covered = 0
    for _ in range(40):
        found = analyse([one.task for one in random_system(rng).tasks], Method.EXACT, steps=3000)
        covered += sum(result.wcrt is not None and Caveat.FELL_BACK not in result.caveats for result in found.results)
    assert covered > 20
