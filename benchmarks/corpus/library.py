"""Measures the functions of newlib, libgcc and compiler-rt that codels call: bounded, or which message instead.

    python benchmarks/corpus/library.py [--compilers gcc-O2,clang-O2] [--cores ...] [--only sin,memcpy] [--inputs K]
        [--out FILE] [--failures FILE]

Every function is called with arguments of which nothing is known (in an executable for each compiler and core) and
analysed without facts, then executed on random ones: no bound may be exceeded. Those that depend on a size or a string
cannot be bounded so; they are to have one located message for each loop, and a bound where the size is constant.
"""

from __future__ import annotations

import argparse
import json
import re
import subprocess
import sys
import traceback
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from images import COMPILERS, CORES, OUT, command, missing  # noqa: E402
from library_source import NEEDS_FACT, bodies, source  # noqa: E402

Row = dict[str, Any]
UNDEFINED = re.compile(r"undefined (?:symbol: |reference to `)(\w+)")


def build(compiler: str, core: str, out: Path) -> Path:
    """The executable of a compiler and core; SystemExit where it cannot be built."""
    without: set[str] = set()
    program, target = out / "library.c", out / f"library.{compiler}.{core}.elf"
    for _ in range(3):
        program.write_text(source(without), encoding="utf-8")
        words = command([str(program)], compiler, core, ("-fno-builtin",))
        run = subprocess.run([*words, "-o", str(target)], cwd=HERE, capture_output=True, text=True)
        if run.returncode == 0:
            return target
        lacks = set(UNDEFINED.findall(run.stderr)) & set(bodies())
        if not lacks:
            break
        print(f"LACKING in {compiler} {core}: {' '.join(sorted(lacks))}", file=sys.stderr)
        without |= lacks
    raise SystemExit(f"{target.name}: {run.stderr}")


def examine(image: Path, only: set[str], inputs: int, timeout: float) -> list[Row]:
    """The rows of all entries of an executable, in this process."""
    from manifest import Manifest, read_manifest
    from one import analysed, count_processor_time, observed, opened

    count_processor_time()
    manifest, rows, several = read_manifest(image.parent / "library.c"), [], opened(image)
    _, compiler, core = image.name.removesuffix(".elf").split(".")
    for name in bodies():
        if only and name not in only:
            continue
        entry = Manifest("library", f"call_{name}", manifest.inputs)
        row: Row = {"function": name, "compiler": compiler, "core": core, "traceback": ""}
        try:
            figures, *rest = analysed(image, entry, CORES[core].board, "nofact", timeout, several)
            row |= figures
            binary, program, bounds, lines = rest
            row |= observed(image, entry, CORES[core].board, program, bounds, "nofact", inputs, 5.0, binary, lines)
        except AssertionError as error:
            row["traceback"] = "" if "there is no function" in str(error) else traceback.format_exc()
            if not row["traceback"]:
                continue
        except Exception:
            row["traceback"] = traceback.format_exc()
        rows.append(row)
    return rows


def verdict(row: Row) -> str:
    """One word for a row. Routines that are not followed, and so have no bound, have no graph to compare with."""
    if row["traceback"]:
        return "traceback"
    above = row["cycles"] is not None and max(row.get("walked", 0), row.get("timed", 0)) > row["cycles"]
    if above or (row["bounded"] and (row.get("wrong") or row.get("outside"))):
        return "UNSOUND"
    if row["bounded"]:
        return "bounded"
    located = all(p["address"] is not None for p in row["problems"])
    return ("message" if len(row["problems"]) == 1 else "messages") if located else "not located"


def summary(rows: list[Row]) -> str:
    """A table per executable, and the functions that are not bounded though nothing is missing."""
    lines = [
        "| executable | functions | bounded | asks for a fact, rightly | other | unsound | slowest s |",
        "|" + "---|" * 7,
    ]
    for key in sorted({(row["compiler"], row["core"]) for row in rows}):
        own = [row for row in rows if (row["compiler"], row["core"]) == key]
        verdicts = [verdict(row) for row in own]
        rightly = sum(
            v.startswith("message") and r["function"] in NEEDS_FACT for v, r in zip(verdicts, own, strict=True)
        )
        bounded, unsound = verdicts.count("bounded"), verdicts.count("UNSOUND")
        cells = (" ".join(key), len(own), bounded, rightly, len(own) - bounded - rightly - unsound, unsound,
                 max((row.get("wall", 0) for row in own), default=0))  # fmt: skip
        lines.append("| " + " | ".join(map(str, cells)) + " |")
    lines += ["", "## Library functions"]
    for name in sorted({row["function"] for row in rows}):
        bad = [r for r in rows if r["function"] == name and verdict(r) != "bounded" and
               (name not in NEEDS_FACT or not verdict(r).startswith("message"))]  # fmt: skip
        if bad:
            lines.append(
                f"* {name}: {len(bad)} executables ({', '.join(r['compiler'] + ' ' + r['core'] for r in bad)})"
            )
            lines += [f"    {text}" for text in dict.fromkeys(_reason(row) for row in bad[:4])]
            first = bad[0]
            lines.append(f"    python benchmarks/corpus/library.py --compilers {first['compiler']} --cores "
                         f"{first['core']} --only {name}")  # fmt: skip
    return "\n".join(lines)


def _reason(row: Row) -> str:
    if row["traceback"]:
        return str(row["traceback"].strip().splitlines()[-1])
    if verdict(row) == "UNSOUND":
        return f"UNSOUND: {row['wrong'][:2]} outside {row['outside'][:3]} cycles {row['cycles']} walked {row['walked']}"
    said = [f"{p['kind']} {p['function']} {p['source']}: {p['message']}" for p in row["problems"]]
    return f"{len(said)} problems: {'; '.join(said[:2])}"


def main() -> int:
    parser = argparse.ArgumentParser(description="Measure the functions of the C library.")
    parser.add_argument("--compilers", default="gcc-O2,clang-O2", help=f"of {', '.join(COMPILERS)}")
    parser.add_argument("--cores", default=",".join(CORES))
    parser.add_argument("--only", default="", help="functions, separated by commas")
    parser.add_argument("--inputs", type=int, default=12)
    parser.add_argument("--timeout", type=float, default=60.0)
    parser.add_argument("--folder", type=Path, default=OUT.parent / "library")
    parser.add_argument("--out", type=Path, help="the rows, as JSON")
    parser.add_argument("--failures", type=Path, help="the summary, as text")
    arguments = parser.parse_args()
    arguments.folder.mkdir(parents=True, exist_ok=True)
    rows: list[Row] = []
    text = ""
    for compiler in arguments.compilers.split(","):
        if reason := missing(compiler):
            print(f"SKIPPED: {compiler}: {reason}", file=sys.stderr)
            continue
        for core in arguments.cores.split(","):
            image = build(compiler, core, arguments.folder.resolve())
            rows += examine(image, set(filter(None, arguments.only.split(","))), arguments.inputs, arguments.timeout)
            print(f"{compiler} {core}: done", file=sys.stderr, flush=True)
            text = summary(rows)
            if arguments.out:
                arguments.out.write_text(json.dumps(rows, indent=1) + "\n", encoding="utf-8")
            if arguments.failures:
                arguments.failures.write_text(text + "\n", encoding="utf-8")
    print(text)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
