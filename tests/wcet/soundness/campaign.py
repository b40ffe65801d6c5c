"""One seed through one compiler setting: compile, analyse, execute on many inputs, retrace, compare."""

from __future__ import annotations

import struct
import subprocess
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from random import Random

from emulator import Argument, EmulationError, Emulator
from wcet.reference import Tracer, bus_cycles, pipeline_cycles
from wcet.soundness.generate import WORDS, Function, Source, generate
from wcet.soundness.replay import Recording, Replay, record

from mauve.wcet.assemble import assemble
from mauve.wcet.binary.elf import Binary, ElfProblem, load
from mauve.wcet.flow.program import analyse_program
from mauve.wcet.flow.result import ProgramFlow
from mauve.wcet.hardware.board import Board, Memory
from mauve.wcet.hardware.core import load_core
from mauve.wcet.hardware.cost import board_problems
from mauve.wcet.ipet.bottom_up import bound_program

TIMED = 2
"""Executions of each function that are also timed by the second model of the hardware, where it knows the core."""
TARGETS = {
    "arm7tdmi-arm": ("arm7tdmi", "-mcpu=arm7tdmi -marm -mthumb-interwork"),
    "arm7tdmi-thumb": ("arm7tdmi", "-mcpu=arm7tdmi -mthumb -mthumb-interwork"),
    "arm926ej-s-arm": ("arm926ej-s", "-mcpu=arm926ej-s -marm"),
    "cortex-m0-thumb": ("cortex-m0", "-mcpu=cortex-m0 -mthumb"),
    "cortex-m3-thumb": ("cortex-m3", "-mcpu=cortex-m3 -mthumb"),
}
LEVELS = ("-O0", "-O1", "-O2", "-O3", "-Os")
FLAGS = (
    "-std=gnu11 -mfloat-abi=soft -fwrapv -fno-strict-aliasing -fno-common -w -nostdlib -nostartfiles"
    " -Wl,--build-id=none -Wl,-Ttext=0x8000 -Wl,-Tdata=0x40000 -Wl,-e,_start"
)
CORNERS = (
    0,
    1,
    2,
    7,
    8,
    31,
    32,
    33,
    127,
    128,
    255,
    256,
    32767,
    32768,
    65535,
    0x7FFF_FFFF,
    0x8000_0000,
    0xFFFF_FFFF,
    0xFFFF_FFF0,
)
GLOBALS = ("g_words", "g_limit", "g_record", "g_bytes", "g_small", "g_pair", "port")
DATA = 0x40000
MEMORIES = (
    Memory("flash", 0x8000, 0x38000, 1),
    Memory("ram", 0x40000, 0x10000, 2, 3),
    Memory("heap", 0x5000_0000, 0x4_0000, 5),
    Memory("stack", 0x6000_0000, 0x1_0000, 1, 0),
)
SECONDS = 200.0
"""What the analysis of one function may take before it counts as endless."""


@dataclass(slots=True)
class Outcome:
    """What one image showed. `loops` are (bound or None, greatest count seen) of loops that ran; `bounds` are (cycles
    or None, cycles of the longest execution retraced, seconds) of functions."""

    name: str
    wrong: list[str] = field(default_factory=list)
    loops: list[tuple[int | None, int, str]] = field(default_factory=list)
    bounds: list[tuple[int | None, int, float, str]] = field(default_factory=list)
    runs: int = 0
    problems: list[str] = field(default_factory=list)


def compile_seed(seed: int, target: str, level: str, out: Path, small: bool = False) -> Source:
    """Compile the program of a seed to `out`; `small`: one of many small functions."""
    source = generate(seed, 24, True) if small else generate(seed)
    flags = f"{TARGETS[target][1]} {level} {FLAGS}".split()
    command = ["arm-none-eabi-gcc", *flags, "-x", "c", "-", "-x", "none", "-lc", "-lgcc", "-o", str(out)]
    subprocess.run(command, input=source.text, text=True, check=True, capture_output=True)
    return source


def arguments(function: Function, emulator: Emulator, random: Random) -> list[Argument]:
    """Random and corner values; pointers to fresh memory, to each other's memory, or to a global."""
    made: list[Argument] = []
    shared = emulator.alloc(random.randbytes(8 * WORDS))
    for kind in function.parameters:
        if kind.endswith("p"):
            values = [random.choice(CORNERS) if random.random() < 0.5 else random.randrange(40) for _ in range(WORDS)]
            fresh = emulator.alloc(struct.pack(f"<{WORDS}I", *values))
            globals_ = [max(emulator.by_name[name].address - 4 * random.randrange(12), DATA) for name in GLOBALS]
            part = shared + 4 * random.randrange(WORDS)
            made.append(random.choice([fresh, fresh, shared, part, *globals_[:3], random.choice(globals_)]))
        else:
            value = random.choice([random.choice(CORNERS), random.randrange(64), random.getrandbits(32)])
            made.append(_cast(value, kind))
    return made


def _cast(value: int, kind: str) -> int:
    """A value as the calling convention passes it: extended to a word from its own width."""
    bits = int("".join(c for c in kind if c.isdigit()))
    value &= (1 << bits) - 1
    return value if kind.startswith("u") or not value >> (bits - 1) else value - (1 << bits)


def scramble(emulator: Emulator, random: Random) -> None:
    """Any values in the globals: the analysis must not assume what the image was linked with."""
    for name in GLOBALS:
        symbol = emulator.by_name[name]
        if random.random() < 0.7:
            words = [random.choice([random.choice(CORNERS), random.randrange(50)]) for _ in range(64)]
            emulator.write(symbol.address, struct.pack("<64I", *words)[: symbol.size])


def examine(elf: Path, functions: tuple[Function, ...], cpu: str, seed: int, inputs: int) -> Outcome:
    """Analyse every function of an image on two boards and compare with executions on random inputs."""
    outcome = Outcome(elf.stem)
    binary, core = load(elf), load_core(cpu)
    assert isinstance(binary, Binary) and core is not None
    boards = [Board("ideal", cpu, 1_000_000), Board("slow", cpu, 1_000_000, MEMORIES)]
    emulator = Emulator(elf, cpu)
    for function in functions:
        symbol = binary.function(function.name)
        assert not isinstance(symbol, ElfProblem)
        started = time.process_time()
        program = analyse_program(binary, symbol.key, boards[0], timeout=SECONDS)
        bounds = [bound_program(program, core, board) for board in boards]
        results = [
            assemble(function.name, program, found, core, board, board_problems(board, core), lambda _: "")
            for found, board in zip(bounds, boards, strict=True)
        ]
        seconds = time.process_time() - started
        replay, longest = Replay(program, bounds), [0, 0]
        random = Random(seed)
        for _ in range(inputs):
            run = _execute(emulator, function, random, replay)
            cycles = replay.walk(run) if run is not None else None
            outcome.runs += run is not None
            longest = [max(a, b) for a, b in zip(longest, cycles or (0, 0), strict=True)]
        timed = _timed(elf, function, cpu, seed, boards) if cpu in ("arm7tdmi", "arm926ej-s") else [0, 0]
        for result, walked, second, board in zip(results, longest, timed, boards, strict=True):
            if result.cycles is not None and max(walked, second) > result.cycles:
                replay.wrong.append(f"{board.name}: {walked} or {second} cycles, bound {result.cycles}")
        outcome.wrong += [f"{elf.stem} {function.name}: {line}" for line in replay.wrong]
        outcome.bounds.append((results[0].cycles, longest[0], seconds, function.name))
        outcome.problems += [
            f"{elf.stem} {function.name}: {p.kind.value} {p.message} in {p.function}" for p in results[0].problems
        ]
        outcome.loops += _loops(elf.stem, program, replay)
    return outcome


def _execute(emulator: Emulator, function: Function, random: Random, replay: Replay) -> Recording | None:
    emulator.reset()
    scramble(emulator, random)
    try:
        return record(emulator, function.name, arguments(function, emulator, random))
    except EmulationError as error:
        if "no return" not in str(error):
            replay.wrong.append(f"emulation: {error}")
        return None


def _timed(elf: Path, function: Function, cpu: str, seed: int, boards: list[Board]) -> list[int]:
    """The longest of a few executions on each board, as the second model times them."""
    tracer, random, core = Tracer(elf, cpu), Random(seed), load_core(cpu)
    assert core is not None
    longest = [0] * len(boards)
    for _ in range(TIMED):
        tracer.emulator.reset()
        scramble(tracer.emulator, random)
        try:
            trace = tracer.run(function.name, arguments(function, tracer.emulator, random))
        except EmulationError:
            continue
        for index, board in enumerate(boards):
            cycles = bus_cycles(trace, board) if cpu == "arm7tdmi" else pipeline_cycles(trace, core, board)
            longest[index] = max(longest[index], cycles)
    return longest


def _loops(image: str, program: ProgramFlow, replay: Replay) -> list[tuple[int | None, int, str]]:
    found = []
    for (name, number), (per_entry, _) in replay.seen.items():
        flow = program.functions[name]
        bound = flow.bounds.get(number)
        at = flow.cfg.blocks[flow.nest.loops[number].header].address
        found.append((None if bound is None else bound.bound, per_entry, f"{image} {flow.cfg.name} {at:#x}"))
    return found


def run_seed(seed: int, target: str, level: str, inputs: int, small: bool = False) -> Outcome:
    """Everything for one seed, in a temporary folder."""
    with tempfile.TemporaryDirectory() as folder:
        elf = Path(folder) / f"{seed}{level}-{target}.elf"
        source = compile_seed(seed, target, level, elf, small)
        return examine(elf, source.functions, TARGETS[target][0], seed, inputs)
