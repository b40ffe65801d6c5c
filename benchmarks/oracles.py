"""Response times against other tools on random sets: `python benchmarks/oracles.py [--sets N]`.

Needs an interpreter with the packages `response-time-analysis` (pyRTA) and `simso` from PyPI, which mauvec does not
depend on: `python -m venv oracle && oracle/bin/pip install response-time-analysis simso`, then run this with
`oracle/bin/python`. It ends with 1 at the first disagreement, and with 2, saying so, where a package is missing.

* pyRTA: preemptive with jitter, deadlines beyond the period, and stretches without preemption; and without
  preemption. It measures from the release and lets a lower job start one unit before: both are brought in line.
* SimSo: the simulated maximum over the busy period after a synchronous release, jitters as early as they can be.
"""

from __future__ import annotations

import argparse
import random
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from mauve.records import changed
from mauve.timing.response import analyse
from mauve.timing.task import Section, Task, constant

KINDS = ("plain", "jitter", "arbitrary", "sections", "rigid")


def random_set(kind: str, rng: random.Random, count: int = 0) -> list[Task]:
    """A set with a load between 0.4 and 0.95; deadlines do not matter here, responses may exceed periods."""
    count = count or rng.randint(2, 8)
    shares = [rng.random() + 0.05 for _ in range(count)]
    load = rng.uniform(0.4, 0.95)
    periods = [rng.choice([20, 25, 40, 50, 80, 100, 125, 200, 250, 400]) + rng.randint(0, 3) for _ in range(count)]
    order = rng.sample(range(1, count + 1), count) if kind == "arbitrary" else None
    by_rate = sorted(range(count), key=lambda n: -periods[n])
    tasks = []
    for n, period in enumerate(periods):
        cost = max(1, int(load * shares[n] / sum(shares) * period))
        priority = order[n] if order else by_rate.index(n) + 1
        name = f"t{n}"
        stretch = rng.randint(1, cost) if kind == "sections" else 0
        tasks.append(
            Task(
                name,
                priority,
                period,
                50 * period,
                (constant(name, cost),),
                jitter=rng.randint(0, 2 * period) if kind == "jitter" else 0,
                sections=(Section("", name, "np", stretch, above_all=True),) if stretch else (),
                preemptive=kind != "rigid",
            )
        )
    return tasks


# ------------------------------------------------------------------------------------------------------------ pyRTA
def pyrta(tasks: list[Task]) -> list[int | None]:
    """Its bounds from the release."""
    import response_time_analysis as rta
    from response_time_analysis import model

    def execution(one: Task) -> Any:
        cost = model.WCET(one.demand(1))
        if not one.preemptive:
            return model.FullyNonPreemptive(cost)
        if one.sections:
            return model.FloatingNonPreemptive(cost, one.sections[0].length)
        return model.FullyPreemptive(cost)

    theirs = [
        model.Task(
            arrivals=model.PeriodicWithJitter(one.period, one.jitter) if one.jitter else model.Periodic(one.period),
            execution=execution(one),
            priority=model.Priority(one.priority),
        )
        for one in tasks
    ]
    whole = model.taskset(*theirs)
    return [rta.fp.rta(whole, one, model.IdealProcessor()).response_time_bound for one in theirs]


def ours_from_release(tasks: list[Task]) -> list[int | None]:
    """Our bounds from the release, with the blocking of whole units: one less, as a lower job has begun already."""
    found = []
    for one in tasks:
        lower = [other for other in tasks if other.priority < one.priority]
        lengths = [other.demand(1) if not other.preemptive else 0 for other in lower]
        lengths += [section.length for other in lower for section in other.sections]
        blocking = max([length - 1 for length in lengths], default=0)
        level = [changed(t, sections=(), preemptive=True) for t in tasks if t.priority >= one.priority and t is not one]
        analysis = analyse([*level, changed(one, sections=(), blocking=max(0, blocking))])
        found.append(analysis.result(one.name).from_release)
    return found


# ------------------------------------------------------------------------------------------------------------ SimSo
def simso(tasks: list[Task], length: int) -> list[int]:
    """The greatest responses from the release that it sees after a synchronous release."""
    from simso.configuration import Configuration
    from simso.core import Model

    configuration = Configuration()
    configuration.cycles_per_ms = 1
    configuration.duration = length
    for number, one in enumerate(tasks, 1):
        dates = [max(0, q * one.period - one.jitter) for q in range(length // one.period + 3)]
        configuration.add_task(
            name=one.name,
            identifier=number,
            task_type="Sporadic",
            abort_on_miss=False,
            period=one.period,
            wcet=one.demand(1),
            deadline=50 * one.period,
            list_activation_dates=dates,
            data={"priority": one.priority},
        )
    configuration.add_processor(name="cpu", identifier=1)
    configuration.scheduler_info.clas = "simso.schedulers.FP"
    configuration.check_all()
    model = Model(configuration)
    model.run_model()
    worst = []
    for task in model.results.tasks.values():
        seen = [job.response_time for job in task.jobs if job.response_time is not None]
        worst.append(int(max(seen, default=0)))
    return worst


def main() -> int:
    """Compare; 0 where all agree."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--sets", type=int, default=1000, help="sets of each kind (default: 1000)")
    parser.add_argument("--seed", type=int, default=1)
    arguments = parser.parse_args()
    missing = [name for name in ("response_time_analysis", "simso") if find_spec(name) is None]
    if missing:
        print(f"NOT COMPARED: this interpreter has no {' and no '.join(missing)}", file=sys.stderr)
        return 2
    for kind in KINDS:
        rng = random.Random(arguments.seed)
        for number in range(arguments.sets):
            tasks = random_set(kind, rng)
            ours, theirs = ours_from_release(tasks), pyrta(tasks)
            if ours != theirs:
                print(f"pyRTA, {kind}, set {number}: ours {ours}, theirs {theirs}\n{tasks}")
                return 1
        print(f"pyRTA, {kind}: {arguments.sets} sets agree", flush=True)
    for kind in ("plain", "jitter", "arbitrary"):
        rng = random.Random(arguments.seed)
        for number in range(arguments.sets):
            tasks = random_set(kind, rng, count=rng.randint(2, 4))
            results = analyse(tasks).results
            busy = max(result.busy_period or 0 for result in results)
            expected = [result.from_release for result in results]
            seen = simso(tasks, busy + max(one.period for one in tasks) + 1)
            if seen != expected:
                print(f"SimSo, {kind}, set {number}: ours {expected}, seen {seen}\n{tasks}")
                return 1
        print(f"SimSo, {kind}: {arguments.sets} sets agree", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
