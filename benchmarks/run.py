"""The budgets of the command line, measured: `python benchmarks/run.py [--runs N] [--python PYTHON] [--json FILE]`.

Each figure is the CPU time (user + system) of a whole child process as the operating system counts it, the median of
several runs, and the least, which other work on the machine inflates less. Machines differ: beside each figure stand
its ratios to a bare interpreter's start and to a loop of interpreted arithmetic, both measured in between. Caches lie
in a folder of this run; `warm` means that one run went before. What is measured is the copy of mauvec installed beside
PYTHON, or else this checkout; either from compiled bytecode.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from models import pipeline

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
TTRK = ROOT / "examples" / "ttrk"
CODEL = "Command_rotate"
PACKAGES = ("lark", "capstone", "pyelftools", "pulp")

BARE = ("-c", "pass")
LOOP = ("-c", "x = 0\nfor i in range(3_000_000):\n    x = (x * 5 + i) & 65535")

Command = tuple[str, float | None, tuple[str, ...]]
"""A name, a budget, and the words of the command."""


@dataclass(frozen=True)
class Case:
    """A command, and the CPU seconds it may take; a cold one runs without the caches of earlier runs."""

    name: str
    budget: float
    arguments: tuple[str, ...]


@dataclass(frozen=True)
class Figure:
    """Medians in seconds; `least` and `spread` are the smallest CPU time and how far the greatest is above it."""

    name: str
    budget: float | None
    cpu: float
    least: float
    wall: float
    spread: float
    memory_mib: float


def main() -> int:
    arguments = _arguments()
    with tempfile.TemporaryDirectory() as folder:
        environment = _environment(folder, arguments.python is None)
        python = arguments.python or sys.executable
        mauvec = (python, "-P", "-m", "mauve")
        cases = _cases(Path(folder))
        for case in cases:  # bytecode, the parse table, results of unchanged binaries
            _once((*mauvec, *case.arguments), environment)
        commands: list[Command] = [("bare interpreter", None, (python, *BARE))]
        commands += [("calibration loop", None, (python, *LOOP))]
        commands += [(case.name, case.budget, (*mauvec, *case.arguments)) for case in cases]
        figures = _measure(commands, arguments.runs, environment)
        machine = _machine() | {"measured": _copy(python, environment)}
    _print(figures, arguments.runs, machine)
    print(f"\n{CODEL}: {_size()}")
    if arguments.json:
        document = {"machine": machine, "runs": arguments.runs, "figures": [asdict(figure) for figure in figures]}
        Path(arguments.json).write_text(json.dumps(document, indent=2) + "\n", encoding="utf-8")
    return 0 if all(figure.budget is None or figure.cpu <= figure.budget for figure in figures) else 1


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Measure the budgets of the command line.")
    parser.add_argument("--runs", type=int, default=7, help="runs of each command (default: 7)")
    about = "the interpreter of an environment with mauvec installed (default: this one, with this checkout)"
    parser.add_argument("--python", metavar="PYTHON", help=about)
    parser.add_argument("--json", metavar="FILE", help="write the figures to a file, too")
    return parser.parse_args()


def _environment(folder: str, checkout: bool) -> dict[str, str]:
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "MAUVEC"))}
    kept["XDG_CACHE_HOME"] = f"{folder}/cache"
    if checkout:  # its bytecode is kept for this run, whatever the environment says about writing bytecode
        kept |= {"PYTHONPYCACHEPREFIX": f"{folder}/bytecode", "PYTHONPATH": str(ROOT)}
    return kept


def _copy(python: str, environment: dict[str, str]) -> str:
    """Where the measured copy lies, and whether its bytecode does; SystemExit where there is none."""
    program = "import mauve.cli, os; print(mauve.__file__, os.path.exists(mauve.cli.__cached__))"
    found = subprocess.run([python, "-P", "-c", program], env=environment, capture_output=True, text=True)
    if found.returncode:
        raise SystemExit(f"{python} has no mauvec")
    place, _, compiled = found.stdout.strip().rpartition(" ")
    kind = "this checkout" if Path(place).is_relative_to(ROOT) else "an installed copy"
    return f"{kind}, {'compiled' if compiled == 'True' else 'NOT compiled'} ({python} -m mauve)"


def _cases(folder: Path) -> list[Case]:
    small, large = folder / "small.mauve", folder / "large.mauve"
    small.write_text(pipeline(150), encoding="utf-8")
    large.write_text(pipeline(10_000), encoding="utf-8")
    robot, board = str(TTRK / "ttrk.mauve"), f"{TTRK}/ttrk.mauve:ttrk_arm9"
    codel = ("wcet", str(TTRK / "ttrk.elf"), CODEL, "--board", board, "--no-cache", "--jobs", "1")
    return [
        Case("check, 150 lines, no binaries, warm", 0.35, ("check", str(small))),
        Case("check, TTRK, binary unchanged, warm", 0.45, ("check", robot)),
        Case("10 000 lines parsed and resolved", 5.0, ("check", str(large), "--emit", "model")),
        Case(f"one codel ({CODEL}), cold", 1.0, codel),
    ]


def _measure(commands: Sequence[Command], runs: int, environment: dict[str, str]) -> list[Figure]:
    """All commands in turn, as often as asked: a slow spell of the machine meets all of them."""
    found: dict[str, list[tuple[float, float, float]]] = {name: [] for name, _, _ in commands}
    for _ in range(runs):
        for name, _, command in commands:
            found[name].append(_once(command, environment))
    figures = []
    for name, budget, _ in commands:
        cpu, wall, memory = (sorted(values) for values in zip(*found[name], strict=True))
        middle, spread = statistics.median(cpu), cpu[-1] - cpu[0]
        figures.append(Figure(name, budget, middle, cpu[0], statistics.median(wall), spread, memory[-1]))
    return figures


def _once(command: Sequence[str], environment: dict[str, str]) -> tuple[float, float, float]:
    """CPU seconds, wall seconds and MiB of one child; its output goes nowhere."""
    nowhere = [(os.POSIX_SPAWN_OPEN, stream, os.devnull, os.O_WRONLY, 0) for stream in (1, 2)]
    started = time.perf_counter()
    child = os.posix_spawn(command[0], list(command), environment, file_actions=nowhere)
    _, status, usage = os.wait4(child, 0)
    wall = time.perf_counter() - started
    if os.waitstatus_to_exitcode(status) not in (0, 1):
        raise SystemExit(f"`{' '.join(command)}` ended with {os.waitstatus_to_exitcode(status)}")
    return usage.ru_utime + usage.ru_stime, wall, usage.ru_maxrss / 1024


def _print(figures: Sequence[Figure], runs: int, machine: dict[str, str]) -> None:
    for name, value in machine.items():
        print(f"{name}: {value}")
    print(f"medians of {runs} runs; CPU seconds of the whole process, children included\n")
    bare, loop = figures[0].cpu, figures[1].cpu
    columns = "".join(f" {name:>7}" for name in ("budget", "CPU", "least", "spread", "wall"))
    print(f"{'':<38}{columns} {'MiB':>5} {'x bare':>7} {'x loop':>7}")
    for each in figures:
        budget = "" if each.budget is None else f"{each.budget:.2f}"
        verdict = "" if each.budget is None else "  within" if each.cpu <= each.budget else "  OVER"
        print(
            f"{each.name:<38} {budget:>7} {each.cpu:>7.3f} {each.least:>7.3f} {each.spread:>7.3f} {each.wall:>7.3f} "
            f"{each.memory_mib:>5.0f} {each.cpu / bare:>7.1f} {each.cpu / loop:>7.2f}{verdict}"
        )


def _machine() -> dict[str, str]:
    packages = []
    for name in PACKAGES:
        try:
            packages.append(f"{name} {version(name)}")
        except PackageNotFoundError:
            packages.append(f"{name} missing")
    load = ", ".join(f"{value:.1f}" for value in os.getloadavg())
    return {
        "machine": f"{_processor()}, {os.cpu_count()} processors, load {load}",
        "system": f"{platform.system()} {platform.release()}",
        "python": f"{platform.python_implementation()} {platform.python_version()}, {', '.join(packages)}",
    }


def _size() -> str:
    """How much code the codel is, with all that it calls."""
    from mauve.wcet.binary.callgraph import build_program
    from mauve.wcet.binary.elf import Binary, Symbol, load

    binary = load(TTRK / "ttrk.elf")
    function = binary.function(CODEL) if isinstance(binary, Binary) else None
    if not isinstance(binary, Binary) or not isinstance(function, Symbol):
        return "not found"
    graphs = build_program(binary, function.key)
    size = sum(block.size for graph in graphs.values() for block in graph.blocks)
    return f"{size // 4} instructions in {len(graphs)} functions, the library's included"


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.machine()
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.machine()


if __name__ == "__main__":
    sys.exit(main())
