"""Rebuilds mauve/wcet/flow/library/regular.toml: `python -m tests.wcet.flow.build_regular_table [RUNS]`.

The routines of newlib's libm whose multiplications and divisions get no subnormal operands, whatever they are called
with by the functions of libm that call them. The argument stands in PROOFS; then the functions run in unicorn with
special and random operands, and the operands of every call of a helper are looked at: a subnormal one at a call that
the table does not leave out stops the script.

The argument is one of granularity. A double is 0, or no number, or at least 2**-m for some m, and then a multiple of
2**-(m + 52). A sum of multiples of 2**-g is one, rounded as well, so 0 or at least 2**-g; a product of numbers that are
0 or at least 2**-m and 2**-n is 0 or at least 2**-(m + n), so is a quotient of one by one that is at most 2**n. It is
subnormal only below 2**-1022. In a polynomial the constant term of each step is larger than the rest, so
that nothing is lost by cancellation and the value of a step stays above half its constant.
"""

from __future__ import annotations

import random
import struct
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.elf import Binary, Symbol, load
from mauve.wcet.binary.graph import Cfg, EdgeKind
from mauve.wcet.binary.lines import load_lines
from mauve.wcet.binary.split import split_irreducible
from mauve.wcet.flow.library import FORMAT, fingerprint
from tests.emulator import EmulationError, Emulator
from tests.wcet.flow.build_library_table import LIBRARY, operands
from tests.wcet.flow.build_newlib_table import EDGES, MULTILIBS, nearest

PROOFS = {
    "reduction-loop": (
        "The words x[i] are integers below 2**24 (rem_pio2 cuts them off so), 2/pi as well. Products and sums of them "
        "and multiples of 2**-24 of them are 0 or at least 2**-30, before and after the scaling by 2**q0 with -27 <= "
        "q0 <= 2 (the exponent of an argument of 2**20 or more, less 24 for each word left out; scalbn is a function "
        "of its own). The words of the rest are integers times 2**(q0 - 24 * i), i <= 9: multiples of 2**-243; the "
        "words of pi/2 are at least 2**-168: their products and all sums of these are multiples of 2**-464."
    ),
    "reduction": (
        "An argument up to pi/4 is not multiplied. Up to 2**19 * pi/2 it is at least 2, and what it is multiplied with "
        "is 2/pi or, as an integer below 2**20, a part of pi/2 (at least 2**-120). Beyond, its 53 bits become integers "
        "times 2**0, 2**-24 and 2**-48."
    ),
    "kernel": (
        "Called by sin, cos and tan with what rem_pio2 leaves: the rest x and its tail y, a multiple of 2**-464 (or 0 "
        "where there was no reduction). No argument, nor twice one, comes nearer to a multiple of pi/2 than 2**-62 of "
        "it (`nearest`). Below 2**-27 (tan: 2**-28) x is returned, or 1 (tan: -1/(x + y) after a reduction, of x not "
        "below 2**-62; 1/x of a 0). From 0.67 on tan goes on with the distance to pi/4, not below 2**-63. So x**2 is "
        "at least 2**-126, x**3 2**-189, x**4 2**-252; the coefficients of the polynomials are at least 2**-37, and "
        "each step is a coefficient and a smaller rest. Products with y are multiples of 2**-(464 + 160), others and "
        "their differences of 2**-400."
    ),
    "exponential": (
        "Below 2**-32 the argument is not multiplied, but returned with 1. Else it is a number above 2**-32 or, after "
        "the reduction, a sum of multiples of 2**-85: at least 2**-85, its square 2**-170; the coefficients are at "
        "least 2**-25, each step of the polynomial is one and a smaller rest. It is divided by 2 less something small. "
        "The result is near 1; where it has to be scaled below 2**-1021, it is first scaled to 2**-75 and more, then "
        "multiplied by 2**-1000: no operand of this is subnormal, only its result, which is returned."
    ),
    "logarithm": (
        "A subnormal argument is multiplied by 2**54: this call is left out. Then it is within sqrt(2)/2 and sqrt(2), "
        "and less 1 a multiple of 2**-53; s = f / (2 + f) is 0 or at least 2**-55, its fourth power 2**-220; "
        "coefficients and the parts of ln 2 times an integer below 2**11 are at least 2**-34."
    ),
    "arc": (
        "Below 2**-29 and from 2**66 on the argument is not multiplied. It is reduced to a quotient of a multiple of "
        "2**-53 by at most 4, or of -1 by less than 2**66: at least 2**-66 or 0, or it is at least 2**-29 itself. Its "
        "square is at least 2**-132, the fourth power 2**-264, the coefficients 2**-7; each step of the two "
        "polynomials is one and a smaller rest, their sum at least a quarter of the square."
    ),
    "power": (
        "Left out are the calls for y = -1 and y = 2, the scaling of a subnormal x by 2**53, the products with y and "
        "all that follows from them, and the sign of the result. The others compute the logarithm of a number within "
        "1 and 2, or at most 2**-20 from 1 where y is huge: less 1, 1.5 or 1 it is a multiple of 2**-53, divided by at "
        "most 4; its parts and their rests, exact differences of products of these, are multiples of 2**-200, squares "
        "and fourth powers at least 2**-220, coefficients and parts of constants at least 2**-40. Infinities, zeros "
        "and (x - x) / (x - x) are no subnormal numbers."
    ),
}
ROUTINES = {
    "__kernel_rem_pio2": "reduction-loop",
    "__ieee754_rem_pio2": "reduction",
    "__kernel_sin": "kernel",
    "__kernel_cos": "kernel",
    "__kernel_tan": "kernel",
    "__ieee754_exp": "exponential",
    "__ieee754_log": "logarithm",
    "__ieee754_pow": "power",
    "atan": "arc",
}
CALLED = ("sin", "cos", "tan", "exp", "log", "atan")
HELPERS = ("__muldf3", "__divdf3", "__aeabi_dmul", "__aeabi_ddiv")
LEFT_OUT = {
    ("__ieee754_log", 110),
    *(("__ieee754_pow", line) for line in (160, 162, 215, 267, 268, *range(301, 308), 313)),
}
"""The lines of newlib 3.3 at which a subnormal number may be multiplied or divided."""


def build(folder: Path, flags: Sequence[str]) -> Path:
    """An executable that holds the functions."""
    source, image = folder / "program.c", folder / "program.elf"
    lines = ["#include <math.h>", "void _start(void) { }"]
    lines += [f'__attribute__((pcs("aapcs"))) double run_{name}(double x) {{ return {name}(x); }}' for name in CALLED]
    lines.append('__attribute__((pcs("aapcs"))) double run_pow(double x, double y) { return pow(x, y); }')
    lines.append(f"void *volatile all[] = {{ {', '.join(f'run_{name}' for name in (*CALLED, 'pow'))} }};")
    source.write_text("\n".join(lines) + "\n")
    words = ["arm-none-eabi-gcc", *flags, "-O2", "-w", "-fno-builtin", "-nostartfiles", str(source), "-lm", "-lc"]
    subprocess.run([*words, "-Wl,-Ttext=0x8000", "-Wl,--unresolved-symbols=ignore-all", "-o", str(image)], check=True)
    return image


def arguments(rng: random.Random, runs: int) -> Iterator[list[int]]:
    """Operands: special ones, those nearest to multiples of pi/2, random ones of all sizes."""
    for value in EDGES:
        for signed in (value, -value):
            yield list(struct.unpack("<2I", struct.pack("<d", signed)))
    for number, exponent, _ in nearest(53, range(-60, 971, 1 if runs > 1000 else 12)):
        for factor in (1, -3):
            if number * abs(factor) * 2**exponent < 2**1023:
                yield list(struct.unpack("<2I", struct.pack("<d", float(number * factor * 2**exponent))))
    for turn in range(runs):
        if turn % 2:
            yield operands(rng)[:2]
        else:
            yield list(struct.unpack("<2I", struct.pack("<d", rng.uniform(-800, 800) * 2.0 ** rng.randrange(-90, 12))))


def powers(rng: random.Random) -> Iterator[list[int]]:
    """Second operands of a power: special ones, and a random one that leads to a result within range."""
    for value in (rng.choice((-1.0, 2.0, 0.5, 2.0**33)), rng.uniform(-30, 30)):
        yield list(struct.unpack("<2I", struct.pack("<d", value)))


def is_subnormal(high: int, low: int) -> bool:
    """Whether two words are a subnormal double."""
    return high & 0x7FF00000 == 0 and (high & 0xFFFFF or low) != 0


def sites(cfg: Cfg, helpers: set[int]) -> frozenset[int]:
    """The addresses of the calls of helpers."""
    return frozenset(
        cfg.blocks[edge.source].instructions[-1].address
        for edge in cfg.edges
        if edge.kind is EdgeKind.CALL and helpers & {key & ~1 for key in edge.callees}
    )


def subnormal_at(emulator: Emulator, helpers: set[int], runs: int) -> tuple[set[int], set[int]]:
    """The calls (addresses behind them) that pass a subnormal operand to a helper, and all calls that were seen."""
    from unicorn import UC_HOOK_CODE
    from unicorn import arm_const as arm

    found: set[int] = set()
    seen: set[int] = set()
    registers = (arm.UC_ARM_REG_R0, arm.UC_ARM_REG_R1, arm.UC_ARM_REG_R2, arm.UC_ARM_REG_R3, arm.UC_ARM_REG_LR)

    def entered(uc: Any, _address: int, _size: int, _: object) -> None:
        first, second, third, fourth, back = (uc.reg_read(register) for register in registers)
        seen.add(back & ~1)
        if is_subnormal(second, first) or is_subnormal(fourth, third):
            found.add(back & ~1)

    core = emulator._uc
    hooks = [core.hook_add(UC_HOOK_CODE, entered, None, address, address) for address in helpers]
    rng = random.Random(runs)
    all_words = list(arguments(rng, runs))
    calls = [(name, words) for name in CALLED for words in all_words]
    calls += [("pow", [*words, *other]) for words in all_words for other in (rng.choice(all_words), *powers(rng))]
    for name, words in calls:
        try:
            emulator.call(f"run_{name}", words, max_instructions=200_000)
        except EmulationError:
            continue
    for hook in hooks:
        core.hook_del(hook)
    return found, seen


def survey(found: str, cpu: str, image: Path, table: dict[str, dict], runs: int) -> None:
    """Add the routines of one image."""
    binary, emulator = load(image), Emulator(image, cpu)
    assert isinstance(binary, Binary), binary
    lines = load_lines(binary)
    helpers = {symbol.address for name in HELPERS if isinstance(symbol := binary.function(name), Symbol)}
    bad, seen = subnormal_at(emulator, helpers, runs)
    for name, proof in ROUTINES.items():
        cfg = split_irreducible(build_cfg(binary, binary.function(name).key))
        calls = sites(cfg, helpers)
        left_out = {at for at in calls if _scales(name, lines.source(at))}
        wrong = {at for at in calls if at + 4 in bad} - left_out
        assert calls and not wrong, (found, name, [lines.source(at) for at in wrong])
        entry = table.setdefault(fingerprint(cfg), {"names": [], "found": [], "but": set(), "proof": proof})
        entry["names"] += [] if name in entry["names"] else [name]
        entry["found"] += [] if found in entry["found"] else [found]
        entry["but"] |= {at - cfg.address for at in left_out}
        reached = sum(at + 4 in seen for at in calls)
        print(f"{found}: {name}: {len(calls)} calls, {reached} seen, {len(left_out)} left out", flush=True)


def _scales(name: str, source: str) -> bool:
    return any(name == routine and source.endswith(f":{line}") for routine, line in LEFT_OUT)


def write(path: Path, table: dict[str, dict]) -> None:
    """The TOML file."""
    lines = ["# Written by tests/wcet/flow/build_regular_table.py; the proofs stand there, too.", f"format = {FORMAT}"]
    lines += ["", "[proofs]", *(f'{name} = "{text}"' for name, text in PROOFS.items())]
    for key, entry in sorted(table.items(), key=lambda item: (item[1]["names"], item[0])):
        quoted = {word: ", ".join(f'"{one}"' for one in entry[word]) for word in ("names", "found")}
        lines += ["", "[[routine]]", f'fingerprint = "{key}"', f"names = [{quoted['names']}]"]
        lines += [f"found = [{quoted['found']}]", f"but = {sorted(entry['but'])}", f'proof = "{entry["proof"]}"']
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(runs: int = 3000) -> None:
    """Rebuild the file."""
    table: dict[str, dict] = {}
    for name, cpu, flags in MULTILIBS:
        if name in ("thumb/v6-m/nofp", "thumb/nofp"):  # helpers without such loops; helpers behind veneers
            continue
        with tempfile.TemporaryDirectory() as folder:
            survey(f"newlib 3.3 {name}", cpu, build(Path(folder), flags), table, runs)
    write(LIBRARY / "regular.toml", table)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3000)
