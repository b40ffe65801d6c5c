"""Rebuilds mauve/wcet/flow/library/sorting.toml: `python -m tests.wcet.flow.build_sorting_table [RUNS]`.

The loops of newlib's qsort with their bounds as formulas of the number of elements n (r1) and their size (r2), for any
answers of the function that compares, even answers that contradict each other. The argument stands in PROOFS; then
qsort runs in unicorn against an adversary that makes it quadratic, on random and on special data: an observed count
above its bound stops the script.
"""

from __future__ import annotations

import random
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

from mauve.wcet.binary.callgraph import build_program
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.lines import load_lines
from mauve.wcet.binary.loops import Loop, LoopNest, loop_nest
from mauve.wcet.binary.split import split_irreducible
from mauve.wcet.flow.library import fingerprint, read_formula
from tests.emulator import Emulator
from tests.wcet.flow.build_library_table import LIBRARY
from tests.wcet.flow.build_newlib_table import MULTILIBS, taken

MOST = 1791
PROOFS = {
    "phases": (
        "A phase takes a segment of m elements. Below 7 it sorts by insertion; else it parts the segment by a pivot, "
        "with answers that do not contradict each other into parts of l + r <= m - 1 elements, with any answers into "
        "l + r <= m and l, r <= m - 1, or sorts it by insertion; a part of one element is no phase. By induction there "
        "are at most n - 4 phases for n >= 7, one below. The smaller part (at most m / 2) goes on one level up, the "
        "larger one waits on the level of its segment, so a segment on level k has at most n / 2**k elements; a call "
        "of itself needs one of 7 on level 8: none below 1792 elements."
    ),
    "partition": (
        "Each execution of the header but one (the last) in a phase compares the element at one end with the pivot and "
        "moves this end on by an element, and the ends do not pass each other by more than one: m + 1 at most in a "
        "phase of m >= 7. Phases of n, n - 1, ..., 7 elements have the greatest sum, as m * (m + 1) / 2 grows faster "
        "than its parts together: n * (n + 1) / 2 - 21, and n - 6 for the phases; none below 7."
    ),
    "insertion": (
        "A segment that is sorted by insertion is not parted: such segments have at most n elements in all. Each "
        "element goes past each one before it at most once: m * (m - 1) / 2 passes, at most 5 / 2 for an element of a "
        "segment below 7; once more the header for each element."
    ),
    "exchange": (
        "An element (of r2 bytes) is exchanged with another by bytes or by words of 4: r2 (r2 / 4) passes, one at "
        "least. Where elements are moved back to the middle after a partition, it is half of the segment at most: "
        "m * r2 / 2 bytes, over all phases half the sum of their sizes, and one more pass for each phase."
    ),
}
EXCHANGES = {"r2 / 1 + 1": 1, "r1 * r2 / 2 + r2 + 1": 1, "r2 / 4 + 1": 4}
"""How a loop exchanges elements, by its passes: SWAPINIT of qsort.c takes words where address and size are multiples of
the size of a word, else bytes; an element of one word is exchanged without a loop."""
PHASES, SUM, ALL = "r1 + -3", "r1 * r1 / 2 + 3 * r1 / 2 + -26", "r1 * r1 / 2 + r1 / 2 + 2"


def said(cfg: Cfg, nest: LoopNest, loop: Loop, lines: Callable[[int], str]) -> tuple[str, str, str]:
    """(bound in one call, bound per entry, proof) of a loop by the source lines in it (those of newlib 3.3's
    qsort.c: 196 to 345 the phases, 228 and 238 the two ends, 198 and 256 insertion, below 150 exchanges)."""
    places = {
        int(lines(instruction.address).rpartition(":")[2] or 0)
        for block in loop.blocks
        for instruction in cfg.blocks[block].instructions
    }
    inner = not any(other.parent == loop.id for other in nest.loops)
    if max(places) < 150:
        assert inner and loop.parent is not None
        step = taken(cfg, loop, 2)
        assert step in (1, 4), step
        around = nest.loops[loop.parent]
        phase = _is_phase(cfg, around, lines)
        each = f"r2 / {step} + 1"
        if not phase:
            return f"r1 * r1 * r2 / {step} + r1 * r1 + r2 + 1", each, "exchange"
        return f"r1 * r1 * r2 / {4 * step} + 2 * r1 * r2 + 3 * r1 + 2", f"r1 * r2 / {2 * step} + r2 + 1", "exchange"
    if _is_phase(cfg, loop, lines):
        return PHASES, PHASES, "phases"
    if {228, 238} & places:
        assert not {198, 256} & places
        return SUM, "r1 + 2", "partition"
    small = not {256, 257} & places
    assert {198, 199, 256, 257} & places, places
    if any(other.parent == loop.id and not _is_exchange(cfg, other, lines) for other in nest.loops):
        return "2 * r1 + 1", "7" if small else "r1 + 1", "insertion"
    return ("4 * r1 + 1", "7", "insertion") if small else (ALL, "r1 + 1", "insertion")


def _lines(cfg: Cfg, loop: Loop, lines: Callable[[int], str]) -> set[int]:
    texts = {lines(i.address).rpartition(":")[2] for block in loop.blocks for i in cfg.blocks[block].instructions}
    return {int(text) for text in texts if text}


def _is_exchange(cfg: Cfg, loop: Loop, lines: Callable[[int], str]) -> bool:
    return max(_lines(cfg, loop, lines)) < 150


def _is_phase(cfg: Cfg, loop: Loop, lines: Callable[[int], str]) -> bool:
    """Whether a loop goes through the choice of a pivot and the partition."""
    return {206, 228, 268} <= _lines(cfg, loop, lines)


# ---------------------------------------------------------------------------------------------------------- execution
PROGRAM = """
#include <stdlib.h>
#include <stdint.h>
int32_t value[4096], seen, solid, candidate, mode;
static uint32_t state = 1;
static uint32_t next(void) { return state = state * 1664525u + 1013904223u; }
/* what an element stands for: its first byte, or two, or four */
static int32_t of(const void *p, int32_t size)
{
    const uint8_t *b = p;
    return size >= 2 ? b[0] | b[1] << 8 : b[0];
}
int32_t size;
int compare(const void *a, const void *b)
{
    int32_t x = of(a, size), y = of(b, size);
    if (mode == 1) return (int)(next() >> 30) - 1;        /* answers that contradict each other */
    if (mode == 2) return 1;
    if (mode == 3) return -1;
    if (mode == 4) {                                      /* an adversary that decides as late as it can */
        if (value[x] < 0 && value[y] < 0) value[x == candidate ? x : y] = solid++;
        if (value[x] < 0) candidate = x;
        else if (value[y] < 0) candidate = y;
        int32_t vx = value[x] < 0 ? 1 << 30 : value[x], vy = value[y] < 0 ? 1 << 30 : value[y];
        return (vx > vy) - (vx < vy);
    }
    if (mode == 5) return next() >> 31 ? 1 : 0;
    if (mode == 6) return next() >> 28 ? -1 : 1;
    return (x > y) - (x < y);
}
void run(void *data, uint32_t count, uint32_t bytes, int32_t how)
{
    size = (int32_t)bytes; mode = how; solid = 0; candidate = 0;
    for (int i = 0; i < 4096; i++) value[i] = -1;
    qsort(data, count, bytes, compare);
}
void _start(void) { run(value, 3, 4, 0); }
"""


def build(folder: Path, flags: Sequence[str]) -> Path:
    """An executable that sorts."""
    source, image = folder / "program.c", folder / "program.elf"
    source.write_text(PROGRAM)
    words = [
        "arm-none-eabi-gcc",
        *flags,
        "-O1",
        "-w",
        "-nostartfiles",
        str(source),
        "-Wl,-Ttext=0x8000",
        "-o",
        str(image),
    ]
    subprocess.run(words, check=True)
    return image


def calls(rng: random.Random, runs: int) -> Iterator[tuple[bytes, int, int, int]]:
    """(memory, number, size, kind of answers)."""
    for number in range(runs):
        size = rng.choice((1, 2, 4, 4, 8, 12, 3, 5))
        count = number % 60 if number % 3 else rng.choice((7, 8, 40, 41, 100, 200))
        mode = rng.choice((0, 0, 1, 2, 3, 4, 4, 5, 6))
        order = list(range(count))
        match rng.randrange(4):
            case 0:
                rng.shuffle(order)
            case 1:
                order.reverse()
            case 2:
                order = [rng.choice((1, 2, 3)) for _ in order] if mode != 4 else order
        yield b"".join((x & 0xFFFF).to_bytes(4, "little").ljust(size, b"\0")[:size] for x in order), count, size, mode


def survey(found: str, cpu: str, image: Path, table: dict[str, dict], runs: int) -> None:
    """Add the qsort of one image."""
    binary, emulator = load(image), Emulator(image, cpu)
    assert isinstance(binary, Binary), binary
    key, lines = binary.function("qsort").key, load_lines(binary).source
    cfg = split_irreducible(build_program(binary, key)[key])
    nest = loop_nest(cfg)
    assert not nest.irreducible
    where = {cfg.blocks[loop.header].address: said(cfg, nest, loop, lines) for loop in nest.loops}
    seen = dict.fromkeys(where, 0.0)
    rng = random.Random(found)
    place = emulator.alloc(bytes(8192))
    for memory, count, size, mode in calls(rng, runs):
        start = place + rng.choice((0, 0, 1, 2))
        emulator.write(start, memory)
        run = emulator.call("run", [start, count, size, mode], max_instructions=3_000_000)
        for header, (total, _, _) in where.items():
            most = read_formula(total).most({1: count, 2: size}.__getitem__)
            assert most is not None and run.counts.get(header, 0) <= most, (
                found,
                hex(header),
                total,
                count,
                size,
                mode,
            )
            unit = EXCHANGES.get(where[header][1], 0)
            words = start % 4 == 0 and size % 4 == 0
            if (unit == 1 and words) or (unit == 4 and words and size == 4):
                assert not run.counts.get(header, 0), (found, hex(header), unit, start, size)
            seen[header] = max(seen[header], run.counts.get(header, 0) / most)
    print(found, " ".join(f"{header - cfg.address:#x}:{ratio:.2f}" for header, ratio in seen.items()), flush=True)
    entry = table.setdefault(fingerprint(cfg), {"found": [], "loops": where, "start": cfg.address, "stack": frame(cfg)})
    entry["found"].append(found)


def frame(cfg: Cfg) -> int:
    """Bytes of the stack frame: what the first block pushes and what it takes off the stack pointer."""
    total = 0
    for instruction in cfg.blocks[cfg.entry].instructions:
        if pushed := re.fullmatch(r"(?:push|stmdb sp!,|stmdb\.w sp!,)(?:\.w)? \{(.*)\}", instruction.text):
            total += 4 * len(pushed[1].split(","))
        if less := re.fullmatch(r"sub(?:\.w)? sp, (?:sp, )?#(\w+)", instruction.text):
            total += int(less[1], 0)
    assert total >= 100, total
    return total


def write(path: Path, table: dict[str, dict]) -> None:
    """The TOML file."""
    lines = ["# Written by tests/wcet/flow/build_sorting_table.py; the proofs stand there, too.", "format = 1", ""]
    lines += ["[proofs]", *(f'{name} = "{text}"' for name, text in PROOFS.items())]
    for key, entry in sorted(table.items(), key=lambda item: item[1]["found"]):
        quoted = ", ".join(f'"{found}"' for found in entry["found"])
        lines += ["", "[[function]]", f'fingerprint = "{key}"', 'names = ["qsort"]', f"found = [{quoted}]"]
        lines += ["sorts = true", f"most = {MOST}", f"stack = {entry['stack']}", "loops = ["]
        for header, (total, each, proof) in sorted(entry["loops"].items()):
            offset = header - entry["start"]
            more = f", exchanges = {EXCHANGES[each]}" if each in EXCHANGES else ""
            lines.append(f'  {{ offset = {offset}, bound = "{total}", each = "{each}", proof = "{proof}"{more} }},')
        lines.append("]")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(runs: int = 1500) -> None:
    """Rebuild the file."""
    table: dict[str, dict] = {}
    for name, cpu, flags in MULTILIBS:
        if name != "thumb/nofp":  # calls through pointers go through a veneer there
            with tempfile.TemporaryDirectory() as folder:
                survey(f"newlib 3.3 {name}", cpu, build(Path(folder), flags), table, runs)
    write(LIBRARY / "sorting.toml", table)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1500)
