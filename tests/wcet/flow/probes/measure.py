"""Bounds of the probe programs, compared with executions: `python tests/wcet/flow/probes/measure.py`.

Each function of the C files beside this one holds a loop of some class. For every compiler setting the loops without a
bound are listed, those whose bound is far above the greatest count that random inputs reach, and every contradiction.

    --target m3 --level O2 --only gcd --every        which builds, which functions, every loop
"""

from __future__ import annotations

import argparse
import random
import re
import struct
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE.parents[2]), str(HERE.parents[3])]

TARGETS = {
    "arm7": ("arm7tdmi", "-mcpu=arm7tdmi -marm -mthumb-interwork", "arm7tdmi", "-marm"),
    "m0": ("cortex-m0", "-mcpu=cortex-m0 -mthumb", "cortex_m0", "-mthumb"),
    "m3": ("cortex-m3", "-mcpu=cortex-m3 -mthumb", "cortex_m3", "-mthumb"),
    "m4f": ("cortex-m4f", "-mcpu=cortex-m4 -mthumb -mfloat-abi=hard -mfpu=fpv4-sp-d16", "cortex_m4", "-mthumb"),
}
LEVELS = ("O0", "O1", "O2", "O3", "Os", "clang")
COMMON = "-std=gnu11 -fno-common -w -g0"
LINK = "-nostartfiles -Wl,--build-id=none -Wl,-Ttext=0x8000 -Wl,-Tdata=0x40000 -Wl,-e,0 -specs=nosys.specs"
WORDS = 1024


def build(source: Path, target: str, level: str, out: Path) -> None:
    """Compile and link one probe file."""
    _, flags, cpu, state = TARGETS[target]
    if level != "clang":
        command = f"arm-none-eabi-gcc {flags} -{level} {COMMON} {LINK} {source} -lc -lgcc -o {out}"
        subprocess.run(command.split(), check=True, capture_output=True)
        return
    code = out.with_suffix(".o")
    include = subprocess.run(["arm-none-eabi-gcc", "-print-sysroot"], text=True, capture_output=True).stdout.strip()
    triple = f"{'arm' if state == '-marm' else 'thumb'}-freestanding-{'eabihf' if 'hard' in flags else 'eabi'}"
    headers = f"-isystem {include or '/usr/lib/arm-none-eabi'}/include"
    command = (
        f"{sys.executable} -m ziglang cc -target {triple} -mcpu={cpu} -O2 {COMMON} -fno-sanitize=undefined {headers}"
        f" -c {source} -o {code}"
    )
    subprocess.run(command.split(), check=True, capture_output=True)
    command = f"arm-none-eabi-gcc {flags} {LINK} -Wl,--no-warn-mismatch {code} -lc -lgcc -o {out}"
    subprocess.run(command.split(), check=True, capture_output=True)


def functions(source: Path) -> dict[str, list[str]]:
    """The probes of a file with the types of their parameters."""
    found = {}
    for name, parameters in re.findall(r"^P [\w ]+?\*?(\w+)\((.*?)\) \{", source.read_text(), re.M):
        parts = [] if parameters == "void" else re.split(r",(?![^()]*\))", parameters)
        found[name] = [p.strip() for p in parts]
    return found


def argument(parameter: str, emulator, rng: random.Random):
    """A value for a parameter, as the calling convention passes it."""
    from emulator import Int64, f32

    if "*" in parameter or "[" in parameter:
        small = rng.random() < 0.5
        return emulator.alloc(struct.pack(f"<{WORDS}I", *(_word(rng, small) for _ in range(WORDS))))
    if parameter.startswith("step "):
        return None
    kind = parameter.split()[0]
    if kind == "float":
        return f32(rng.random() * 100)
    bits = int("".join(c for c in kind if c.isdigit()))
    few = rng.getrandbits(rng.randint(1, bits))
    value = rng.choice([rng.getrandbits(bits), few, (1 << bits) - 1, 0, 1 << bits - 1])
    value &= (1 << bits) - 1
    if bits == 64:
        return Int64(value)
    return value if kind[0] == "u" or not value >> (bits - 1) else value - (1 << bits)


def _word(rng: random.Random, small: bool) -> int:
    return rng.choice([0, 1, 2, 0x01010101, rng.getrandbits(8), rng.getrandbits(3)]) if small else rng.getrandbits(32)


def examine(elf: Path, cpu: str, probes: dict[str, list[str]], runs: int, only: str) -> Iterator[tuple]:
    """Per loop: (function, where, bound, total, observed, observed total, method), then per function its seconds."""
    from emulator import EmulationError, Emulator
    from wcet.soundness.replay import Replay, record

    from mauve.wcet.binary.elf import load
    from mauve.wcet.flow.program import analyse_program

    binary = load(elf)
    for name, parameters in probes.items():
        if only and not re.search(only, name):
            continue
        symbol = binary.function(name)
        started = time.process_time()
        program = analyse_program(binary, symbol.key, None, timeout=60)
        seconds = time.process_time() - started
        replay, emulator, rng = Replay(program, ()), Emulator(elf, cpu), random.Random(name)
        for _ in range(runs):
            emulator.reset()
            arguments = [argument(p, emulator, rng) for p in parameters]
            if any(a is None for a in arguments):
                break
            try:
                execution = record(emulator, name, arguments)
            except EmulationError as error:
                if "instructions" not in str(error):
                    yield "error", name, str(error)
                continue
            replay.walk(execution)
        for wrong in dict.fromkeys(replay.wrong):
            yield "wrong", name, wrong
        for key, flow in program.functions.items():
            for index, loop in enumerate(flow.nest.loops):
                bound = flow.bounds.get(index)
                seen = replay.seen.get((key, index), (0, 0))
                where = f"{flow.cfg.name}@{flow.cfg.blocks[loop.header].address:#x}"
                where += f"[{key[1]}]" if key[1] else ""
                found = (bound.bound, bound.total, bound.method) if bound else (None, None, "")
                yield "loop", name, where, found[0], found[1], *seen, found[2]
        holes = [h for flow in program.functions.values() for h in flow.cfg.unresolved]
        for problem in program.problems:
            yield "problem", name, problem.message
        for hole in holes:
            yield "hole", name, f"{hole.kind} {hole.address:#x}"
        for flow in program.functions.values():
            for problem in flow.problems:
                if problem.kind.name != "LOOP":
                    yield "problem", name, problem.message
        if seconds > 3:
            yield "slow", name, f"{seconds:.1f} s"


def main() -> None:
    """See the module's description."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--target", action="append", choices=list(TARGETS))
    parser.add_argument("--level", action="append", choices=LEVELS)
    parser.add_argument("--file", default="")
    parser.add_argument("--only", default="")
    parser.add_argument("--runs", type=int, default=6)
    parser.add_argument("--every", action="store_true")
    parser.add_argument("--loose", type=float, default=0)
    chosen = parser.parse_args()
    tally = [0, 0]
    with tempfile.TemporaryDirectory() as place:
        for source in sorted(HERE.glob(f"{chosen.file or '*'}.c")):
            for target in chosen.target or TARGETS:
                for level in chosen.level or LEVELS:
                    elf = Path(place) / f"{source.stem}-{target}-{level}.elf"
                    build(source, target, level, elf)
                    found = examine(elf, TARGETS[target][0], functions(source), chosen.runs, chosen.only)
                    for kind, name, *rest in found:
                        _show(f"{target:5s}{level:6s}{name}", kind, rest, chosen, tally)
    print(f"{tally[0]} of {tally[1]} loops bounded")


def _show(label: str, kind: str, rest: list, chosen: argparse.Namespace, tally: list[int]) -> None:
    if kind != "loop":
        print(f"{label}: {kind.upper()} {' '.join(rest)}", flush=True)
        return
    where, bound, total, seen, seen_total, method = rest
    tally[1] += 1
    tally[0] += bound is not None
    loose = chosen.loose and bound and seen and bound > chosen.loose * seen + 1
    if bound is None or chosen.every or loose:
        mark = "NONE " if bound is None else ""
        print(f"{label}: {mark}{where} bound {bound} total {total} seen {seen} {seen_total} {method}", flush=True)
    if bound is not None and seen > bound:
        print(f"{label}: UNSOUND {where} {bound} < {seen}", flush=True)


if __name__ == "__main__":
    main()
