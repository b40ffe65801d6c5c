"""Rows of measurements as a table per compiler and core, and as a ranked list of what went wrong."""

from __future__ import annotations

from collections.abc import Sequence
from math import ceil
from pathlib import Path
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
Row = dict[str, Any]
Loop = dict[str, Any]

MOST = 1 << 20
"""A bound above it only reflects the range of a type (semantics of record, section 5): it counts as none."""
TYPE_RANGES = {127, 128, 129, 254, 255, 256, 257, 32767, 32768, 32769, 65534, 65535, 65536, 65537}


def unbounded(loop: Loop) -> bool:
    return loop["bound"] is None or loop["bound"] > MOST


def typical(loop: Loop) -> bool:
    """Whether a bound looks like the range of a type: such a number, and executions far below it."""
    return loop["bound"] in TYPE_RANGES and 0 < loop["seen"] * 2 < loop["bound"]


def unsound(loop: Loop) -> bool:
    return loop["bound"] is not None and loop["bound"] < loop["seen"]


def share(part: int, whole: int) -> str:
    return f"{100 * part / whole:.1f}" if whole else "-"


def quantile(values: Sequence[float], at: float) -> float:
    """The smallest value that is at least as great as a share `at` of all."""
    ordered = sorted(values)
    return ordered[max(0, ceil(at * len(ordered)) - 1)] if ordered else 0.0


def table(rows: Sequence[Row]) -> str:
    """The figures of every compiler x core, of each compiler, each core, and of all."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        for name in (f"{row['compiler']} {row['core']}", f"{row['compiler']} *", f"* {row['core']}"):
            groups.setdefault(name, []).append(row)
    single = [name for name in groups if "*" not in name]
    order = sorted(single) + sorted(name for name in groups if "*" in name)
    head = ("build", "images", "bounded %", "loops", "bounded %", "typed", "equal %", "unsound", "outside", "wrong",
            "errors", "median s", "p95 s", "peak MB", "cycles/walked")  # fmt: skip
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += [_line(name, groups[name]) for name in order]
    lines.append(_line("all", rows))
    return "\n".join(lines)


def _line(name: str, rows: Sequence[Row]) -> str:
    loops = [loop for row in rows for loop in row.get("loops", ())]
    known = [loop for loop in loops if not unbounded(loop)]
    ratios = [row["cycles"] / row["walked"] for row in rows if row.get("cycles") and row.get("walked")]
    seconds = [row["seconds"] for row in rows if "seconds" in row]
    cells = (
        name,
        len(rows),
        share(sum(bool(row.get("bounded")) for row in rows), len(rows)),
        len(loops),
        share(len(known), len(loops)),
        sum(map(typical, loops)),
        share(sum(loop["bound"] == loop["seen"] for loop in known), len(loops)),
        sum(map(unsound, loops)),
        sum(bool(row.get("outside")) for row in rows),
        sum(bool(row.get("wrong")) or _below(row) for row in rows),
        sum(bool(row.get("traceback")) or bool(row.get("failed")) for row in rows),
        f"{quantile(seconds, 0.5):.2f}",
        f"{quantile(seconds, 0.95):.1f}",
        max((row.get("megabytes", 0) for row in rows), default=0),
        f"{quantile(ratios, 0.5):.2f}",
    )
    return "| " + " | ".join(map(str, cells)) + " |"


def _below(row: Row) -> bool:
    """Whether an execution took longer than the bound."""
    return row.get("cycles") is not None and max(row.get("walked", 0), row.get("timed", 0)) > row["cycles"]


def failures(rows: Sequence[Row]) -> str:
    """What went wrong, gravest first, then by how many builds are affected; each with a command that shows it."""
    found: dict[tuple[int, str, str], list[tuple[Row, str]]] = {}
    for row in rows:
        for rank, title, place, detail in _faults(row):
            found.setdefault((rank, title, place), []).append((row, detail))
    lines = [f"# {sum(len(v) for v in found.values())} findings at {len(found)} places"]
    last = ""
    for (_, title, place), cases in sorted(found.items(), key=lambda item: (item[0][0], -len(item[1]), item[0][2])):
        if title != last:
            lines += ["", f"## {title}"]
            last = title
        builds = list(dict.fromkeys(f"{row['compiler']} {row['core']}" for row, _ in cases))
        lines += [f"* {place}: {len(builds)} builds ({', '.join(builds[:6])}{', ...' if len(builds) > 6 else ''})"]
        lines += [f"    {text}" for text in dict.fromkeys(detail for _, detail in cases[:3])]
        lines += [f"    {reproduce(cases[0][0])}"]
    return "\n".join(lines)


def reproduce(row: Row) -> str:
    """The command that shows a row again, from the root of the checkout."""
    name = f"{row['program']}.{row['compiler']}.{row['core']}.elf"
    source = Path(row.get("source") or f"benchmarks/corpus/programs/{row['program']}.c")
    folder = Path("build/corpus") if source.parent.name == "programs" else source.parent
    paths = (str(path).removeprefix(f"{ROOT}/") for path in (folder / name, source))
    return f"python benchmarks/corpus/one.py {' '.join(paths)} --mode {row['mode']}"


def _faults(row: Row) -> list[tuple[int, str, str, str]]:
    """(rank, kind, place, detail) of everything that is not as it should be in a row."""
    program, faults = row["program"], []
    if row.get("traceback"):
        faults.append((0, "Tracebacks", program, row["traceback"].strip().splitlines()[-1]))
    if row.get("outside"):
        where = ", ".join(f"{a:#x}" for a in row["outside"][:4])
        reasons = "; ".join(p["message"] for p in row["problems"][:2])
        faults.append((2, "Executed addresses outside the graphs", program, f"{where}: {reasons}"))
    for text in row.get("wrong", ()):
        faults.append((1, "Contradicted by an execution", program, text))
    if _below(row):
        said = f"bound {row['cycles']}, retraced {row['walked']}, second model {row['timed']}"
        faults.append((1, "Executions above the bound in cycles", program, said))
    if row.get("failed"):
        faults.append((6, "Executions that did not end", program, row["failed"]))
    said_of = {problem["address"]: problem["message"] for problem in row.get("problems", ())}
    other = "; ".join(p["message"] for p in row.get("problems", ())[:1])
    for loop in row.get("loops", ()):
        place = f"{program} {loop['source'] or loop['function']}"
        at = f"{loop['function']} at {loop['header']:#x}, seen {loop['seen']}"
        if unsound(loop):
            faults.append((1, "Bounds below an execution", place, f"{at}, bound {loop['bound']} ({loop['method']})"))
        elif unbounded(loop):
            why = said_of.get(loop["header"]) or loop["method"] or other
            why = why if loop["bound"] is None else f"bound {loop['bound']}"
            faults.append((3, "Loops without a bound", place, f"{at}: {why}"))
        elif typical(loop):
            faults.append((4, "Bounds that may be a type's range", place, f"{at}, bound {loop['bound']}"))
        elif row["mode"] == "initial" and loop["bound"] != loop["seen"]:
            faults.append((5, "Bounds above the only execution", place, f"{at}, bound {loop['bound']}"))
    if row.get("bounded") is False and not any(unbounded(loop) for loop in row.get("loops", ())):
        kinds = "; ".join(f"{p['kind']} {p['source'] or p['function']}: {p['message']}" for p in row["problems"][:2])
        faults.append((3, "No bound for another reason", program, kinds))
    return faults
