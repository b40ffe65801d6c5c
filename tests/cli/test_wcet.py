"""`mauvec wcet`: functions of an executable without a model."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path

import jsonschema
import pytest

from .conftest import ELF, FIXTURES, Command

SCHEMA = Path(__file__).resolve().parents[2] / "docs" / "schema" / "wcet-1.schema.json"
BOARD = ("--board", "generic-arm7tdmi")


def test_the_sum_of_figure_2(mauvec: Command) -> None:
    """At -O0 the header of the loop runs 101 times, its body 100 times."""
    run = mauvec("wcet", ELF, "sum", *BOARD)
    assert (run.code, run.err) == (0, "")
    lines = run.out.splitlines()
    assert lines[0].endswith("arm7tdmi-arm-O0.elf on generic-arm7tdmi (arm7tdmi at 60 MHz)")
    assert lines[3].split()[0] == "sum"
    assert lines[4] == "  1 function: 1 bounded, 0 without a bound"
    assert lines[7].split() == ["loops.c:9", "sum", "101", "analysis", *lines[7].split()[4:]]


def test_what_has_no_bound_is_located(mauvec: Command) -> None:
    run = mauvec("wcet", ELF, "list_sum", "recursive_odd", "sum", *BOARD)
    assert run.code == 1
    first, second = run.err.splitlines()
    assert first.startswith("data.c:79: error: ") and first.endswith("[MV511]")
    assert second.startswith("control.c:212: error: recursion") and second.endswith("[MV508]")
    assert "3 functions: 1 bounded, 2 without a bound" in run.out


def test_a_misspelt_function(mauvec: Command) -> None:
    run = mauvec("wcet", ELF, "list_summ", *BOARD)
    assert run.code == 1
    assert "there is no function `list_summ`" in run.err and "`list_sum`" in run.err


def test_data_is_no_function(mauvec: Command) -> None:
    run = mauvec("wcet", ELF, "counter_limit", "0xfffffff0", *BOARD)
    assert run.code == 1
    assert len(run.err.splitlines()) == 2
    assert "Traceback" not in run.err


def test_json_follows_the_published_schema(mauvec: Command) -> None:
    run = mauvec("wcet", ELF, "sum", "list_sum", "no_such", *BOARD, "--format", "json")
    document = json.loads(run.out)
    jsonschema.validate(document, json.loads(SCHEMA.read_text(encoding="utf-8")))
    assert [f["wcet_cycles"] is None for f in document["functions"]] == [False, True, True]
    assert document["functions"][0]["loops"][0]["bound"] == 101


def test_csv(mauvec: Command) -> None:
    run = mauvec("wcet", ELF, "sum", "list_sum", *BOARD, "--format", "csv")
    first, second = csv.DictReader(io.StringIO(run.out))
    assert first["name"] == "sum" and int(first["wcet_cycles"]) > 0 and first["problem"] == ""
    assert second["wcet_cycles"] == "" and second["problem"] == "unbounded-loop" and second["place"] == "data.c:79"


def test_the_worst_path(mauvec: Command) -> None:
    """Lines with their executions; all of them add up to the bound."""
    document = json.loads(mauvec("wcet", ELF, "sum", *BOARD, "--format", "json").out)["functions"][0]
    run = mauvec("wcet", ELF, "sum", *BOARD, "--explain")
    assert f"worst path of sum: {document['wcet_cycles']:,} cycles".replace(",", " ") in run.out
    rows = [line for line in run.out.splitlines() if line.startswith("  loops.c:")]
    assert rows[0].split()[0] == "loops.c:9", "its loop"
    assert any("s += t[i];" in row for row in rows), "the text of the source where it is there"
    assert "busiest loops: loops.c:9 in sum (101 times)" in run.out


def test_flow_facts(mauvec: Command, tmp_path: Path) -> None:
    """A fact by source line gives the missing bound; an error in the file has its place."""
    facts = tmp_path / "list.ff"
    facts.write_text('loop "data.c":79 max 10;\n', encoding="utf-8")
    run = mauvec("wcet", ELF, "list_sum", *BOARD, "--facts", facts)
    assert run.code == 0
    assert "annotation" in run.out
    facts.write_text("loop ??? max;\n", encoding="utf-8")
    broken = mauvec("wcet", ELF, "list_sum", *BOARD, "--facts", facts)
    assert (broken.code, broken.out) == (1, "")
    assert broken.err.startswith(f"{facts}:1:") and "[MV516]" in broken.err
    missing = mauvec("wcet", ELF, "list_sum", *BOARD, "--facts", tmp_path / "no.ff")
    assert missing.code == 1 and "[MV516]" in missing.err


def test_graphs(mauvec: Command) -> None:
    run = mauvec("wcet", ELF, "sum", *BOARD, "--emit", "cfg")
    assert (run.code, run.err) == (0, "")
    assert "sum" in run.out.splitlines()[0]
    assert mauvec("wcet", ELF, "summ", *BOARD, "--emit", "cfg").code == 1


def test_the_linear_program(mauvec: Command, tmp_path: Path) -> None:
    """The program of figure 2: maximise cycles, flow of every block, 100 times back to the header."""
    path = tmp_path / "sum.lp"
    assert mauvec("wcet", ELF, "sum", *BOARD, "--write-lp", path).code == 0
    text = path.read_text(encoding="utf-8")
    assert "Maximize" in text and "Subject To" in text and text.endswith("End\n")
    assert any("loop_" in line and "100 " in line for line in text.splitlines())
    assert [entry.name for entry in tmp_path.iterdir()] == ["sum.lp"], "written whole, no draft left"


def test_a_program_that_cannot_be_written(mauvec: Command, tmp_path: Path) -> None:
    run = mauvec("wcet", ELF, "sum", *BOARD, "--write-lp", tmp_path / "no" / "sum.lp")
    assert run.code == 1
    assert "cannot write" in run.err
    assert mauvec("wcet", ELF, "sum", "list_sum", *BOARD, "--write-lp", "x.lp").code == 2
    unbounded = mauvec("wcet", ELF, "list_sum", *BOARD, "--write-lp", tmp_path / "list.lp")
    assert unbounded.code == 1 and "no program" in unbounded.err
    assert list(tmp_path.iterdir()) == []


# ------------------------------------------------------------------------------------------------------------ boards
def test_a_board_that_does_not_exist(mauvec: Command) -> None:
    run = mauvec("wcet", ELF, "sum", "--board", "generic-arm7tdm")
    assert run.code == 2
    assert run.err.startswith("mauvec: there is no board `generic-arm7tdm` in the standard library; ")
    assert "`generic-arm7tdmi`" in run.err


OWN_BOARD = """\
mauve 1
package boards
board slow {
  cpu "arm7tdmi" at 30MHz
  icache off
  dcache off
  mmu off
  memory all at 0x0 size 4GiB wait 3cycles
}
board cached {
  cpu "arm7tdmi" at 30MHz
  icache 4KiB
  memory all at 0x0 size 4GiB wait 0cycles
}
"""


def test_a_board_of_a_model(mauvec: Command, tmp_path: Path) -> None:
    """More wait states never lower a bound; a cache without a model is an error, not a number."""
    file = tmp_path / "boards.mauve"
    file.write_text(OWN_BOARD, encoding="utf-8")
    slow = json.loads(mauvec("wcet", ELF, "sum", "--board", f"{file}:slow", "--format", "json").out)
    ideal = json.loads(mauvec("wcet", ELF, "sum", *BOARD, "--format", "json").out)
    assert slow["board"] == {"name": "slow", "core": "arm7tdmi", "hertz": 30_000_000}
    assert slow["functions"][0]["wcet_cycles"] > ideal["functions"][0]["wcet_cycles"]
    near = mauvec("wcet", ELF, "sum", "--board", f"{file}:slwo")
    assert near.code == 2 and "`slow`" in near.err
    missing = mauvec("wcet", ELF, "sum", "--board", f"{tmp_path}/no.mauve:slow")
    assert missing.code == 1 and "[MV002]" in missing.err
    cached = mauvec("wcet", ELF, "sum", "--board", f"{file}:cached")
    assert cached.code == 1


# ------------------------------------------------------------------------------------------------------------ batches
def test_every_function_of_a_small_executable(mauvec: Command, tmp_path: Path) -> None:
    """No function named: every symbol once, whatever it is, and the same in several processes as in one."""
    names = ("sum", "loop_up_unsigned", "loop_down_signed", "list_sum", "recursive_odd", "loop_step_up")
    one = mauvec("wcet", ELF, *names, *BOARD, "--format", "csv", "--no-cache", "--jobs", "1")
    two = mauvec("wcet", ELF, *names, *BOARD, "--format", "csv", "--no-cache", "--jobs", "2")
    assert [row.rsplit(",", 1)[0] for row in one.out.splitlines()] == [
        row.rsplit(",", 1)[0] for row in two.out.splitlines()
    ], "all but the seconds"
    assert (one.code, one.err) == (two.code, two.err)


def test_functions_are_listed_once_by_address() -> None:
    from mauve.wcet.batch import all_functions
    from mauve.wcet.binary.elf import Binary, load

    binary = load(FIXTURES / "arm7tdmi-thumb-O2.elf")
    assert isinstance(binary, Binary)
    listed = all_functions(FIXTURES / "arm7tdmi-thumb-O2.elf")
    assert isinstance(listed, tuple)
    keys = [binary.function(f if isinstance(f, str) else f"{f:#x}").key for f in listed]  # type: ignore[union-attr]
    assert keys == sorted(set(keys))
    assert set(keys) == {symbol.key for symbol in binary.functions}


def test_results_are_kept_for_the_next_run(mauvec: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    first = mauvec("wcet", ELF, "loop_step_up", *BOARD, "--format", "json")

    def no_analysis(*_: object, **__: object) -> None:
        raise AssertionError("analysed again")

    monkeypatch.setattr("mauve.wcet.flow.program.Programs", no_analysis)
    assert mauvec("wcet", ELF, "loop_step_up", *BOARD, "--format", "json").out == first.out
    assert mauvec("wcet", ELF, "loop_step_up", *BOARD, "--no-cache").code == 70


@pytest.mark.parametrize(
    ("image", "board", "cpu"),
    [
        ("cortex-m0-thumb-O2.elf", "generic-cortex-m0", "cortex-m0 at 48 MHz"),
        ("cortex-m0-thumb-O2.elf", "generic-cortex-m0plus", "cortex-m0plus at 48 MHz"),
        ("cortex-m3-thumb-O2.elf", "generic-cortex-m3", "cortex-m3 at 72 MHz"),
        ("cortex-m3-thumb-O2.elf", "generic-cortex-m4", "cortex-m4 at 168 MHz"),
        ("cortex-m3-thumb-O2.elf", "generic-cortex-m4f", "cortex-m4f at 168 MHz"),
    ],
)
def test_boards_of_the_microcontrollers(mauvec: Command, image: str, board: str, cpu: str) -> None:
    run = mauvec("wcet", FIXTURES / image, "sum", "--board", board)
    assert (run.code, run.err) == (0, "")
    assert f"on {board} ({cpu})" in run.out.splitlines()[0]
