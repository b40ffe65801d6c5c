"""Rebuilds mauve/wcet/flow/library/newlib.toml: `python -m tests.wcet.flow.build_newlib_table [RUNS]`.

Links the routines of newlib's libc and libm for several multilibs, and gives every loop of theirs that no ranking
argument bounds what a rule below says, which a person has proven; then each routine runs in unicorn: an observed count
above the bound stops the script. A loop without a rule is reported and left out.
"""

from __future__ import annotations

import random
import re
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path

from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.graph import Cfg, EdgeKind
from mauve.wcet.binary.lines import load_lines
from mauve.wcet.binary.loops import Loop, LoopNest, loop_nest
from mauve.wcet.binary.microop import Condition, Imm, Instruction, Load, SetFlags, Store
from mauve.wcet.binary.split import split_irreducible
from mauve.wcet.flow.library import fingerprint
from mauve.wcet.flow.ranking import Ranking
from tests.emulator import EmulationError, Emulator
from tests.wcet.flow.build_library_table import LIBRARY, operands, write

PROOFS = {
    "bytes": (
        "A pass of this loop takes `step` bytes further on of the n that the argument says, each byte in one pass only"
        " and none behind the n-th: n / step passes at most, and once more the header when the loop's condition fails."
    ),
    "rest": (
        "Wherever the memory lies, bytes are taken 16 (4) at a time before, until fewer are left: 3 passes that take 4 "
        "bytes (1 byte) each, 4 where the byte that is looked for is one of the next 4; before that, 3 passes reach an "
        "aligned address; and once more the header when the loop's condition fails."
    ),
    "root-denormal": (
        "Only an operand with exponent 0 whose fraction is not 0 comes here: shifted left by one place (or by 21 "
        "places while the high word is 0, at most twice) until its leading bit is in place, at most 20 times for the "
        "high word of a double, 23 times for a single; and once more the header when the condition fails."
    ),
    "remainder-steps": (
        "One pass for each place that the dividend's exponent is above the divisor's: from -1074 to 1023 for doubles, "
        "-149 to 127 for singles, and once more the header when the counter is 0."
    ),
    "remainder-normal": (
        "The other loops shift a fraction that is not 0 left by one place until its leading bit is in place, at most "
        "52 (23) places, or count the zeros above a leading bit in at most 32 places; and once more the header."
    ),
    "reduction-words": (
        "An operand is cut into 3 words, of which the first holds its leading bit; from the last one down words that "
        "are 0 are left out: 2 passes, and the header for the word that is not 0."
    ),
    "reduction-terms": (
        "rem_pio2 passes 3 words at most (jx <= 2) and prec 2, so that jk = jp = 4 (9 for singles). jz starts at jk and"
        " grows by as many words as are 0 behind the point, then by one word at most. No operand comes nearer to a "
        "multiple of pi/2 than 2**-62 (2**-31) of it, as the continued fractions of 2**e / pi show for each exponent e,"
        " so 3 (5) words of 24 (8) bits can be 0: jz is 4, then at most 7, then at most 8 (9, 14, 15) in the 3 rounds, "
        "and 9 (16) behind them, where a word more may be broken off. The passes of each loop of the source are a "
        "number of these; `total` is their sum over the rounds and over the loop around."
    ),
    "reduction-again": (
        "The quotient is computed again when its words that were added are all 0. After the first time they hold its "
        "leading bit, unless a carry moved that down by one place, into the word that is added next: 3 times at most."
    ),
}


@dataclass(frozen=True)
class Memory:
    """A routine that takes `size` bytes as its argument of number `argument` (from 0) says; at one loop pass it
    takes bytes from `streams` places."""

    name: str
    argument: int = 2
    streams: int = 1
    rests: tuple[tuple[int, int], ...] = ()
    """loops that take so many bytes at a time only get what others have left: at most so many executions"""


MEMORY = (
    Memory("memcpy", rests=((4, 4),)),
    Memory("memmove", rests=((4, 4),)),
    Memory("memset", rests=((4, 4), (1, 4))),
    Memory("memcmp", streams=2),
    Memory("memchr", rests=((1, 5),)),
    Memory("strncmp", streams=2),
    Memory("strncpy"),
    Memory("strnlen", argument=1),
)
FLOAT = {
    "__ieee754_sqrt": "sqrt",
    "__ieee754_sqrtf": "sqrtf",
    "__ieee754_fmod": "fmod",
    "__ieee754_fmodf": "fmodf",
    "__ieee754_rem_pio2": "sin",
    "__kernel_rem_pio2": "sin",
    "__kernel_rem_pio2f": "sinf",
}
"""Internal routines of libm and the function through which they are run."""
WHOLE = {"__kernel_rem_pio2", "__kernel_rem_pio2f"}
"""All loops of these are in the table: ranking arguments would take long and bound few."""


def reduction(jk: int, zeros: int) -> dict[str, tuple[int, int, int]]:
    """The loops of __kernel_rem_pio2, by the role of each: passes per entry at most, passes in one call at most,
    entries in one call at most; as the proof `reduction-terms` has it."""
    rounds = (jk, jk + zeros, jk + zeros + 1)
    last = rounds[-1] + 1
    beyond = sum(jz - jk for jz in rounds)
    sums = sum(min(jk + 1, terms) for terms in range(1, last + 2))
    return {
        "words": (jk + 3, jk + 3, 1),
        "first": (jk + 1, jk + 1, 1),
        "first-inner": (3, 3 * (jk + 1), jk + 1),
        "round": (rounds[-1], sum(rounds), 3),
        "nonzero": (zeros + 1, beyond, 3),
        "count": (zeros, zeros + 1, 2),
        "more": (zeros, zeros + 1, 2),
        "more-inner": (3, 3 * (zeros + 1), zeros + 1),
        "drop": (zeros + 1, zeros + 1, 1),
        "result": (last + 1, last + 1, 1),
        "sum": (last + 1, last + 1, last + 1),
        "sum-inner": (jk + 1, sums, last + 1),
    }


LINES = {
    "__kernel_rem_pio2": (
        {186: "words", 189: "first", 190: "first-inner", 197: "round", 219: "round", 244: "nonzero", 246: "count",
         248: "more", 250: "more-inner", 261: "drop", 274: "result", 279: "sum", 280: "sum-inner", 288: "result",
         294: "result", 297: "result", 301: "result", 306: "result", 311: "result"},
        reduction(4, 3),
    ),
    "__kernel_rem_pio2f": (
        {76: "words", 79: "first", 80: "first-inner", 87: "round", 109: "round", 134: "nonzero", 136: "count",
         138: "more", 140: "more-inner", 151: "drop", 164: "result", 169: "sum", 170: "sum-inner", 178: "result",
         184: "result", 187: "result", 191: "result", 196: "result", 201: "result"},
        reduction(9, 5),
    ),
}  # fmt: skip
"""The source line of each loop's head in newlib 3.3, and what the loop is there."""

MULTILIBS = (
    (".", "arm926", ("-mcpu=arm7tdmi", "-marm")),
    ("thumb/nofp", "arm926", ("-mcpu=arm7tdmi", "-mthumb")),
    ("thumb/v6-m/nofp", "cortex-m0", ("-mcpu=cortex-m0", "-mthumb")),
    ("thumb/v7-m/nofp", "cortex-m3", ("-mcpu=cortex-m3", "-mthumb")),
    ("thumb/v7e-m/nofp", "cortex-m4", ("-mcpu=cortex-m4", "-mthumb")),
    ("thumb/v7e-m+fp/hard", "cortex-m4", ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard")),
    ("thumb/v7e-m+fp/softfp", "cortex-m4", ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=softfp")),
)


@dataclass(frozen=True)
class Said:
    """What the table says of a loop: its bound in one call (a number or a formula), the name of the proof, and the
    bound per entry where that is less (0: it is the same)."""

    bound: str
    proof: str
    each: int = 0


Lines = Callable[[int], str]
"""The source line of an address."""


def build(folder: Path, flags: Sequence[str]) -> Path:
    """An executable that holds all routines."""
    source, image = folder / "program.c", folder / "program.elf"
    names = ", ".join(routine.name for routine in MEMORY)
    lines = [f"#include <math.h>\n#include <string.h>\nvoid *volatile all[] = {{ {names} }};\nvoid _start(void) {{ }}"]
    for name in sorted(set(FLOAT.values())):
        kind, pair = ("float" if name.endswith("f") else "double"), "fmod" in name
        takes, gives = (f"{kind} x, {kind} y", "x, y") if pair else (f"{kind} x", "x")
        lines.append(f'__attribute__((pcs("aapcs"))) {kind} run_{name}({takes}) {{ return {name}({gives}); }}')
    source.write_text("\n".join(lines) + "\n")
    words = ["arm-none-eabi-gcc", *flags, "-O2", "-w", "-fno-builtin", "-nostartfiles", str(source), "-lm", "-lc"]
    subprocess.run([*words, "-Wl,-Ttext=0x8000", "-Wl,--unresolved-symbols=ignore-all", "-o", str(image)], check=True)
    return image


# -------------------------------------------------------------------------------------------------------- what is said
def taken(cfg: Cfg, loop: Loop, streams: int) -> int:
    """The bytes that a full pass takes at least: what its loads read, in a loop without loads what its stores write."""
    after: dict[int, list[int]] = {}
    for index, edge in enumerate(cfg.edges):
        if edge.source in loop.blocks and edge.target in loop.blocks:
            after.setdefault(edge.source, []).append(-1 if index in loop.back_edges else edge.target)

    def least(block: int, kind: type[Load] | type[Store]) -> int:
        mine = sum(
            op.size
            for instruction in cfg.blocks[block].instructions
            if instruction.condition is Condition.AL or goes_on_with(cfg, loop, block, instruction)
            for op in instruction.ops
            if isinstance(op, kind) and not isinstance(op.address, Imm)
        )
        return mine + min((0 if then < 0 else least(then, kind) for then in after.get(block, [])), default=1 << 20)

    loads = least(loop.header, Load)
    return loads // streams if loads else least(loop.header, Store)


def goes_on_with(cfg: Cfg, loop: Loop, block: int, instruction: Instruction) -> bool:
    """Whether the loop goes on behind a block only where the condition of one of its instructions held: the block ends
    with a branch under the same condition (or its opposite, out of the loop), and no flag changes in between."""
    after = [one for one in cfg.blocks[block].instructions if one.address > instruction.address]
    if not after or any(isinstance(op, SetFlags) for one in (instruction, *after) for op in one.ops):
        return False
    ways = {edge.kind is EdgeKind.TAKEN for edge in cfg.edges if edge.source == block and edge.target in loop.blocks}
    last = after[-1].condition
    needed = {frozenset({True}): last, frozenset({False}): last.negated}.get(frozenset(ways))
    return needed is instruction.condition


def said_of_memory(routine: Memory) -> Callable[[Cfg, LoopNest, Loop, int], Said]:
    """The rule for a routine that goes through memory."""

    def say(cfg: Cfg, nest: LoopNest, loop: Loop, _: int) -> Said:
        steps = {other.id: taken(cfg, other, routine.streams) for other in nest.loops}
        step = steps[loop.id]
        assert step in (1, 4, 8, 16, 64), (cfg.name, steps)
        rest = dict(routine.rests).get(step)
        if rest is not None and 4 * step in steps.values():
            return Said(str(rest), "rest")
        return Said(f"r{routine.argument} / {step} + 1", "bytes")

    return say


def said_of_float(name: str, lines: Lines) -> Callable[[Cfg, LoopNest, Loop, int], Said]:
    """The rule for a routine of libm; loops of fmod are told apart by what is observed, those of the argument
    reduction by their source lines."""
    single = name.endswith("f")

    def say(cfg: Cfg, nest: LoopNest, loop: Loop, observed: int) -> Said:
        if "sqrt" in name:
            return Said("24" if single else "21", "root-denormal")
        if "fmod" in name:
            if observed > 60:
                return Said("277" if single else "2098", "remainder-steps")
            return Said("53", "remainder-normal")
        if name == "__ieee754_rem_pio2":
            return Said("3", "reduction-words")
        largest = max(nest.loops, key=lambda other: len(other.blocks))
        if loop.id == largest.id:
            return Said("3", "reduction-again")
        return of_reduction(name, lines, cfg, loop)

    return say


def of_reduction(name: str, lines: Lines, cfg: Cfg, loop: Loop) -> Said:
    """A loop of __kernel_rem_pio2, by the first of its source lines that heads a loop. A loop that is left at the end
    of its passes only has an execution of the header per pass, any other one more."""
    roles, passes = LINES[name]
    places = {
        lines(instruction.address).rpartition(":")[2]
        for block in loop.blocks
        for instruction in cfg.blocks[block].instructions
    }
    role = next(role for line, role in sorted(roles.items()) if str(line) in places)
    each, total, entries = passes[role]
    latches = {cfg.edges[index].source for index in loop.back_edges}
    leaving = {edge.source for edge in cfg.edges if edge.source in loop.blocks and edge.target not in loop.blocks}
    more = 0 if leaving <= latches and len(latches) == 1 else 1
    return Said(str(total + more * entries), "reduction-terms", each + more)


# ---------------------------------------------------------------------------------------------------------- execution
Call = tuple[str, list[int], dict[str, int]]
"""A function, its arguments, and what formulas read of them."""


def memory_calls(routine: Memory, emulator: Emulator, rng: random.Random, runs: int) -> Iterator[Call]:
    """Calls with all alignments and all small sizes; equal and unequal contents."""
    first, second = emulator.alloc(bytes(1024)), emulator.alloc(bytes(1024))
    for number in range(runs):
        size = number % 150 if number % 4 else rng.randrange(0, 700)
        filler = rng.choice((0, 1, 7, 255))
        for place in (first, second):
            emulator.write(place, bytes([filler]) * 1000 + b"\0" * 24)
        if rng.random() < 0.5:
            emulator.write(first + rng.randrange(900), bytes([rng.choice((0, 9))]))
        places = [first + rng.randrange(8), rng.choice((first, second)) + rng.randrange(8)]
        if routine.name in ("memset", "memchr"):
            places[1] = rng.choice((9, filler, 77))
        yield routine.name, [places[0], *([size] if routine.argument == 1 else [places[1], size])], {"size": size}


def two_over_pi(bits: int) -> Fraction:
    """2/pi to about so many bits, by Machin's formula pi = 16 arctan(1/5) - 4 arctan(1/239)."""

    def arctan(inverse: int) -> int:
        power = (1 << bits + 32) // inverse
        total, number = power, 1
        while power:
            power //= inverse * inverse
            number += 2
            total += -(power // number) if number % 4 == 3 else power // number
        return total

    return Fraction(2 << bits + 32, 16 * arctan(5) - 4 * arctan(239))


def nearest(bits: int, exponents: range) -> Iterator[tuple[int, int, Fraction]]:
    """For each exponent e an integer q below 2**bits for which q * 2**e is nearest to a multiple of pi/2, e, and how
    near it is as a part of pi/2: the last convergents of 2**e * 2/pi, which approximate best."""
    quarter = two_over_pi(1400)
    for exponent in exponents:
        target = rest = quarter * Fraction(2) ** exponent
        old, new, last = (0, 1), (1, 0), (0, 1)
        while True:
            whole = rest.numerator // rest.denominator
            old, new = new, (old[0] + whole * new[0], old[1] + whole * new[1])
            if new[1] >= 1 << bits:
                break
            last = new
            rest = 1 / (rest - whole)
        yield last[1], exponent, abs(last[1] * target - last[0])


EDGES = (
    *(0.0, 5e-324, 2.0**-1073, 3 * 2.0**-1074, 2.0**-1054, 2.0**-1053, 2.0**-1043, 2.0**-1042, 2.0**-1023),
    *(2.0**-1022 - 2.0**-1074, 2.0**-1022, 2.0**-1021, 1e-300, 0.5, 1.0, 1.5, 3.0, 7.0, 1e16, 2.0**1023, 1.5e308),
    *(float.fromhex("0x1.fffffffffffffp+1023"), float("inf"), float("nan")),
    *(2.0**-149, 3 * 2.0**-149, 2.0**-141, 2.0**-133, 2.0**-126 - 2.0**-149, 2.0**-126, 2.0**-125, 2.0**127),
    float.fromhex("0x1.fffffep+127"),
)
"""Zero, the ends of the denormal and the normal numbers and what lies about them, infinity, no number."""
SINGLES = {
    value for value in EDGES if value != value or value == 0 or value in (0.5, 1.0, 1.5, 3.0, 7.0, float("inf"))
} | {value for value in EDGES if 2.0**-150 < value < 2.0**128 and (value * 2.0**149).is_integer()}
"""Those that a single can hold or is rounded to."""


def float_calls(name: str, rng: random.Random, runs: int) -> Iterator[Call]:
    """Calls with special and random operands; for sine and cosine those nearest to multiples of pi/2."""
    through, single = f"run_{FLOAT[name]}", name.endswith("f")
    if "rem_pio2" in name:
        bits, exponents = (24, range(-30, 104)) if single else (53, range(-60, 971, 1 if runs > 1000 else 16))
        for number, exponent, near in nearest(bits, exponents):
            assert near > Fraction(1, 1 << (31 if single else 62)), (exponent, near)
            kind, word = ("<f", "<1I") if single else ("<d", "<2I")
            for factor in (1, 3, -5):
                try:
                    packed = struct.pack(kind, float(number * factor * 2**exponent))
                except OverflowError:
                    continue
                yield through, list(struct.unpack(word, packed)), {}
    edges = [word for value in EDGES for word in (value, -value)]
    kind, word = ("<f", "<1I") if single else ("<d", "<2I")
    packed = [struct.unpack(word, struct.pack(kind, value)) for value in edges if not single or value in SINGLES]
    packed += [((0x7F800001,) if single else (1, 0x7FF00000)), ((1,) if single else (1, 0))]
    for first in packed:
        for second in packed[::3] if "fmod" in name else packed[:1]:
            yield through, [*first, *second], {}
    for _ in range(runs):
        words = operands(rng)
        yield through, words, {}


def observed(emulator: Emulator, calls: Iterator[Call], headers: Sequence[int]) -> list[tuple[dict[int, int], int]]:
    """The executions of each header in each call, with the size that was asked for."""
    found = []
    for function, arguments, known in calls:
        try:
            run = emulator.call(function, arguments, max_instructions=400_000)
        except EmulationError:
            continue
        found.append(({header: run.counts.get(header, 0) for header in headers}, known.get("size", 0)))
    return found


# -------------------------------------------------------------------------------------------------------------- table
def tabulate(found: str, cfg: Cfg, say: Callable[..., Said], calls: Iterator[Call], emulator: Emulator,
             table: dict[str, dict]) -> None:  # fmt: skip
    """Add the loops of one routine that need the table, after a comparison with what was observed."""
    nest = loop_nest(cfg)
    assert not nest.irreducible, cfg.name
    ranking = Ranking(cfg, nest)
    loops = [loop for loop in nest.loops if cfg.name in WHOLE or ranking.bound(loop) is None]
    headers = {loop.id: cfg.blocks[loop.header].address for loop in loops}
    if not loops:
        return
    runs = observed(emulator, calls, sorted(set(headers.values())))
    assert runs, (found, cfg.name)
    entry = table.setdefault(fingerprint(cfg), {"names": [], "found": [], "loops": {}})
    entry["names"] += [] if cfg.name in entry["names"] else [cfg.name]
    entry["found"] += [] if found in entry["found"] else [found]
    shown = []
    for loop in loops:
        header = headers[loop.id]
        most = max(counts[header] for counts, _ in runs)
        said = say(cfg, nest, loop, most)
        bound = said.bound
        step, more = map(int, re.fullmatch(r"(?:r\d / (\d+) \+ )?(\d+)", bound).groups("0"))  # type: ignore[union-attr]
        entry["loops"][header - cfg.address] = (bound if step else more, said.proof, said.each)
        shown.append(f"{header - cfg.address:#x}: {bound} (seen {most})")
        inner = loop.parent is not None and not said.each
        for counts, size in runs:
            limit = size // step + more if step else more
            assert inner or counts[header] <= limit, (found, cfg.name, hex(header), bound, counts[header], size)
    print(f"{found}: {cfg.name}: {', '.join(shown)}", flush=True)


def survey(found: str, cpu: str, image: Path, table: dict[str, dict], runs: int) -> None:
    """Add the routines of one image."""
    binary, emulator = load(image), Emulator(image, cpu)
    assert isinstance(binary, Binary), binary
    lines = load_lines(binary)

    def graph(name: str) -> Cfg | None:
        symbol = binary.function(name)
        return split_irreducible(build_cfg(binary, symbol.key)) if hasattr(symbol, "key") else None

    for routine in MEMORY:
        cfg = graph(routine.name)
        assert cfg is not None, routine.name
        calls = memory_calls(routine, emulator, random.Random(routine.name), runs)
        tabulate(found, cfg, said_of_memory(routine), calls, emulator, table)
    for name in FLOAT:
        cfg = graph(name)
        if cfg is not None:
            calls = float_calls(name, random.Random(name), runs // 2)
            tabulate(found, cfg, said_of_float(name, lines.source), calls, emulator, table)


def main(runs: int = 3000) -> None:
    """Rebuild the file."""
    table: dict[str, dict] = {}
    for name, cpu, flags in MULTILIBS:
        with tempfile.TemporaryDirectory() as folder:
            survey(f"newlib 3.3 {name}", cpu, build(Path(folder), flags), table, runs)
        write(LIBRARY / "newlib.toml", table, PROOFS, "build_newlib_table.py")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3000)
