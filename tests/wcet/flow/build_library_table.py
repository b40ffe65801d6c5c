"""Rebuilds mauve/wcet/flow/library/*.toml: `python -m tests.wcet.flow.build_library_table [RUNS [FILE]]`
(with both compilers).

Links every run-time helper of libgcc (several multilibs) and of compiler-rt, lists the loops of those that arithmetic
needs, keeps the ones that no ranking argument bounds, gives each the bound of a rule below, which a person has proven,
and runs the helper in unicorn with adversarial and random operands: an observed count above the bound stops the script.
A loop without a rule is reported and left out.
"""

from __future__ import annotations

import random
import re
import struct
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from mauve.wcet.binary import callgraph
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import LoopNest, loop_nest
from mauve.wcet.binary.split import split_irreducible
from mauve.wcet.flow.library import FORMAT, fingerprint
from mauve.wcet.flow.ranking import bound_by_ranking
from tests.emulator import EmulationError, Emulator

LIBRARY = Path(__file__).resolve().parents[3] / "mauve" / "wcet" / "flow" / "library"

SOFT = "adddf3|subdf3|muldf3|divdf3|addsf3|subsf3|mulsf3|divsf3|aeabi_[df](add|sub|rsub|mul|div)"
INTEGER = "u?divsi3|u?modsi3|aeabi_u?idiv(mod)?|u?divdi3|u?moddi3|u?divmoddi4|aeabi_u?ldivmod|mul[sd]i3|powi[sd]f2"
CONVERT = "(fix|fixuns)[sd]f[sd]i|(float|floatun)[sd]i[sd]f|extendsfdf2|truncdfsf2|c[lt]z[sd]i2|popcount[sd]i2"
HELPER = re.compile(rf"__({SOFT}|{INTEGER}|{CONVERT}|aeabi_[a-z]+2[a-z]+|u?divmodsi4)")

PROOFS = {
    "remainder-order": (
        "The counter starts at most at 31, the places by which a nonzero divisor was shifted left without losing "
        "a bit; each pass subtracts 4 and needs a result >= 0: 7 passes, 8 executions."
    ),
    "double-quotient": (
        "The mask starts at bit 19 and falls by 4 places: 5 executions until it is 0. Then, if bit 20 of the high"
        " word is clear, the low word, which has bit 20 set from the start, moves there and the mask restarts "
        "once at bit 31: 8 executions more until it is 0. Bit 20 is set now, so it does not restart again: 13."
    ),
    "single-denormal": (
        "For an operand with exponent 0 the fraction is not 0 (zeros are sorted out before) and below bit 23; "
        "each pass doubles it until bit 23 is set, at most 23 executions. For others the condition fails at the "
        "first execution."
    ),
    "double-denormal": (
        "Called when an exponent is 0 or 2047. Past the tests for zeros and for 2047 every operand with exponent 0 has "
        "a fraction that is not 0 and below bit 52, and only such an operand is normalised; each pass doubles its 64 "
        "bits until bit 52 is set, at most 52 executions."
    ),
    "wide-quotient": (
        "The counter is the distance between the leading ones of divisor and dividend, at most 63, 64 for a "
        "divisor of 0; it falls by one with each pass until 0."
    ),
    "divisor-shift": (
        "A divisor of 0 or a power of two does not come here: it shares no bit with itself less one. Each pass needs a "
        "divisor below 2**28 and shifts it left by 4 places without losing a bit: 7 passes, 8 executions. The loop "
        "behind it goes on with 2**28 or more and shifts by one place below 2**31: fewer."
    ),
    "power-bits": ("Each pass consumes at least one of the 32 bits of the exponent."),
    "digit-correction": (
        "Knuth's algorithm D with digits of 16 bits: the divisor is shifted so that its upper digit is at least "
        "2**15; each correction adds it to the remainder, and the loop ends when that reaches 2**16, after two "
        "corrections at the latest; the second of them does not come back to the header."
    ),
    "quotient-bits": (
        "The counter is the distance between the leading ones of divisor and dividend, and one more: at most 31, as "
        "the distance 31 is answered at once. The bits beyond a multiple of the `step` by which it falls are taken "
        "off before the loop or done behind it; it falls to 0, and the loop is not entered with 0: 31 / step passes, "
        "each with one execution of the header, as the condition stands at their end."
    ),
    "thumb-digits": (
        "A word starts with at most 16 ones on top (24 in the loop of signed division) and zeros below. A pass "
        "shifts it left by 8 (6) places, the first one by 4 when the loop is entered in its middle, and the loop "
        "goes on while the last bit shifted out is a one: not after the third (fifth) pass, which shifts out a "
        "zero."
    ),
}


@dataclass(frozen=True)
class Rule:
    helper: str
    total: int
    proof: str
    compiler_rt: bool = False
    local: bool = False
    """for a subroutine inside the helper, reached by bl"""
    unrolled: bool = False
    """a pass does as many of the `total` steps as it takes off the loop's counter"""


RULES = (
    Rule(r"__u?modsi3", 8, "remainder-order"),
    Rule(r"__(divdf3|aeabi_ddiv)", 13, "double-quotient"),
    Rule(r"__(muldf3|divdf3|aeabi_dmul|aeabi_ddiv)", 52, "double-denormal", local=True),
    Rule(r"__(mulsf3|aeabi_fmul|divsf3|aeabi_fdiv)", 23, "single-denormal"),
    Rule(r"__(u?divdi3|u?moddi3|u?divmoddi4)", 64, "wide-quotient"),
    Rule(r"__divsi3", 8, "divisor-shift", local=True),
    Rule(r"__powi[sd]f2", 32, "power-bits"),
    Rule(r"__(udivsi3|aeabi_uidiv)", 3, "thumb-digits"),
    Rule(r"__(divsi3|aeabi_idiv)", 5, "thumb-digits"),
    Rule(r"__udivmoddi4", 2, "digit-correction", compiler_rt=True),
    Rule(r"__(udivmodsi4|umodsi3|aeabi_uidiv)", 31, "quotient-bits", compiler_rt=True, unrolled=True),
)

GCC = (
    ("libgcc 12.2 .", "arm926", ("-mcpu=arm926ej-s", "-marm")),
    ("libgcc 12.2 thumb/nofp", "arm926", ("-mcpu=arm7tdmi", "-mthumb")),
    ("libgcc 12.2 thumb/v6-m/nofp", "cortex-m0", ("-mcpu=cortex-m0", "-mthumb")),
    ("libgcc 12.2 thumb/v7-m/nofp", "cortex-m3", ("-mcpu=cortex-m3", "-mthumb")),
    ("libgcc 12.2 thumb/v7e-m/nofp", "cortex-m4", ("-mcpu=cortex-m4", "-mthumb")),
)
ZIG = tuple(
    (f"compiler-rt (zig 0.17.1) {state}{core}", cpu, ("-target", target, f"-mcpu={core}"))
    for state, core, cpu, target in (
        ("", "arm7tdmi", "arm926", "arm-freestanding-eabi"),
        ("", "arm926ej_s", "arm926", "arm-freestanding-eabi"),
        ("thumb ", "arm7tdmi", "arm926", "thumb-freestanding-eabi"),
        ("thumb ", "arm926ej_s", "arm926", "thumb-freestanding-eabi"),
        ("thumb ", "cortex_m0", "cortex-m0", "thumb-freestanding-eabi"),
        ("thumb ", "cortex_m0plus", "cortex-m0", "thumb-freestanding-eabi"),
        ("thumb ", "cortex_m3", "cortex-m3", "thumb-freestanding-eabi"),
        ("thumb ", "cortex_m4", "cortex-m4", "thumb-freestanding-eabi"),
        ("thumb hard-float ", "cortex_m4", "cortex-m4", "thumb-freestanding-eabihf"),
    )
)
ZIG_NAMES = (
    "__aeabi_uidiv __aeabi_idiv __aeabi_uidivmod __aeabi_idivmod __umodsi3 __modsi3 __udivmodsi4"
    " __divmodsi4 __aeabi_uldivmod __aeabi_ldivmod __udivdi3 __divdi3 __umoddi3 __moddi3 __udivmoddi4 __divmoddi4"
    " __aeabi_dadd __aeabi_dsub __aeabi_drsub __aeabi_dmul __aeabi_ddiv __aeabi_fadd __aeabi_fsub __aeabi_frsub"
    " __aeabi_fmul __aeabi_fdiv __aeabi_d2iz __aeabi_d2uiz __aeabi_d2lz __aeabi_d2ulz __aeabi_f2iz __aeabi_f2uiz"
    " __aeabi_f2lz __aeabi_f2ulz __aeabi_i2d __aeabi_ui2d __aeabi_l2d __aeabi_ul2d __aeabi_i2f __aeabi_ui2f"
    " __aeabi_l2f __aeabi_ul2f __aeabi_d2f __aeabi_f2d __aeabi_lmul __aeabi_llsl __aeabi_llsr __aeabi_lasr"
    " __powidf2 __powisf2 __clzsi2 __clzdi2 __ctzsi2 __ctzdi2 __popcountsi2 __popcountdi2"
)
"""What clang's code calls of compiler-rt; a processor's own instructions make some of it unused, all of it exists."""
ZIG_PROGRAM = (
    "".join(f"void {name}(void);\n" for name in ZIG_NAMES.split())
    + f"void (*volatile all[])(void) = {{ {', '.join(ZIG_NAMES.split())} }};\nvoid _start(void) {{ all[0](); }}\n"
)
PROGRAM = """
volatile unsigned u; volatile unsigned long long w; volatile float f; volatile double d;
void integer(void) { u = u / u + u % u; w = w / w + w % w; }
void _start(void) { integer(); f = f * f / f + f; d = d * d / d + d; u = d; d = w; f = w; w = f; }
"""


def build(folder: Path) -> list[tuple[str, str, Path]]:
    """Link the helpers; (where found, emulator CPU, image)."""
    source = folder / "program.c"
    source.write_text(PROGRAM)
    images = []
    for number, (found, cpu, flags) in enumerate(GCC):
        image = folder / f"gcc{number}.elf"
        name = ["arm-none-eabi-gcc", *flags, "-print-libgcc-file-name"]
        archive = subprocess.run(name, check=True, capture_output=True, text=True).stdout.strip()
        link = ["-Wl,--whole-archive", archive, "-Wl,--no-whole-archive", "-lc", "-Wl,--unresolved-symbols=ignore-all"]
        options = ["-O2", "-nostdlib", "-Wl,--allow-multiple-definition", "-Wl,-Ttext=0x8000", "-Wl,-z,muldefs"]
        command = ["arm-none-eabi-gcc", *flags, *options, source, *link, "-o", image]
        subprocess.run(command, check=True, capture_output=True)
        images.append((found, cpu, image))
    for number, (found, cpu, flags) in enumerate(ZIG):
        image = folder / f"zig{number}.elf"
        source.write_text(ZIG_PROGRAM)
        words = [sys.executable, "-m", "ziglang", "cc", *flags, "-O2", "-g0", "-w", "-fno-builtin", source, "-o", image]
        subprocess.run(words, check=True)
        images.append((found, cpu, image))
    return images


# --------------------------------------------------------------------------------------------------------- execution
SPECIAL = (
    *(0, 1, 2, 3, 7, 255, 0x7FFFFF, 0x800000, 0x7FFFFFFF, 0x80000000, 0x80000001, 0xFFFFFFFF, 0x7F800000),
    *(0x3F800000, 0x000FFFFF, 0x00100000, 0x7FF00000, 0x3FF00000, 0x55555555, 0xFFFF0000, 0x0000FFFF),
)


def operands(rng: random.Random) -> list[int]:
    """Four words: special patterns, random ones of random length, denormals, pairs."""

    def word() -> int:
        kind = rng.random()
        if kind < 0.35:
            return rng.choice(SPECIAL)
        if kind < 0.7:
            return rng.getrandbits(rng.randint(1, 32))
        if kind < 0.85:
            return 1 << rng.randrange(32)
        return struct.unpack("<I", struct.pack("<f", rng.uniform(-4, 4)))[0]

    return [word() for _ in range(4)]


def observe(emulator: Emulator, function: int, headers: list[int], runs: int) -> dict[int, int]:
    """The greatest number of executions of each header in one call."""
    rng = random.Random(function)
    result = emulator.alloc(bytes(16))
    most = dict.fromkeys(headers, 0)
    for number in range(runs):
        words = operands(rng)
        if number % 2:
            words[2] = result  # for what stores a second result there
        if number % 4 > 1:
            words[:2] = [rng.getrandbits(32) >> rng.randrange(32) for _ in range(2)]
        try:
            run = emulator.call(function, [*words, result], max_instructions=100_000)
        except EmulationError:
            continue
        for header in headers:
            most[header] = max(most[header], run.counts.get(header, 0))
    return most


# -------------------------------------------------------------------------------------------------------------- table
def survey(found: str, cpu: str, image: Path, table: dict[str, dict], runs: int) -> None:
    """Add the loops of one image that need the table."""
    binary = load(image)
    assert isinstance(binary, Binary), binary
    emulator = Emulator(image, cpu)
    seen: set[int] = set()
    for name in binary.function_names():
        symbol = binary.function(name)
        if not HELPER.fullmatch(name) or symbol.key in seen:
            continue
        for key, cfg in callgraph.build_program(binary, symbol.key).items():
            local, base = key != symbol.key, cfg.name.partition("+")[0]
            if key in seen or (local and not (cfg.name != base and HELPER.fullmatch(base))):
                continue
            seen.add(key)
            tabulate(found, base if local else name, symbol.key, split_irreducible(cfg), local, emulator, table, runs)


def tabulate(
    found: str, name: str, key: int, cfg: Cfg, local: bool, emulator: Emulator, table: dict[str, dict], runs: int
) -> None:
    """Add the loops of one helper, or of a subroutine inside it, that need the table."""
    nest = loop_nest(cfg)
    open_headers = sorted(
        {cfg.blocks[loop.header].address for loop in nest.loops if bound_by_ranking(cfg, nest, loop) is None}
    )
    if not open_headers:
        return
    compiler_rt = found.startswith("compiler")
    rules = [r for r in RULES if re.fullmatch(r.helper, name) and (r.compiler_rt, r.local) == (compiler_rt, local)]
    if not rules:
        print(f"{found}: {cfg.name} has a loop without a rule: {[hex(h) for h in open_headers]}")
        return
    rule = rules[0]
    total = rule.total // _step(cfg, nest) if rule.unrolled else rule.total
    most = observe(emulator, key, open_headers, runs)
    print(f"{found}: {cfg.name} bound {total} observed {sorted(most.values())}", flush=True)
    assert max(most.values()) <= total, (cfg.name, most)
    entry = table.setdefault(fingerprint(cfg), {"names": [], "found": [], "loops": {}})
    entry["names"] += [] if name in entry["names"] else [name]
    entry["found"] += [] if found in entry["found"] else [found]
    for header in open_headers:
        entry["loops"][header - cfg.address] = (total, rule.proof)


def _step(cfg: Cfg, nest: LoopNest) -> int:
    """By how much the one loop's counter falls: the constant that its only subtraction of a constant takes off."""
    (loop,) = nest.loops
    texts = [instruction.text for block in loop.blocks for instruction in cfg.blocks[block].instructions]
    (step,) = [
        int(found[2], 0) for text in texts if (found := re.fullmatch(r"subs?(?:\.w)? (\w+), (?:\1, )?#(\w+)", text))
    ]
    return step


def write(path: Path, table: dict[str, dict], proofs: Mapping[str, str], writer: str) -> None:
    """One TOML file."""
    lines = [f"# Written by tests/wcet/flow/{writer}; the proofs stand there, too.", f"format = {FORMAT}", ""]
    used = {loop[1] for entry in table.values() for loop in entry["loops"].values()}
    lines += ["[proofs]", *(f'{name} = "{text}"' for name, text in proofs.items() if name in used)]
    for key, entry in sorted(table.items(), key=lambda item: (item[1]["names"], item[0])):
        lines += ["", "[[function]]", f'fingerprint = "{key}"']
        lines += [
            f"{word} = [{', '.join(f'{chr(34)}{v}{chr(34)}' for v in entry[word])}]" for word in ("names", "found")
        ]
        loops = (
            f'{{ offset = {offset}, {_bound(bound)}{_each(*each)}, proof = "{proof}" }}'
            for offset, (bound, proof, *each) in sorted(entry["loops"].items())
        )
        lines += ["loops = [", *(f"  {loop}," for loop in loops), "]"]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def _bound(bound: int | str) -> str:
    return f"total = {bound}" if isinstance(bound, int) else f'bound = "{bound}"'


def _each(each: int = 0) -> str:
    return f", each = {each}" if each else ""


def main(runs: int = 3000, only: str = "") -> None:
    """Rebuild both files, or the one whose name begins with `only`."""
    with tempfile.TemporaryDirectory() as folder:
        images = build(Path(folder))
        for prefix in (prefix for prefix in ("libgcc", "compiler-rt") if prefix.startswith(only)):
            table: dict[str, dict] = {}
            for found, cpu, image in images:
                if found.startswith(prefix):
                    survey(found, cpu, image, table, runs)
            write(LIBRARY / f"{prefix}.toml", table, PROOFS, "build_library_table.py")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 3000, sys.argv[2] if len(sys.argv) > 2 else "")
