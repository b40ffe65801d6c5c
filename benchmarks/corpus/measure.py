"""Measures the loop analysis on the corpus: loops bounded, bounds reached, executed addresses outside the graphs, time.

    python benchmarks/corpus/measure.py --mode inputs|initial|nofact [--sample N] [--inputs K] [--programs A,B]
        [--compilers ..] [--cores ..] [--images DIR] [--jobs 2] [--timeout 60] [--out FILE] [--failures FILE]

inputs: the linked data, inputs unknown within their declared sizes and ranges; initial: the linked data as it is, one
execution; nofact: nothing known of memory. Each image in a process of its own; images come from build.py.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from random import Random
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from images import COMPILERS, CORES, OUT, name_of  # noqa: E402
from manifest import sources  # noqa: E402
from report import failures, table  # noqa: E402

Row = dict[str, Any]


def measure(path: Path, source: Path, arguments: argparse.Namespace) -> Row:
    """The row of one image, from its process; a process that does not end in time is a row without results."""
    options = ["--mode", arguments.mode, "--inputs", str(arguments.inputs), "--timeout", str(arguments.timeout)]
    words = [sys.executable, str(HERE / "one.py"), str(path), str(source), *options, "--observe",
             str(arguments.observe)]  # fmt: skip
    image = name_of(path)
    row: Row = {"program": image.program, "compiler": image.compiler, "core": image.core, "mode": arguments.mode}
    limit = 15 * (arguments.timeout + arguments.observe) + 60
    started = time.perf_counter()
    try:
        run = subprocess.run(words, capture_output=True, text=True, timeout=limit)
    except subprocess.TimeoutExpired:
        return row | {"traceback": f"not ended after {limit:.0f} s", "seconds": time.perf_counter() - started}
    if run.returncode or not run.stdout.strip():
        return row | {"traceback": run.stderr.strip() or f"exit {run.returncode}", "seconds": 0.0}
    found: Row = json.loads(run.stdout.strip().splitlines()[-1])
    return found | {"source": str(source)}


def chosen(arguments: argparse.Namespace) -> list[tuple[Path, Path]]:
    """The images to measure, in an order that spreads programs when it is a sample."""
    known = {path.stem: path for path in sources(arguments.programs)}
    images = []
    for path in sorted(arguments.images.glob("*.elf")):
        image = name_of(path)
        if image.program in known and image.compiler in arguments.compilers and image.core in arguments.cores:
            images.append((path, known[image.program]))
    if arguments.sample and arguments.sample < len(images):
        images = spread(images, arguments.sample, arguments.seed)
    return images


def spread(images: list[tuple[Path, Path]], number: int, seed: int) -> list[tuple[Path, Path]]:
    """A sample that takes every program in turn, each time in another build."""
    random = Random(seed)
    builds: dict[str, list[tuple[Path, Path]]] = {}
    for image in images:
        builds.setdefault(image[1].stem, []).append(image)
    for group in builds.values():
        random.shuffle(group)
    order = sorted(builds)
    random.shuffle(order)
    picked: list[tuple[Path, Path]] = []
    while len(picked) < number:
        for program in order:
            if builds[program] and len(picked) < number:
                picked.append(builds[program].pop())
    return picked


def main() -> int:
    arguments = _arguments()
    images = chosen(arguments)
    if not images:
        raise SystemExit(f"no images in {arguments.images}: run build.py first")
    rows: list[Row] = []
    started = time.perf_counter()
    with ThreadPoolExecutor(arguments.jobs) as pool:
        jobs = [pool.submit(measure, path, source, arguments) for path, source in images]
        for job in as_completed(jobs):
            rows.append(job.result())
            if len(rows) % 10 == 0:
                spent = time.perf_counter() - started
                print(f"{len(rows)} of {len(images)} after {spent:.0f} s", file=sys.stderr, flush=True)
                write(rows, arguments)
    print(write(rows, arguments))
    return 0


def write(rows: list[Row], arguments: argparse.Namespace) -> str:
    """The table and the list of the rows so far; written to the files that were asked for."""
    rows.sort(key=lambda row: (row["program"], row["compiler"], row["core"]))
    text = f"{table(rows)}\n\n{failures(rows)}"
    if arguments.out:
        arguments.out.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
    if arguments.failures:
        arguments.failures.write_text(text + "\n", encoding="utf-8")
    return text


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Measure the loop analysis on the corpus.")
    parser.add_argument("--mode", choices=("inputs", "initial", "nofact"), default="inputs")
    parser.add_argument("--programs", default="", help="only these, separated by commas")
    parser.add_argument("--compilers", default=COMPILERS, type=lambda text: tuple(text.split(",")))
    parser.add_argument("--cores", default=tuple(CORES), type=lambda text: tuple(text.split(",")))
    parser.add_argument("--images", type=Path, default=OUT)
    parser.add_argument("--sample", type=int, default=0, help="so many images, all programs in turn (default: all)")
    parser.add_argument("--seed", type=int, default=1, help="of the sample")
    parser.add_argument("--inputs", type=int, default=10, help="random inputs of each image")
    parser.add_argument("--observe", type=float, default=10.0, help="processor seconds for further inputs")
    parser.add_argument("--timeout", type=float, default=60.0, help="processor seconds of the analysis")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--out", type=Path, help="the rows, as JSON")
    parser.add_argument("--failures", type=Path, help="the table and the ranked list, as text")
    return parser.parse_args()


if __name__ == "__main__":
    raise SystemExit(main())
