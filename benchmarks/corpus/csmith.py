"""Measures the analysis on random programs: their linked data, one execution each, on several cores.

    python benchmarks/corpus/csmith.py [--first 1] [--programs 500] [--cores arm7tdmi,cortex-m0,cortex-m3]
        [--compilers gcc-O0,...] [--out FILE] [--failures FILE]

Needs csmith and its headers (Debian: csmith, libcsmith-dev). Every program is built by one of the compiler settings in
turn. Programs that do not end within some million instructions (there are endless ones) are analysed all the same, but
stand in no figure.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from shutil import which
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from images import COMPILERS, CORES, OUT, Image, build, missing  # noqa: E402
from measure import measure  # noqa: E402
from report import failures, table  # noqa: E402

HEADERS = Path("/usr/include/csmith")
OPTIONS = ("--no-argc", "--max-funcs", "4", "--max-block-depth", "3", "--max-expr-complexity", "5")


def generate(seed: int, folder: Path) -> Path:
    """The program of a seed, with a manifest before it."""
    text = subprocess.run(["csmith", "--seed", str(seed), *OPTIONS], capture_output=True, text=True, check=True).stdout
    path = folder / f"seed{seed}.c"
    path.write_text("/* entry: main; inputs: none */\n" + text, encoding="utf-8")
    return path


def prepare(seed: int, compiler: str, cores: list[str], folder: Path) -> list[tuple[Path, Path]]:
    """The images of a seed and their source."""
    source = generate(seed, folder)
    made = []
    for core in cores:
        image = Image(source.stem, compiler, core)
        wrong = build(image, source, folder, ("-w", f"-I{HERE / 'random'}", "-isystem", str(HEADERS)))
        if wrong:
            print(f"FAILED {wrong[:400]}", file=sys.stderr)
        else:
            made.append((folder / f"{image.name}.elf", source))
    return made


def main() -> int:
    arguments = _arguments()
    if which("csmith") is None or not HEADERS.exists():
        raise SystemExit("csmith and its headers are not installed (Debian: csmith, libcsmith-dev)")
    compilers = [name for name in arguments.compilers.split(",") if not missing(name)]
    folder = arguments.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    rows: list[dict[str, Any]] = []
    started = time.perf_counter()
    with ThreadPoolExecutor(arguments.jobs) as pool:
        images = [
            image
            for seed in range(arguments.first, arguments.first + arguments.programs)
            for image in prepare(seed, compilers[seed % len(compilers)], arguments.cores.split(","), folder)
        ]
        jobs = [pool.submit(measure, path, source, arguments) for path, source in images]
        for job in as_completed(jobs):
            rows.append(job.result())
            if len(rows) % 20 == 0:
                spent = time.perf_counter() - started
                print(f"{len(rows)} of {len(jobs)} after {spent:.0f} s", file=sys.stderr, flush=True)
    rows.sort(key=lambda row: (row["program"], row["compiler"], row["core"]))
    ended = [row for row in rows if not row.get("failed")]
    text = "\n".join([f"{len(ended)} of {len(rows)} executions ended; of them:", table(ended), failures(rows)])
    print(text)
    if arguments.out:
        arguments.out.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    if arguments.failures:
        arguments.failures.write_text(text + "\n", encoding="utf-8")
    return 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Measure the analysis on random programs.")
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    parser.add_argument("--programs", type=int, default=500)
    parser.add_argument("--cores", default="arm7tdmi,cortex-m0,cortex-m3", help=f"of {', '.join(CORES)}")
    parser.add_argument("--compilers", default=",".join(COMPILERS), help="one for each program, in turn")
    parser.add_argument("--folder", type=Path, default=OUT.parent / "csmith")
    parser.add_argument("--timeout", type=float, default=60.0, help="processor seconds of the analysis")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, help="the rows, as JSON")
    parser.add_argument("--failures", type=Path, help="the table and the ranked list, as text")
    parser.set_defaults(mode="initial", inputs=1, observe=10.0)
    return parser.parse_args()


if __name__ == "__main__":
    raise SystemExit(main())
