"""Large, deep and wide programs, measured: `python benchmarks/limits.py [--timeout S]`.

Each is made and compiled with arm-none-eabi-gcc, and its function `f` analysed in a process of its own. Shown are the
bound or the first problem, the CPU seconds, and the greatest memory.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
GCC = ("arm-none-eabi-gcc", "-mcpu=cortex-m3", "-mthumb", "-nostdlib", "-nostartfiles", "-ffreestanding", "-fno-inline")
LINK = ("-Wl,-Ttext=0x8000", "-Wl,-e,f", "-lgcc")


def straight(length: int) -> str:
    """A function of so many instructions without a branch."""
    line = '__asm__ volatile("add %0, %0, %1" : "+r"(a) : "r"(b));\n'
    return "int f(int a, int b) {\n" + line * length + "return a; }\n"


def chain(length: int) -> str:
    """Functions that pass a number on to a loop."""
    text = "int tab[64];\n"
    text += f"int c{length}(int n) {{ int s = 0; for (int i = 0; i < n; i++) s += tab[i & 63]; return s; }}\n"
    for number in range(length - 1, -1, -1):
        text += f"int c{number}(int n) {{ return c{number + 1}(n) + 1; }}\n"
    return text + "int f(void) { return c0(17); }\n"


def wide(count: int) -> str:
    """A function that calls so many others, each with a loop as long as the caller says."""
    text = "int tab[64];\n"
    for k in range(count):
        text += f"int w{k}(int n) {{ int s = {k}; for (int i = 0; i < n; i++) s += tab[(i + {k}) & 63]; return s; }}\n"
    calls = "".join(f"s += w{k}({k % 50 + 1});\n" for k in range(count))
    return text + "int f(void) { int s = 0;\n" + calls + "return s; }\n"


def diamond(layers: int) -> str:
    """Layers of two functions that each call both of the next, with other numbers: 2^layers ways."""
    text = "int tab[64];\n"
    for side in "ab":
        text += f"int d{layers}{side}(int n) {{ int s = 0; for (int i = 0; i < n; i++) s += tab[i & 63]; return s; }}\n"
    for layer in range(layers - 1, -1, -1):
        for side in "ab":
            text += f"int d{layer}{side}(int x) {{ return d{layer + 1}a(x + 1) + d{layer + 1}b(x + 2); }}\n"
    return text + "int f(void) { return d0a(1) + d0b(2); }\n"


def nest(depth: int, limit: str) -> str:
    """Loops in each other up to `limit`, in which {} is the loop's number."""
    text = "volatile int sink; " + "".join(f"int n{k};" for k in range(depth)) + "\nvoid f(void) {\n"
    for k in range(depth):
        text += f"for (int i{k} = 0; i{k} < {limit.format(k)}; i{k}++) {{\n"
    return text + "sink += 1;\n" + "}" * (depth + 1) + "\n"


def floats(count: int) -> str:
    """So many calls of the soft-float library, four in each statement."""
    lines = (f"x = x * a[{k}] + {k}.5f; if (x > a[{k * 7 % count}]) x /= 3.0f;\n" for k in range(count // 4))
    return f"volatile float a[{count}];\nfloat f(float x) {{\n" + "".join(lines) + "return x; }\n"


PROGRAMS = {
    "straight, 200 000 instructions": (straight(200_000), "-O1"),
    "chain of 300 calls": (chain(300), "-O1"),
    "30 callees": (wide(30), "-O1"),
    "300 callees": (wide(300), "-O1"),
    "diamond of 20 layers": (diamond(20), "-O1"),
    "nest of 12, constant limits": (nest(12, "3"), "-O0"),
    "nest of 12, unknown limits -O0": (nest(12, "n{}"), "-O0"),
    "nest of 12, unknown limits -O2": (nest(12, "n{}"), "-O2"),
    "1 000 soft-float calls": (floats(1000), "-O2"),
}

MEASURE = """
import json, resource, sys
from mauve.wcet.analysis import analyse
from mauve.wcet.hardware.board import Board
(found,) = analyse(sys.argv[1], ["f"], Board("bench", "cortex-m3", 72_000_000), timeout=float(sys.argv[2]))
used = resource.getrusage(resource.RUSAGE_SELF)
problems = [problem.message for problem in found.problems]
print(json.dumps([found.cycles, problems, found.seconds, used.ru_utime + used.ru_stime, used.ru_maxrss // 1024]))
"""


def main() -> None:
    """Measure all programs."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("--timeout", type=float, default=60.0)
    timeout = parser.parse_args().timeout
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    with tempfile.TemporaryDirectory() as folder:
        for name, (text, level) in PROGRAMS.items():
            source, elf = Path(folder, "f.c"), Path(folder, "f.elf")
            source.write_text(text)
            subprocess.run([*GCC, level, str(source), *LINK, "-o", str(elf)], check=True)
            command = [sys.executable, "-c", MEASURE, str(elf), str(timeout)]
            run = subprocess.run(command, check=True, env=environment, capture_output=True, text=True)
            cycles, problems, wall, cpu, memory = json.loads(run.stdout)
            result = f"{cycles} cycles" if cycles is not None else f"{len(problems)} problems: {problems[0]}"
            print(f"{name:32} {wall:6.1f} s {cpu:6.1f} s CPU {memory:5} MiB  {result}", flush=True)


if __name__ == "__main__":
    main()
