"""Builds the corpus: every program x compiler setting x core, as ELF images in build/corpus (not in the repository).

python benchmarks/corpus/build.py [--programs A,B] [--compilers gcc-O2,clang-O2] [--cores cortex-m0] [--out DIR]
"""

from __future__ import annotations

import argparse
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))

from images import COMPILERS, CORES, OUT, Image, build, missing
from manifest import sources


def main() -> int:
    arguments = _arguments()
    out = arguments.out.resolve()
    out.mkdir(parents=True, exist_ok=True)
    compilers = []
    for compiler in arguments.compilers.split(","):
        reason = missing(compiler)
        if reason:
            print(f"SKIPPED: every image of {compiler}: {reason}", file=sys.stderr)
        else:
            compilers.append(compiler)
    jobs = [
        (Image(source.stem, compiler, core), source)
        for source in sources(arguments.programs)
        for compiler in compilers
        for core in arguments.cores.split(",")
    ]
    with ThreadPoolExecutor(arguments.jobs) as pool:
        wrong = [text for text in pool.map(lambda job: build(*job, out), jobs) if text]
    for text in wrong:
        print(f"FAILED {text}", file=sys.stderr)
    print(f"{len(jobs) - len(wrong)} of {len(jobs)} images in {out}")
    return 1 if wrong else 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Build the corpus.")
    parser.add_argument("--programs", default="", help="only these, separated by commas")
    parser.add_argument("--compilers", default=",".join(COMPILERS))
    parser.add_argument("--cores", default=",".join(CORES))
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--jobs", type=int, default=2)
    return parser.parse_args()


if __name__ == "__main__":
    raise SystemExit(main())
