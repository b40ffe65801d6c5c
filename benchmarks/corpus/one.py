"""One image in a process of its own: analysed, executed on random inputs, compared. Prints one line of JSON.

    python benchmarks/corpus/one.py IMAGE SOURCE --mode inputs|initial|nofact [--inputs K] [--timeout S] [--observe S]

Executions are retraced in the graphs of the analysis as the soundness tests do it: counts are per entry of a loop and
per context.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import sys
import time
import traceback
from dataclasses import dataclass
from pathlib import Path
from random import Random
from typing import TYPE_CHECKING, Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(ROOT), str(ROOT / "tests")]

from images import CORES, name_of  # noqa: E402
from manifest import Manifest, content, read_manifest  # noqa: E402

if TYPE_CHECKING:
    from mauve.wcet.binary.elf import Binary
    from mauve.wcet.binary.lines import LineTable
    from mauve.wcet.flow.program import Programs
    from mauve.wcet.flow.result import ContextKey, ProgramFlow
    from mauve.wcet.ipet.bottom_up import FunctionBound

MOST_INSTRUCTIONS = 3_000_000
TIMED = 2
"""Executions that are also timed by the second model of the hardware, where it knows the core."""


def count_processor_time() -> None:
    """Deadlines of the analysis count processor time from now on: other work on the machine changes no result. To be
    called before the analysis is imported. No results of earlier runs are used."""
    time.monotonic = time.process_time
    os.environ["MAUVEC_CACHE"] = ""


@dataclass(frozen=True)
class Opened:
    """An image of which several entries are analysed: without facts, and without the linked data."""

    binary: Binary
    lines: LineTable
    programs: Programs


def opened(path: Path) -> Opened:
    """An image, read."""
    from mauve.wcet.binary.elf import ElfProblem, load
    from mauve.wcet.binary.lines import load_lines
    from mauve.wcet.flow.program import Programs

    binary = load(path)
    assert not isinstance(binary, ElfProblem), binary
    lines = load_lines(binary)
    return Opened(binary, lines, Programs(binary, lines=lines))


def analysed(
    path: Path, manifest: Manifest, core_name: str, mode: str, timeout: float, several: Opened | None = None
) -> tuple[dict[str, Any], Binary, ProgramFlow, dict[ContextKey, FunctionBound], LineTable]:
    """The figures of the analysis, as `mauvec wcet` makes it, and what it rests on."""
    from mauve.wcet.assemble import assemble
    from mauve.wcet.binary.elf import ElfProblem, load
    from mauve.wcet.binary.lines import load_lines
    from mauve.wcet.flow.program import Programs
    from mauve.wcet.hardware.board import Board, Memory
    from mauve.wcet.hardware.core import load_core
    from mauve.wcet.hardware.cost import board_problems
    from mauve.wcet.ipet.bottom_up import bound_program

    started = time.perf_counter()
    board = Board("corpus", core_name, 100_000_000, (Memory("all", 0, 1 << 32, 0, 0),), ())
    core, binary = load_core(core_name), load(path) if several is None else several.binary
    assert core is not None and not isinstance(binary, ElfProblem), binary
    lines = load_lines(binary) if several is None else several.lines
    facts = manifest.facts() if mode == "inputs" else ()
    symbol = binary.function(manifest.entry)
    assert not isinstance(symbol, ElfProblem), symbol.message
    assert several is None or mode == "nofact"
    programs = several.programs if several is not None else None
    programs = programs or Programs(binary, facts, initial_data=mode != "nofact", lines=lines)
    program = programs.program(symbol.key, timeout)
    bounds = bound_program(program, core, board)
    result = assemble(manifest.entry, program, bounds, core, board, board_problems(board, core), lines.source)
    used = resource.getrusage(resource.RUSAGE_SELF)
    row = {
        "seconds": round(used.ru_utime + used.ru_stime, 3),
        "wall": round(time.perf_counter() - started, 3),
        "megabytes": used.ru_maxrss // 1024,
        "bounded": result.bounded,
        "cycles": result.cycles,
        "problems": [
            {"kind": p.kind.value, "message": p.message, "address": p.address, "function": p.function,
             "source": p.source}
            for p in result.problems
        ],
        "notes": [f"{p.kind.value}: {p.message}" for p in result.notes],
    }  # fmt: skip
    return row, binary, program, bounds, lines


def observed(
    path: Path, manifest: Manifest, core_name: str, program: ProgramFlow, bounds: dict[ContextKey, FunctionBound],
    mode: str, inputs: int, seconds: float, binary: Binary, lines: LineTable,
) -> dict[str, Any]:  # fmt: skip
    """What executions show beside what the analysis says."""
    from emulator import EmulationError, Emulator
    from wcet.soundness.replay import Replay, record

    emulator = Emulator(path, "cortex-m4" if core_name == "cortex-m4f" else core_name)
    replay = Replay(program, [bounds])
    executed: set[int] = set()
    walked, runs, failed = 0, 0, ""
    started = time.process_time()
    for number in range(1 if mode == "initial" else inputs):
        if number and time.process_time() - started > seconds:
            break
        prepare(emulator, manifest, number)
        try:
            run = record(emulator, manifest.entry, [], MOST_INSTRUCTIONS)
        except EmulationError as error:
            failed = f"input {number}: {error}"
            continue
        runs += 1
        executed.update(run.addresses)
        if program.entry in program.functions:  # else the time was over before there was any graph
            walked = max(walked, *(replay.walk(run) or (0,)))
    done = {key for key, bound in bounds.items() if bound.cycles is not None}
    return {
        "runs": runs,
        "failed": failed,
        "walked": walked,
        "timed": timed(path, manifest, core_name, runs),
        "outside": outside(program, executed),
        "wrong": replay.wrong,
        "loops": loops(program, done, replay.seen, executed, lines) + unreached(binary, program, executed, lines),
    }


def prepare(emulator: Any, manifest: Manifest, number: int) -> None:
    """Memory as linked, and the inputs of a number in it; the first is the example in the source."""
    emulator.reset()
    random = Random(number)
    for one in manifest.inputs if number else ():
        symbol = emulator.by_name[one.name]
        emulator.write(symbol.address, content(one, emulator.read(symbol.address, symbol.size), random))


def timed(path: Path, manifest: Manifest, core_name: str, runs: int) -> int:
    """Cycles of the longest of a few executions on an ARM7TDMI as the second model counts them; 0 on others."""
    if core_name != "arm7tdmi" or not runs:
        return 0
    from emulator import EmulationError
    from wcet.reference import Tracer, bus_cycles

    from mauve.wcet.hardware.board import Board

    tracer, longest = Tracer(path, core_name), 0
    for number in range(min(TIMED, runs)):
        prepare(tracer.emulator, manifest, number)
        try:
            longest = max(longest, bus_cycles(tracer.run(manifest.entry, []), Board("ideal", core_name, 1)))
        except EmulationError:
            continue
    return longest


def outside(program: ProgramFlow, executed: set[int]) -> list[int]:
    """The first executed addresses that no block of any graph covers, where there are graphs."""
    if not program.functions:
        return []
    inside = {i.address for f in program.functions.values() for b in f.cfg.blocks for i in b.instructions}
    return sorted(executed - inside)[:100]


def loops(
    program: ProgramFlow,
    bounded: set[ContextKey],
    seen: dict[tuple[ContextKey, int], tuple[int, int]],
    executed: set[int],
    lines: LineTable,
) -> list[dict[str, Any]]:
    """Loops whose header was executed, contexts put together: no bound where one context that ran has none. `bounded`
    are the contexts that have a bound in cycles."""
    found: dict[tuple[str, int], dict[str, Any]] = {}
    counted = {(key[0], program.functions[key].nest.loops[number].header) for key, number in seen}
    for key, flow in program.functions.items():
        for number, loop in enumerate(flow.nest.loops):
            header = flow.cfg.blocks[loop.header].address
            count = seen.get((key, number), (0, 0))[0]
            if header not in executed or (not count and (key[0], loop.header) in counted):
                continue
            bound = flow.bounds.get(number)
            entry = found.setdefault(
                (flow.cfg.name, header),
                {"function": flow.cfg.name, "header": header, "source": lines.source(header), "bound": 0, "seen": 0,
                 "method": ""},
            )  # fmt: skip
            entry["seen"] = max(entry["seen"], count)
            if bound is None and program.entry in bounded:  # bounded all the same: this context never comes to it
                continue
            if bound is None or entry["bound"] is None:
                entry["bound"] = None
            elif bound.bound >= entry["bound"]:
                entry["bound"], entry["method"] = bound.bound, bound.method
    return list(found.values())


def unreached(binary: Binary, program: ProgramFlow, executed: set[int], lines: LineTable) -> list[dict[str, Any]]:
    """Executed loops of functions that the analysis did not reach: behind a call or branch whose target it missed."""
    from mauve.wcet.binary.callgraph import build_program
    from mauve.wcet.binary.loops import loop_nest

    known = {flow.cfg.address for flow in program.functions.values()}
    found = []
    for symbol in binary.functions:
        if symbol.address not in executed or symbol.address in known:
            continue
        cfg = build_program(binary, symbol.key)[symbol.key]
        for loop in loop_nest(cfg).loops:
            header = cfg.blocks[loop.header].address
            if header in executed and not any(one["header"] == header for one in found):
                found.append({"function": cfg.name, "header": header, "source": lines.source(header), "bound": None,
                              "seen": 0, "method": "not reached"})  # fmt: skip
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("image", type=Path)
    parser.add_argument("source", type=Path)
    parser.add_argument("--mode", choices=("inputs", "initial", "nofact"), default="inputs")
    parser.add_argument("--inputs", type=int, default=10)
    parser.add_argument("--timeout", type=float, default=60.0)
    parser.add_argument("--observe", type=float, default=10.0, help="processor seconds for further inputs")
    arguments = parser.parse_args()
    count_processor_time()
    image = name_of(arguments.image)
    row: dict[str, Any] = {"program": image.program, "compiler": image.compiler, "core": image.core}
    row |= {"mode": arguments.mode, "traceback": ""}
    try:
        manifest = read_manifest(arguments.source)
        core = CORES[image.core].board
        figures, *rest = analysed(arguments.image, manifest, core, arguments.mode, arguments.timeout)
        row |= figures
        binary, program, bounds, lines = rest
        row |= observed(arguments.image, manifest, core, program, bounds, arguments.mode, arguments.inputs,
                        arguments.observe, binary, lines)  # fmt: skip
    except Exception:
        row["traceback"] = traceback.format_exc()
    print(json.dumps(row))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
