"""Bounds of functions as tables: cycles and time, loops with their origin, the worst path by source line."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import PurePath

from mauve.diagnostics.style import Role, Style
from mauve.report.check_text import frequency, grouped
from mauve.report.table import Align, Cell, Column, Row, format_table, percent
from mauve.units import format_time
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import LoopResult, Origin, WcetResult

FUNCTIONS = (
    Column("function", elastic=True),
    Column("cycles", Align.RIGHT),
    Column("WCET", Align.RIGHT),
    Column("stack", Align.RIGHT),
    Column("problem", elastic=True),
)
LOOPS = (
    Column("loop", elastic=True),
    Column("in", elastic=True),
    Column("context", elastic=True),
    Column("bound", Align.RIGHT),
    Column("total", Align.RIGHT),
    Column("origin"),
    Column("method", elastic=True),
)
PATH = (
    Column("line", elastic=True),
    Column("in", elastic=True),
    Column("times", Align.RIGHT),
    Column("cycles", Align.RIGHT),
    Column("part", Align.RIGHT),
    Column("source", elastic=True),
)
HOT_LINES = 20
"""Lines of a worst path that are shown, the dearest ones."""

LOOPS_OF = 10
"""Loops are listed for at most so many functions; JSON has them all."""


def format_wcet(
    elf: str, board: Board, results: Sequence[WcetResult], style: Style, limit: int | None = None
) -> str:
    """A row for each function, then the loops of a few; `limit` is the width to keep to."""
    about = f"{board.core} at {frequency(board.hertz)}"
    lines = [style.paint(Role.MESSAGE, f"{elf} on {board.name}") + f" ({about})", ""]
    lines += format_table(FUNCTIONS, [_function(result) for result in results], style, limit=limit)
    bounded = sum(result.bounded for result in results)
    lines.append(f"  {_count(len(results), 'function')}: {bounded} bounded, {len(results) - bounded} without a bound")
    loops = dict.fromkeys(loop for result in results for loop in result.loops)
    if loops and len(results) <= LOOPS_OF:
        rows = _loops(sorted(loops, key=lambda loop: (loop.function, loop.header, loop.context)))
        lines += ["", *format_table(LOOPS, rows, style, limit=limit)]
        lines.append("  bound: executions of the loop's header each time it is entered; total: in all")
    elif loops:
        lines.append(f"  {_count(len(loops), 'loop')}: name functions to see theirs, or use --format json")
    return "".join(line + "\n" for line in lines)


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"


def _function(result: WcetResult) -> Row:
    stack = "" if result.stack is None else f"{result.stack} B"
    if result.cycles is None or result.time is None:
        first = result.problems[0] if result.problems else None
        where = f" ({PurePath(first.source).name})" if first is not None and first.source else ""
        more = f", and {len(result.problems) - 1} more" if len(result.problems) > 1 else ""
        return (result.name, "", Cell("none", Role.ERROR), stack, f"{first.message if first else ''}{where}{more}")
    return (result.name, grouped(result.cycles), format_time(result.time), stack, "")


def _place(source: str, address: int) -> str:
    """A source line without its directories, which a table has no room for; else the address."""
    return PurePath(source).name if source else f"{address:#x}"


def _loops(loops: Sequence[LoopResult]) -> list[Row]:
    """A row each; the address tells loops of one line apart (compilers copy and unroll loops)."""
    headers: dict[tuple[str, str], set[int]] = {}
    for loop in loops:
        headers.setdefault((loop.source, loop.function), set()).add(loop.header)
    return [_loop(loop, len(headers[loop.source, loop.function]) > 1) for loop in loops]


def _loop(loop: LoopResult, ambiguous: bool) -> Row:
    where = _place(loop.source, loop.header) + (f" ({loop.header:#x})" if ambiguous and loop.source else "")
    if loop.bound is None and loop.total is None:
        return (where, loop.function, loop.context, Cell("none", Role.ERROR), "", "", "")
    role = Role.PLAIN if loop.origin in (Origin.ANALYSIS, Origin.LIBRARY) else Role.WARNING
    origin = Cell(loop.origin.value if loop.origin else "", role)
    bound = "" if loop.bound is None else grouped(loop.bound)
    total = "" if loop.total is None else grouped(loop.total)
    return (where, loop.function, loop.context, bound, total, origin, loop.method)


# ----------------------------------------------------------------------------------------------------- the worst path
def format_explanation(elf: str, results: Sequence[WcetResult], style: Style, limit: int | None = None) -> str:
    """For each bounded function: the dearest source lines of its worst path, and the loops that run most."""
    lines: list[str] = []
    for result in results:
        if result.cycles is not None:
            lines += ["", *_worst_path(elf, result, style, limit)]
    return "".join(line + "\n" for line in lines)


def _worst_path(elf: str, result: WcetResult, style: Style, limit: int | None) -> list[str]:
    whole = max(1, result.cycles or 0)
    times: dict[tuple[str, str], list[int]] = {}
    for block in result.blocks:
        place = (block.source or f"{block.address:#x}", block.function)
        entry = times.setdefault(place, [0, 0])
        entry[0] = max(entry[0], block.count)
        entry[1] += block.total
    dearest = sorted(times.items(), key=lambda item: (-item[1][1], item[0]))
    texts = _Sources(elf)
    rows: list[Row] = [
        (PurePath(place).name, function, grouped(count), grouped(cycles), percent(cycles / whole), texts.line(place))
        for (place, function), (count, cycles) in dearest[:HOT_LINES]
    ]
    rest = sum(cycles for _, (_, cycles) in dearest[HOT_LINES:])
    if rest:
        rows.append((f"{len(dearest) - HOT_LINES} others", "", "", grouped(rest), percent(rest / whole), ""))
    title = f"worst path of {result.name}: {grouped(whole)} cycles"
    table = format_table(PATH, rows, style, limit=limit)
    return [style.paint(Role.MESSAGE, title), "", *table, *_busiest(result), *_never(result)]


def _busiest(result: WcetResult) -> list[str]:
    """The loops whose headers run most on the worst path, each once."""
    counts = {block.address: block.count for block in result.blocks}
    headers: dict[tuple[str, str], int] = {}
    for loop in result.loops:
        place = (_place(loop.source, loop.header), loop.function)
        headers[place] = max(headers.get(place, 0), counts.get(loop.header, 0))
    busiest = [item for item in sorted(headers.items(), key=lambda item: -item[1]) if item[1] > 1][:3]
    words = [f"{name} in {function} ({grouped(count)} times)" for (name, function), count in busiest]
    return [f"  busiest loops: {'; '.join(words)}"] if words else []


NEVER = 8
"""Groups of branches that exclude each other that are shown."""


def _never(result: WcetResult) -> list[str]:
    """The branches that the worst path would like to take together."""
    lines = []
    for group in result.exclusive[:NEVER]:
        conditions: dict[str, dict[str, None]] = {}
        for way in group.branches:
            conditions.setdefault(_place(way.source, way.address), {})[way.condition] = None
        if len(conditions) > 1:
            ways = [f"{place} ({' or '.join(said)})" for place, said in conditions.items()]
        else:
            ways = [f"{_place(way.source, way.address)} ({way.condition})" for way in group.branches]
        where = "" if group.loop is None else f", in one iteration of the loop at {group.loop:#x}"
        lines.append(f"  never together: {', '.join(ways[:-1])} and {ways[-1]}{where}")
    rest = len(result.exclusive) - NEVER
    return [*lines, f"  and {_count(rest, 'such group')} more"] if rest > 0 else lines


class _Sources:
    """The lines of source files, as far as they lie where the executable says, seen from its own directory."""

    def __init__(self, elf: str) -> None:
        self.folder = PurePath(elf).parent
        self.files: dict[str, list[str]] = {}

    def line(self, place: str) -> str:
        """The text of `file.c:41`, empty where it is not there."""
        name, _, number = place.rpartition(":")
        if not name or not number.isdigit():
            return ""
        if name not in self.files:
            self.files[name] = self._read(name)
        lines = self.files[name]
        return lines[int(number) - 1].strip() if 0 < int(number) <= len(lines) else ""

    def _read(self, name: str) -> list[str]:
        from pathlib import Path

        try:
            return Path(self.folder / name).read_text(encoding="utf-8", errors="replace").splitlines()
        except (OSError, ValueError):
            return []
