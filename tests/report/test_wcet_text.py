"""Bounds of functions as text and as CSV, from results made here."""

from __future__ import annotations

from pathlib import Path

from mauve.diagnostics.style import PLAIN
from mauve.report.wcet_csv import format_csv
from mauve.report.wcet_text import format_explanation, format_wcet
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import BlockResult, LoopResult, Origin, Problem, ProblemKind, WcetResult

BOARD = Board("desk", "arm926ej-s", 200_000_000)
DONE = WcetResult(
    "step",
    0x8000,
    12_345,
    61_725_000,
    blocks=(
        BlockResult(0x8000, 8, "step", 1, 45, "src/step.c:3", 45),
        BlockResult(0x8008, 12, "step", 100, 120, "src/step.c:5", 12_000),
        BlockResult(0x8014, 4, "step", 100, 3, "src/step.c:5", 300),
    ),
    loops=(
        LoopResult(0x8008, "step", "src/step.c:5", 100, None, Origin.ANALYSIS, "affine"),
        LoopResult(0x8040, "step", "src/step.c:9", 8, 20, Origin.ANNOTATION, "flow fact"),
        LoopResult(0x8060, "step", "src/step.c:9", None, None, None),
    ),
    stack=24,
)
PROBLEMS = (
    Problem(ProblemKind.LOOP, "the loop has no bound", 0x9000, "scan", "src/scan.c:7"),
    Problem(ProblemKind.RECURSION, "recursion: a -> a", 0x9100, "a"),
)
OPEN = WcetResult("scan", 0x9000, None, None, problems=PROBLEMS)


def test_a_row_for_each_function_and_the_loops() -> None:
    assert format_wcet("robot.elf", BOARD, [DONE, OPEN], PLAIN).splitlines() == [
        "robot.elf on desk (arm926ej-s at 200 MHz)",
        "",
        "  function  cycles      WCET  stack  problem",
        "  step      12 345  61.725us   24 B",
        "  scan                  none         the loop has no bound (scan.c:7), and 1 more",
        "  2 functions: 1 bounded, 1 without a bound",
        "",
        "  loop               in    bound  total  origin      method",
        "  step.c:5           step    100         analysis    affine",
        "  step.c:9 (0x8040)  step      8     20  annotation  flow fact",
        "  step.c:9 (0x8060)  step   none",
        "  bound: executions of the loop's header each time it is entered; total: in all",
    ]


def test_loops_of_many_functions_are_counted_only() -> None:
    text = format_wcet("robot.elf", BOARD, [DONE] * 11, PLAIN)
    assert text.endswith("  3 loops: name functions to see theirs, or use --format json\n")


def test_the_worst_path_by_line(tmp_path: Path) -> None:
    """Executions are those of the most frequent block of a line, cycles those of all; the text where it is found."""
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "step.c").write_text("\n\n  int s = 0;\n\n  for (;;)\n", encoding="utf-8")
    assert format_explanation(str(tmp_path / "robot.elf"), [DONE, OPEN], PLAIN).splitlines() == [
        "",
        "worst path of step: 12 345 cycles",
        "",
        "  line      in    times  cycles    part  source",
        "  step.c:5  step    100  12 300  99.6 %  for (;;)",
        "  step.c:3  step      1      45   0.4 %  int s = 0;",
        "  busiest loops: step.c:5 in step (100 times)",
    ]


def test_csv() -> None:
    assert format_csv([DONE, OPEN]).splitlines() == [
        "name,address,wcet_cycles,wcet_ns,stack_bytes,loops,problem,place,message,seconds",
        "step,0x8000,12345,61725,24,3,,,,0.0",
        "scan,0x9000,,,,0,unbounded-loop,src/scan.c:7,the loop has no bound,0.0",
    ]
