"""Builds the TTRK image with arm-none-eabi-gcc or with clang from the ziglang package (PyPI), whichever is asked for.

    python3 build.py [--compiler gcc|clang] [--output FILE]

gcc links its libgcc; clang links the compiler-rt that Zig carries. Both images hold the same codels, lie in the same
memories and carry DWARF lines; neither holds the path of this folder. (The compiler-rt of the second names the folder
of the ziglang package in its own DWARF, which no option changes.)
"""

from __future__ import annotations

import argparse
import importlib.util
import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
SOURCES = ("ig500.c", "chr6dm.c", "fusion.c", "command.c", "cicas.c", "realmath.c", "crc16.c", "start.c")
COMMON = ("-std=c11", "-O2", "-g", "-ffreestanding", "-Wall", "-Wextra", "-Werror", "-pedantic")
LINK = ("-Wl,--build-id=none", "-Wl,-T,ttrk.ld")


def command(compiler: str, output: Path) -> list[str]:
    """The compiler's command line; it is run in this folder, so that sources are named without a path."""
    files = (*LINK, f"-ffile-prefix-map={HERE}=.", *SOURCES, "-o", str(output))
    if compiler == "gcc":
        target = ("-mcpu=arm926ej-s", "-marm", "-mfloat-abi=soft", "-nostdlib")
        loops = ("-fno-tree-loop-distribute-patterns",)
        return ["arm-none-eabi-gcc", *COMMON, *target, *loops, *files, "-lgcc"]
    target = ("-target", "arm-freestanding-eabi", "-mcpu=arm926ej_s", "-fno-sanitize=all", "-fno-stack-protector")
    package = importlib.util.find_spec("ziglang")
    if package is None or package.origin is None:
        raise FileNotFoundError("the Python package ziglang is not installed")
    headers = f"-ffile-prefix-map={Path(package.origin).parent}=ziglang"
    tables = ("-fno-unwind-tables", "-fno-asynchronous-unwind-tables")
    return [sys.executable, "-m", "ziglang", "cc", *target, *tables, *COMMON, headers, *files]


def build(compiler: str, output: Path) -> None:
    """Compile and link in one step. Raises CalledProcessError or FileNotFoundError where that fails."""
    subprocess.run(command(compiler, output.absolute()), cwd=HERE, check=True, env={**os.environ, "PWD": str(HERE)})


def main() -> None:
    """Parse the command line and build."""
    parser = argparse.ArgumentParser(description="Build the TTRK image.")
    parser.add_argument("--compiler", choices=("gcc", "clang"), default="gcc")
    parser.add_argument("--output", type=Path, default=HERE / "ttrk.elf")
    arguments = parser.parse_args()
    build(arguments.compiler, arguments.output)


if __name__ == "__main__":
    main()
