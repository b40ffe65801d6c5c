"""One image of the corpus: its names, the command that builds it, and the build.

gcc is arm-none-eabi-gcc with newlib and libgcc; clang is that of the ziglang package with newlib's libm and libc and
the compiler-rt that Zig carries. An image is built again when its sources or its command have changed.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from shutil import which

HERE = Path(__file__).resolve().parent
OUT = HERE.parents[1] / "build" / "corpus"


@dataclass(frozen=True)
class Core:
    """A processor: its name on boards, the board's core, what the two compilers call it."""

    name: str
    board: str
    gcc: tuple[str, ...]
    zig: tuple[str, ...]


CORES = {
    core.name: core
    for core in (
        Core(
            "arm7tdmi",
            "arm7tdmi",
            ("-mcpu=arm7tdmi", "-marm"),
            ("-target", "arm-freestanding-eabi", "-mcpu=arm7tdmi"),
        ),
        Core(
            "arm926ej-s",
            "arm926ej-s",
            ("-mcpu=arm926ej-s", "-marm"),
            ("-target", "arm-freestanding-eabi", "-mcpu=arm926ej_s"),
        ),
        Core(
            "cortex-m0",
            "cortex-m0",
            ("-mcpu=cortex-m0", "-mthumb"),
            ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m0"),
        ),
        Core(
            "cortex-m3",
            "cortex-m3",
            ("-mcpu=cortex-m3", "-mthumb"),
            ("-target", "thumb-freestanding-eabi", "-mcpu=cortex_m3"),
        ),
        Core(
            "cortex-m4f",
            "cortex-m4f",
            ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard"),
            ("-target", "thumb-freestanding-eabihf", "-mcpu=cortex_m4"),
        ),
    )
}
COMPILERS = ("gcc-O0", "gcc-O1", "gcc-O2", "gcc-O3", "gcc-Os", "clang-O2")
COMMON = ("-std=gnu11", "-g", "-fno-common", "-Wall", "-Wextra", "-Werror", "-Wl,--build-id=none")


@dataclass(frozen=True)
class Image:
    """One build of one program."""

    program: str
    compiler: str
    core: str

    @property
    def name(self) -> str:
        return f"{self.program}.{self.compiler}.{self.core}"


def name_of(path: Path) -> Image:
    """The image a file in the output folder is."""
    program, compiler, core = path.name.removesuffix(".elf").split(".")
    return Image(program, compiler, core)


@cache
def libraries(core: str) -> tuple[str, str]:
    """newlib's libm.a and libc.a for a core."""
    command = ["arm-none-eabi-gcc", *CORES[core].gcc]
    ask = [subprocess.check_output([*command, f"-print-file-name={name}"], text=True) for name in ("libm.a", "libc.a")]
    return ask[0].strip(), ask[1].strip()


@cache
def headers() -> str:
    """The folder of newlib's headers, which clang shares."""
    said = subprocess.run(
        ["arm-none-eabi-gcc", "-E", "-M", "-x", "c", "-"], input="#include <math.h>\n", text=True, capture_output=True
    ).stdout
    return str(next(Path(word).resolve().parent for word in said.split() if word.endswith("/math.h")))


def command(files: Iterable[str], compiler: str, core: str, more: tuple[str, ...] = ()) -> list[str]:
    """The compiler's words that build an image from sources, without its output; run where link.ld is."""
    kind, _, level = compiler.partition("-")
    common = (*COMMON, f"-{level}", "-Wl,-T,link.ld", *more, *files, "start.c")
    if kind == "gcc":
        return ["arm-none-eabi-gcc", *CORES[core].gcc, "-nostartfiles", *common, "-lm"]
    plain = ("-fno-sanitize=all", "-fno-stack-protector", "-fno-unwind-tables", "-fno-asynchronous-unwind-tables")
    words = [sys.executable, "-m", "ziglang", "cc", *CORES[core].zig, *plain, "-isystem", headers()]
    return [*words, *common, *libraries(core)]


def missing(compiler: str) -> str:
    """Why a compiler cannot be used; empty where it can."""
    if which("arm-none-eabi-gcc") is None:
        return "arm-none-eabi-gcc is not installed"
    if compiler.startswith("clang") and find_spec("ziglang") is None:
        return "the Python package ziglang is not installed"
    return ""


def build(image: Image, source: Path, out: Path, more: tuple[str, ...] = ()) -> str:
    """Build one image unless it is there, with more options of the compiler; what went wrong, or empty."""
    name = str(source.relative_to(HERE)) if source.is_relative_to(HERE) else str(source)
    words = command([name], image.compiler, image.core, more)
    target = out / f"{image.name}.elf"
    digest = sha256("\0".join(words).encode())
    for path in (source, HERE / "start.c", HERE / "link.ld"):
        digest.update(path.read_bytes())
    stamp = out / f"{image.name}.hash"
    if target.exists() and stamp.exists() and stamp.read_text() == digest.hexdigest():
        return ""
    target.unlink(missing_ok=True)
    environment = {**os.environ, "PWD": str(HERE)}
    run = subprocess.run([*words, "-o", str(target)], cwd=HERE, env=environment, capture_output=True, text=True)
    if run.returncode:
        return f"{image.name}: {run.stderr.strip() or 'failed'}"
    stamp.write_text(digest.hexdigest())
    return ""
