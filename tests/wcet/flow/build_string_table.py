"""Rebuilds mauve/wcet/flow/library/strings.toml: `python -m tests.wcet.flow.build_string_table [RUNS]`.

The loops of newlib's routines that go on to the end of a string, with their bounds as formulas of its length: s0 (s1)
is the greatest length of the string that argument 1 (2) points to, its 0 included. Where the first difference of two
strings ends a loop, or either end, the shorter string is enough. The argument stands in PROOFS; then each routine runs
in unicorn at all alignments with many lengths: an observed count above its bound stops the script.
"""

from __future__ import annotations

import random
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.elf import Binary, Symbol, load
from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import Loop, loop_nest
from mauve.wcet.binary.microop import Load
from mauve.wcet.binary.split import split_irreducible
from mauve.wcet.flow.library import STRING, fingerprint, read_formula
from mauve.wcet.flow.ranking import Ranking
from tests.emulator import Emulator
from tests.wcet.flow.build_library_table import LIBRARY, write
from tests.wcet.flow.build_newlib_table import MULTILIBS, taken

PROOFS = {
    "string": (
        "Each full pass takes `step` bytes further on, from at most 7 bytes (3 where a pass takes 4, none where it "
        "takes 1) before where the string begins, and looks for its 0 in them or, where it reads ahead, one pass "
        "later: only two passes come after the last that takes nothing but bytes before the 0. With s bytes, the 0 "
        "included, that is (s - 1 + 7) / step + 2 <= s / step + 3 passes (with 3 and none likewise). A routine that "
        "compares two "
        "strings ends at the first difference, so at the end of the shorter one at the latest."
    ),
    "rest": (
        "Wherever the string lies, bytes are taken one at a time up to an aligned address only, at most 7, or where a "
        "word that was taken whole holds the 0, the character or the difference: at most 8 more and once more the "
        "header. Such loops are told from those that take all bytes by how often they run in strings of 600."
    ),
    "word": "The word that holds the 0 is written byte by byte, from its first byte to the 0.",
    "number": (
        "Each pass takes one character further on, and a 0 is neither a space nor a digit: as many passes as the "
        "string has characters, and once more the header where the condition stands there."
    ),
}


@dataclass(frozen=True)
class Routine:
    """A routine, what ends its loops (`s0 or s1`: either string), and of how many strings a pass takes bytes. `step`:
    the bytes that a pass takes where it reads tables as well. Internal routines run `through` another one."""

    name: str
    strings: tuple[int, ...]
    streams: int = 1
    step: int = 0
    through: str = ""


LEAST = 9
"""Executions of a loop that takes what others leave."""

NUMBERS = ("_strtol_l", "_strtoul_l", "_strtoll_l", "_strtoull_l")
ROUTINES = (
    Routine("strlen", (0,)),
    Routine("strcmp", (0, 1), 2),
    Routine("strcpy", (1,)),
    Routine("strcat", (0,)),
    Routine("strchr", (0,)),
    *(
        Routine(f"{name}.{kind}.0", (1,), step=1, through=name[1:].removesuffix("_l"))
        for name in NUMBERS
        for kind in ("part", "constprop")
    ),
)


def build(folder: Path, flags: Sequence[str]) -> Path:
    """An executable that holds all routines."""
    source, image = folder / "program.c", folder / "program.elf"
    names = dict.fromkeys(routine.through or routine.name for routine in ROUTINES)
    headers = "#include <string.h>\n#include <stdlib.h>\n"
    source.write_text(f"{headers}void *volatile all[] = {{ {', '.join(names)} }};\nvoid _start(void) {{ }}\n")
    words = ["arm-none-eabi-gcc", *flags, "-O2", "-w", "-fno-builtin", "-nostartfiles", str(source), "-lc"]
    subprocess.run([*words, "-Wl,-Ttext=0x8000", "-Wl,--unresolved-symbols=ignore-all", "-o", str(image)], check=True)
    return image


def said(routine: Routine, cfg: Cfg, loop: Loop, observed: int) -> tuple[str, str]:
    """The bound of a loop, and the name of the proof."""
    if routine.step:
        return " or ".join(f"s{n} + 1" for n in routine.strings), "number"
    if not any(isinstance(op, Load) for b in loop.blocks for i in cfg.blocks[b].instructions for op in i.ops):
        return "4", "word"
    step = taken(cfg, loop, routine.streams)
    assert step in (1, 2, 4, 8, 16, 32, 64), (cfg.name, hex(cfg.blocks[loop.header].address - cfg.address), step)
    if step == 1 and observed <= LEAST:
        return str(5 if observed <= 5 else LEAST), "rest"
    return " or ".join(f"s{n} / {step} + 3" for n in routine.strings), "string"


# ---------------------------------------------------------------------------------------------------------- execution
Call = tuple[list[int], dict[int, int]]
"""Arguments, and the lengths of strings that formulas read."""


def text(rng: random.Random, size: int, number: bool) -> bytes:
    """`size` characters."""
    if not number:
        return bytes([rng.choice((1, 97, 128, 255))]) * size
    spaces = rng.choice((0, 0, size // 2, size))
    return (b" " * spaces + rng.choice((b"", b"-", b"0x")) + bytes(rng.choice(b"0179") for _ in range(size)))[:size]


def calls(routine: Routine, emulator: Emulator, rng: random.Random, runs: int) -> Iterator[Call]:
    """Calls with all alignments and all small lengths; equal and unequal contents."""
    number = bool(routine.through)
    first, second = emulator.alloc(bytes(2048)), emulator.alloc(bytes(1024))
    for turn in range(runs):
        sizes = [turn % 130 if turn % 8 else rng.randrange(600), rng.choice((turn % 130, rng.randrange(600)))]
        content = text(rng, 600, number)
        places = [first + turn % 8, second + rng.choice((turn % 8, rng.randrange(8)))]
        for place, size in zip(places, sizes, strict=True):
            emulator.write(place, content[:size] + b"\0" + b"z" * 16)
        if rng.random() < 0.2:
            emulator.write(places[1] + rng.randrange(sizes[1] + 1), b"z")
            sizes[1] = emulator.read(places[1], 700).index(0) if 0 in emulator.read(places[1], 700) else 699
        lengths = {STRING + n: size + 1 for n, size in enumerate(sizes)}
        if number:
            yield [places[0], 0, rng.choice((0, 10, 16))], {STRING + 1: sizes[0] + 1}
        elif routine.name == "strchr":
            yield [places[0], rng.choice((0, 7, content[0]))], lengths
        else:
            yield places, lengths


def tabulate(found: str, routine: Routine, cfg: Cfg, emulator: Emulator, table: dict[str, dict], runs: int) -> None:
    """Add the loops of one routine that need the table, after a comparison with what is executed."""
    nest = loop_nest(cfg)
    assert not nest.irreducible and not cfg.unresolved, cfg.name
    ranking = Ranking(cfg, nest)
    loops = [loop for loop in nest.loops if ranking.bound(loop) is None]
    runs_of = [
        (emulator.call(routine.through or routine.name, arguments, max_instructions=100_000).counts, lengths)
        for arguments, lengths in calls(routine, emulator, random.Random(routine.name), runs)
    ]
    where = {}
    for loop in loops:
        header = cfg.blocks[loop.header].address
        where[header] = said(routine, cfg, loop, max(counts.get(header, 0) for counts, _ in runs_of))
    seen = dict.fromkeys(where, 0.0)
    for counts, lengths in runs_of:
        for header, (bound, _) in where.items():
            most = read_formula(bound).most(lengths.__getitem__)
            count = counts.get(header, 0)
            assert most is not None and count <= most, (found, cfg.name, hex(header), bound, count, lengths)
            seen[header] = max(seen[header], count / most)
    entry = table.setdefault(fingerprint(cfg), {"names": [], "found": [], "loops": {}})
    entry["names"] += [] if cfg.name in entry["names"] else [cfg.name]
    entry["found"] += [] if found in entry["found"] else [found]
    entry["loops"] |= {header - cfg.address: bound for header, bound in where.items()}
    shown = (f"{header - cfg.address:#x}: {where[header][0]} ({ratio:.2f})" for header, ratio in seen.items())
    print(f"{found}: {cfg.name}: {', '.join(shown)}", flush=True)


def survey(found: str, cpu: str, image: Path, table: dict[str, dict], runs: int) -> None:
    """Add the routines of one image."""
    binary, emulator = load(image), Emulator(image, cpu)
    assert isinstance(binary, Binary), binary
    for routine in ROUTINES:
        symbol = binary.function(routine.name)
        if isinstance(symbol, Symbol):
            cfg = split_irreducible(build_cfg(binary, symbol.key))
            tabulate(found, routine, cfg, emulator, table, runs)


def main(runs: int = 1200) -> None:
    """Rebuild the file."""
    table: dict[str, dict] = {}
    for name, cpu, flags in MULTILIBS:
        with tempfile.TemporaryDirectory() as folder:
            survey(f"newlib 3.3 {name}", cpu, build(Path(folder), flags), table, runs)
    write(LIBRARY / "strings.toml", table, PROOFS, "build_string_table.py")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 1200)
