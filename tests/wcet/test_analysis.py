"""The library as a whole: from an executable to bounds, and bad input to reasons."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from mauve.units import cycles_to_time
from mauve.wcet.analysis import analyse
from mauve.wcet.cache import Cache
from mauve.wcet.flow.facts import AtLine, Counting, LoopFact
from mauve.wcet.hardware.board import Board, Memory
from mauve.wcet.result import Origin, ProblemKind
from mauve.wcet.sources import source_files
from tests.wcet.programs import FIXTURES, image

O0 = FIXTURES / "arm7tdmi-arm-O0.elf"
O2 = FIXTURES / "arm7tdmi-arm-O2.elf"
BOARD = Board("bench", "arm7tdmi", 60_000_000)


def test_figure_2_end_to_end() -> None:
    """At -O0 the loop of `sum` runs its header 101 times and its body 100 times, and nobody had to say so."""
    (result,) = analyse(O0, ["sum"], BOARD)
    assert result.problems == ()
    assert [(loop.bound, loop.origin, loop.source) for loop in result.loops] == [(101, Origin.ANALYSIS, "loops.c:9")]
    assert [(block.count, block.source.startswith("loops.c:")) for block in result.blocks] == [
        (1, True),
        (100, True),
        (101, True),
        (1, True),
    ]
    assert result.cycles == sum(block.total for block in result.blocks) == 3031
    assert result.time == cycles_to_time(3031, 60_000_000)
    assert result.address == image("arm7tdmi-arm-O0.elf").function("sum").address  # type: ignore[union-attr]


def test_functions_keep_their_order_and_one_failure_stays_alone() -> None:
    results = analyse(O2, ["sum", "list_sum", "no_such_function", "loop_nested"], BOARD)
    assert [result.name for result in results] == ["sum", "list_sum", "no_such_function", "loop_nested"]
    assert [result.bounded for result in results] == [True, False, False, True]
    assert results[1].problems[0].kind is ProblemKind.LOOP
    assert results[1].problems[0].source.startswith("data.c:")
    assert results[2].problems[0].kind is ProblemKind.SYMBOL


def test_functions_by_address() -> None:
    symbol = image("arm7tdmi-thumb-O2.elf").function("sum")
    by_name, by_address = analyse(
        FIXTURES / "arm7tdmi-thumb-O2.elf", ["sum", symbol.key], BOARD  # type: ignore[union-attr]
    )
    assert by_name.cycles is not None and by_name.cycles == by_address.cycles


def test_a_loaded_binary_will_do() -> None:
    assert analyse(image("arm7tdmi-arm-O2.elf"), ["sum"], BOARD)[0].cycles == analyse(O2, ["sum"], BOARD)[0].cycles


@pytest.mark.parametrize(
    ("content", "kind"),
    [
        (None, ProblemKind.BINARY),
        (b"", ProblemKind.BINARY),
        (b"\x7fELF but no more", ProblemKind.BINARY),
        (O2.read_bytes()[:4000], ProblemKind.BINARY),
        (O2.read_bytes()[:18] + b"\x3e" + O2.read_bytes()[19:], ProblemKind.NOT_ARM),
    ],
)
def test_unreadable_executables(tmp_path: Path, content: bytes | None, kind: ProblemKind) -> None:
    path = tmp_path / "robot.elf"
    if content is not None:
        path.write_bytes(content)
    (result,) = analyse(path, ["sum"], BOARD, cache=Cache(tmp_path / "cache.sqlite"))
    assert [problem.kind for problem in result.problems] == [kind]
    assert result.cycles is None


def test_data_is_no_function() -> None:
    (result,) = analyse(O2, ["squares"], BOARD)
    assert [problem.kind for problem in result.problems] == [ProblemKind.NOT_A_FUNCTION]


def test_boards_that_are_not_modelled() -> None:
    cached = Board("cached", "arm926ej-s", 200_000_000, (), ("dcache 8KiB",))
    unknown = Board("odd", "z80", 4_000_000)
    elsewhere = Board("small", "arm7tdmi", 1_000_000, (Memory("ram", 0x4000_0000, 0x1000, 0),))
    for board, kind in (
        (cached, ProblemKind.HARDWARE),
        (unknown, ProblemKind.HARDWARE),
        (elsewhere, ProblemKind.OUTSIDE),
    ):
        (result,) = analyse(O2, ["sum"], board)
        assert result.cycles is None
        assert kind in {problem.kind for problem in result.problems}


def test_a_fact_bounds_a_loop() -> None:
    # list_sum at -O0: `while (node)`
    loose = analyse(O0, ["list_sum"], BOARD)[0]
    assert not loose.bounded
    file, _, line = loose.problems[0].source.rpartition(":")
    fact = LoopFact(AtLine(file, int(line)), 6, Counting.BODY)
    (result,) = analyse(O0, ["list_sum"], BOARD, [fact])
    assert result.problems == ()
    assert [(loop.bound, loop.origin) for loop in result.loops] == [(7, Origin.ANNOTATION)]


def test_unchanged_results_need_no_disassembler(tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache.sqlite")
    first = analyse(O2, ["sum", "loop_nested"], BOARD, cache=cache)
    assert analyse(O2, ["sum", "loop_nested"], BOARD, cache=cache) == first
    code = (
        "import sys; from pathlib import Path\n"
        "from mauve.wcet.analysis import analyse; from mauve.wcet.cache import Cache\n"
        "from mauve.wcet.hardware.board import Board; from mauve.wcet.sources import source_files\n"
        "cache = Cache(Path(sys.argv[1]))\n"
        "results = analyse(sys.argv[2], ['sum', 'loop_nested'], Board('bench', 'arm7tdmi', 60_000_000), cache=cache)\n"
        "source_files(sys.argv[2], cache)\n"
        "print([r.cycles for r in results], sorted({'capstone', 'pulp', 'elftools'} & set(sys.modules)))\n"
    )
    source_files(O2, cache)
    command = [sys.executable, "-c", code, str(cache.path), str(O2)]
    run = subprocess.run(command, capture_output=True, text=True, check=True)
    assert run.stdout.strip() == f"{[result.cycles for result in first]} []"


def test_an_analysis_that_gave_up_is_not_kept(tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache.sqlite")
    (result,) = analyse(O2, ["loop_triple"], BOARD, timeout=0.0, cache=cache)
    assert [problem.kind for problem in result.problems] == [ProblemKind.LIMIT]
    (later,) = analyse(O2, ["loop_triple"], BOARD, cache=cache)
    assert later.bounded


def test_source_files_are_those_of_the_line_table(tmp_path: Path) -> None:
    cache = Cache(tmp_path / "cache.sqlite")
    files = source_files(O2, cache)
    assert {"loops.c", "data.c", "control.c", "arith.c"} <= {Path(file).name for file in files}
    assert source_files(O2, cache) == files
    assert source_files(tmp_path / "missing.elf", cache) == ()
