"""The budgets of missions, measured: `python benchmarks/missions.py [--runs N] [--json FILE]`.

Each figure is the least CPU time of several runs, each in a process of its own, after imports; memory is the peak of
the process. The missions are the coral mission of the mission paper, with more sensors, with more objectives, and as
several robots in one; the tests have them as plans (`tests/mission/coral.py`).
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
import os
import platform
import resource
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT)]

MIB = 1024


@dataclass(frozen=True)
class Case:
    """What is measured: its name, the sizes of the plan, the work, and budgets in seconds, per second and in MiB."""

    name: str
    plan: tuple[tuple[str, int], ...]
    work: str
    seconds: float | None = None
    rate: int | None = None
    memory: int | None = None


@dataclass(frozen=True)
class Figure:
    """States and edges found, CPU seconds, states per second, and the peak memory in MiB."""

    states: int
    edges: int
    seconds: float
    rate: int
    memory: int


CASES = (
    Case("coral mission: net, graph, all orders", (), "checked", seconds=0.1),
    Case("coral mission: alternatives graph", (), "graph"),
    Case("3 x sensors (7 hardware)", (("sensors", 3),), "graph", rate=25_000),
    Case("4 x sensors (9 hardware)", (("sensors", 4),), "graph", rate=25_000),
    Case("3 robots in one (9 hardware)", (("copies", 3),), "graph", rate=25_000),
    Case("5 x sensors (11 hardware)", (("sensors", 5),), "graph", seconds=5.0, memory=256),
    Case("5 x sensors: and all orders", (("sensors", 5),), "checked"),
    Case("10 x objectives (70, 3 hardware)", (("repeat", 10),), "graph", seconds=0.5, rate=8_000),
    Case("10 robots in one: local graphs", (("copies", 10),), "local", seconds=1.0),
    Case("coral mission: all markings", (), "markings"),
    Case("3 x sensors: all markings", (("sensors", 3),), "markings", rate=300_000, memory=128),
    Case("4 x sensors: all markings", (("sensors", 4),), "markings", rate=300_000),
)


def measure(case: Case) -> Figure:
    """One run in this process; the modules are imported before the clock starts."""
    from mauve.mission.confluence import confluence
    from mauve.mission.graph import AlternativesGraph, BudgetExceeded, MarkingsGraph
    from mauve.mission.local import local_graphs
    from mauve.mission.markings import markings_graph
    from mauve.mission.stable import alternatives_graph
    from mauve.mission.templates import build_net
    from tests.mission.coral import coral

    if case.work == "markings":
        import numpy  # noqa: F401

    plan = coral(**dict(case.plan))
    started = time.process_time()
    states, edges = 0, 0
    match case.work:
        case "graph" | "checked":
            graph = alternatives_graph(build_net(plan))
            assert isinstance(graph, AlternativesGraph)
            states, edges = len(graph.markings), len(graph.targets)
            if case.work == "checked":
                found = confluence(graph)
                assert found.holds
                assert found.complete
        case "local":
            graphs = local_graphs(plan)
            assert not isinstance(graphs, BudgetExceeded)
            states = sum(len(one.graph.markings) for one in graphs)
            edges = sum(len(one.graph.targets) for one in graphs)
        case _:
            full = markings_graph(build_net(plan))
            assert isinstance(full, MarkingsGraph)
            states, edges = full.states, full.edges
    seconds = time.process_time() - started
    memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // MIB
    return Figure(states, edges, seconds, round(states / seconds), memory)


def within(case: Case, figure: Figure) -> bool:
    """Whether a figure keeps the budgets of its case."""
    return (
        (case.seconds is None or figure.seconds <= case.seconds)
        and (case.rate is None or figure.rate >= case.rate)
        and (case.memory is None or figure.memory <= case.memory)
    )


def main() -> int:
    parser = argparse.ArgumentParser(description="Measure the budgets of missions.")
    parser.add_argument("--runs", type=int, default=5, help="runs of each case (default: 5)")
    parser.add_argument("--json", metavar="FILE", help="write the figures to a file, too")
    arguments = parser.parse_args()
    print(f"{platform.python_implementation()} {platform.python_version()}, {os.cpu_count()} processors, ", end="")
    print(f"load {os.getloadavg()[0]:.1f}; the fastest of {arguments.runs} runs, CPU seconds after imports\n")
    print(f"{'':<40}{'states':>10}{'edges':>12}{'seconds':>9}{'per s':>9}{'MiB':>6}  budget")
    found = [(case, best(case, arguments.runs)) for case in CASES]
    if arguments.json:
        document = [asdict(case) | asdict(figure) for case, figure in found]
        Path(arguments.json).write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    return 0 if all(within(case, figure) for case, figure in found) else 1


def best(case: Case, runs: int) -> Figure:
    """The fastest of several runs, printed."""
    figures = [apart(measure, case) for _ in range(runs)]
    figure = min(figures, key=lambda one: one.seconds)
    budgets = [
        f"{case.seconds} s" if case.seconds else "",
        f"{case.rate} per s" if case.rate else "",
        f"{case.memory} MiB" if case.memory else "",
    ]
    said = ", ".join(one for one in budgets if one)
    verdict = ("  within" if within(case, figure) else "  OVER") if said else ""
    print(
        f"{case.name:<40}{figure.states:>10}{figure.edges:>12}{figure.seconds:>9.3f}{figure.rate:>9}"
        f"{figure.memory:>6}  {said}{verdict}",
        flush=True,
    )
    return figure


def apart(work: Callable[[Case], Figure], case: Case) -> Figure:
    """The figure of a run in a fresh process, whose memory is its own."""
    context = multiprocessing.get_context("spawn")
    with context.Pool(1) as pool:
        made: Sequence[Figure] = pool.map(work, [case])
    return made[0]


if __name__ == "__main__":
    raise SystemExit(main())
