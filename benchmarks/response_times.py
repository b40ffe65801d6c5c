"""The figures of the timing room: `python benchmarks/response_times.py [--quick]`.

One process, CPU time, medians: response times of random sets of 10, 50 and 200 tasks (log-uniform periods, and harmonic
ones), the workload curve of a machine of 200 states, the exact method on two machines, a thousand components with
machines, and priorities and sensitivities of 50 tasks. Beside each figure stands its budget; a loop of interpreted
arithmetic is measured first, as machines differ.
"""

from __future__ import annotations

import argparse
import random
import statistics
import sys
import time
from collections.abc import Callable, Iterable
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from mauve.timing.priorities import optimal, priority_ranges, rate_monotonic
from mauve.timing.psm import Psm, PsmTransition, make_psm
from mauve.timing.response import Method, analyse
from mauve.timing.sensitivity import sensitivity
from mauve.timing.task import Task, constant, machine
from mauve.timing.traces import PsmCurve

LOAD = 0.75


def plain_set(count: int, harmonic: bool, rng: random.Random) -> list[Task]:
    """Constant costs, rate monotonic priorities, periods from 10^4 to 10^6."""
    shares = [rng.random() + 1e-6 for _ in range(count)]
    if harmonic:
        periods = [10_000 * 2 ** rng.randrange(7) for _ in range(count)]
    else:
        periods = [int(10 ** rng.uniform(4, 6)) for _ in range(count)]
    ranks = rate_monotonic(periods)
    costs = [max(1, int(LOAD * share / sum(shares) * period)) for share, period in zip(shares, periods, strict=True)]
    return [
        Task(f"t{n}", ranks[n], period, period, (constant(f"t{n}", cost),))
        for n, (period, cost) in enumerate(zip(periods, costs, strict=True))
    ]


def random_machine(states: int, transitions: int, most: int, rng: random.Random) -> Psm:
    """A machine in which a ring makes every state reachable."""
    arrows = [PsmTransition(f"s{n}", f"s{(n + 1) % states}", rng.randint(0, most)) for n in range(states)]
    while len(arrows) < transitions:
        source, target = rng.randrange(states), rng.randrange(states)
        arrows.append(PsmTransition(f"s{source}", f"s{target}", rng.randint(0, most)))
    return make_psm("m", "s0", arrows)


def two_machines(rng: random.Random) -> list[Task]:
    """Two machines of 10 states above a task that responds within its period."""
    high = [
        Task(f"m{n}", 3 - n, period, period, (machine(random_machine(10, 20, 20, rng)),))
        for n, period in enumerate((rng.randint(70, 90), rng.randint(100, 140)))
    ]
    return [*high, Task("low", 1, 2000, 2000, (constant("low", 150),))]


def components(count: int, rng: random.Random) -> list[Task]:
    """Machines of 5 states, log-uniform periods, a load near 0.7."""
    periods = [int(10 ** rng.uniform(7, 9)) for _ in range(count)]
    ranks = rate_monotonic(periods)
    return [
        Task(f"c{n}", ranks[n], period, period, (machine(random_machine(5, 9, int(1.2 * period / count), rng)),))
        for n, period in enumerate(periods)
    ]


def seconds(work: Callable[[], object]) -> float:
    """The CPU time of one call."""
    start = time.process_time()
    work()
    return time.process_time() - start


def show(name: str, times: Iterable[float], budget: float | None) -> None:
    """A line: median, least, and the budget in milliseconds."""
    listed = list(times)
    median = 1000 * statistics.median(listed)
    line = f"{name:<52} {median:9.3f} ms   least {1000 * min(listed):9.3f} ms   of {len(listed)}"
    print(line + (f"   budget {1000 * budget:g} ms" if budget else ""), flush=True)


def main() -> None:
    """Measure everything."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--quick", action="store_true", help="a tenth of the sets")
    sets = 100 if parser.parse_args().quick else 1000
    show("a loop of interpreted arithmetic, 10^6 steps", [seconds(lambda: sum(i & 7 for i in range(10**6)))], None)
    for count, budget in ((10, 0.0002), (50, 0.003), (200, 0.04)):
        for harmonic in (False, True):
            rng = random.Random(count)
            every = (plain_set(count, harmonic, rng) for _ in range(sets))
            kind = "harmonic" if harmonic else "log-uniform"
            show(f"{count} tasks, {kind} periods", (seconds(lambda s=one: analyse(s)) for one in every), budget)  # type: ignore[misc]
    rng = random.Random(1)
    psms = [random_machine(200, 600, 10**9, rng) for _ in range(20)]
    show("E(l), l <= 200, of 200 states and 600 transitions", (seconds(lambda p=p: PsmCurve(p).total(200)) for p in psms), 0.05)  # type: ignore[misc]  # noqa: E501
    pairs = [two_machines(rng) for _ in range(50)]
    show("exact, two machines of 10 states", (seconds(lambda s=s: analyse(s, Method.EXACT)) for s in pairs), 0.02)  # type: ignore[misc]
    big = [components(1000, random.Random(seed)) for seed in range(3)]
    show("1000 components with machines", (seconds(lambda s=s: analyse(s)) for s in big), 5.0)  # type: ignore[misc]
    fifty = [plain_set(50, False, random.Random(seed)) for seed in range(5)]
    show("optimal priorities of 50 tasks", (seconds(lambda s=s: optimal(s)) for s in fifty), None)  # type: ignore[misc]
    show("priority ranges of 50 tasks", (seconds(lambda s=s: priority_ranges(s)) for s in fifty), None)  # type: ignore[misc]
    show("costs, periods and speed of 50 tasks", (seconds(lambda s=s: sensitivity(s)) for s in fifty), None)  # type: ignore[misc]


if __name__ == "__main__":
    main()
