"""`mauvec facts`: the template holds what is missing, no more, and is enough once it is filled in."""

from __future__ import annotations

from pathlib import Path

import pytest

from mauve.report.facts_text import format_ff, format_model
from mauve.wcet.flow.facts import AtLine, AtSymbol
from mauve.wcet.missing import MissingIn, MissingLoop

from .conftest import ELF, FIXTURES, Command

BOARD = ("--board", "generic-arm7tdmi")


@pytest.mark.parametrize("function", ["list_sum", "loop_from_argument"])
@pytest.mark.parametrize("form", ["mauve", "ff"])
def test_a_filled_template_bounds_the_function(mauvec: Command, tmp_path: Path, function: str, form: str) -> None:
    template = mauvec("facts", ELF, function, "--format", form)
    assert (template.code, template.err) == (0, "")
    if "nothing is missing" in template.out:
        assert mauvec("wcet", ELF, function, *BOARD).code == 0
        return
    assert mauvec("wcet", ELF, function, *BOARD).code == 1
    filled = tmp_path / f"facts.{form}"
    filled.write_text(template.out.replace(" max ?", " max 20"))
    assert mauvec("wcet", ELF, function, *BOARD, "--facts", str(filled)).code == 0
    assert "nothing is missing" in mauvec("facts", ELF, function, "--facts", str(filled)).out


def test_the_template_of_a_list(mauvec: Command) -> None:
    lines = mauvec("facts", ELF, "list_sum").out.splitlines()
    assert lines[0] == "mauve 1"
    assert lines[3] == f'binary "{ELF}" {{'
    assert lines[4:] == ["  // in list_sum", '  loop "data.c:79" max ?  // the loop at 0xafb8', "}"]


def test_a_template_that_is_not_filled_in_is_told(mauvec: Command, tmp_path: Path) -> None:
    template = tmp_path / "facts.mauve"
    template.write_text(mauvec("facts", ELF, "list_sum").out)
    run = mauvec("wcet", ELF, "list_sum", *BOARD, "--facts", str(template))
    assert run.code == 1
    assert "the bound is still a `?`: write how often the loop runs [MV516]" in run.err
    assert "[MV511]" in run.err


def test_loops_are_nested_as_in_the_program() -> None:
    inner = MissingLoop(AtSymbol("scan", 0x24), 0x8024, "a.c:9", None, ())
    outer = MissingLoop(AtLine("a.c", 7), 0x8010, "a.c:7", 12, (inner,))
    missing = (MissingIn("scan", ("main", "parse", "scan"), (outer,), ()),)
    assert format_model("a.elf", missing).splitlines()[4:] == [
        "  // in scan, called by main -> parse",
        "  // the loop at 0x8010: 12 executions of its header",
        '    loop "scan"+0x24 max ?  // the loop at 0x8024, a.c:9',
        "}",
    ]
    assert format_ff("a.elf", missing).splitlines()[3:] == ['  loop "scan"+0x24 max ?;  // the loop at 0x8024, a.c:9']


@pytest.mark.parametrize(("function", "words"), [("recursive_odd", "recursion"), ("spin_forever", "in spin_forever")])
def test_what_is_missing_is_named(mauvec: Command, function: str, words: str) -> None:
    assert words in mauvec("facts", ELF, function).out


def test_no_such_function_and_no_such_file(mauvec: Command) -> None:
    run = mauvec("facts", ELF, "list_summ")
    assert run.code == 1 and "it has `list_sum`" in run.err and "[MV501]" in run.err and run.out == ""
    run = mauvec("facts", "none.elf", "f")
    assert run.code == 1 and "[MV502]" in run.err


def test_facts_of_another_binary_are_refused(mauvec: Command, tmp_path: Path) -> None:
    other = tmp_path / "other.mauve"
    other.write_text('mauve 1\nbinary "other.elf" {\n  loop "a.c:1" max 3\n}\n')
    run = mauvec("wcet", ELF, "sum", *BOARD, "--facts", str(other))
    assert run.code == 1 and "has no flow facts of `arm7tdmi-arm-O0.elf`" in run.err


def test_assumed_ranges_and_targets_of_a_model_reach_the_analysis(mauvec: Command, tmp_path: Path) -> None:
    image = str(FIXTURES.parent / "assumed" / "cortex-m3.elf")
    facts = tmp_path / "facts.mauve"
    facts.write_text(f'mauve 1\nbinary "{image}" {{\n  assume "length" from 0 to 9\n}}\n')
    run = mauvec("wcet", image, "global", "--board", "generic-cortex-m3", "--facts", str(facts), "--format", "json")
    assert run.code == 0 and "`length` is within 0 to 9" in run.out
    facts.write_text(f'mauve 1\nbinary "{image}" {{\n  assume "nowhere" from 0 to 9\n}}\n')
    run = mauvec("wcet", image, "byte", "--board", "generic-cortex-m3", "--facts", str(facts))
    assert run.code == 1 and "there is no object `nowhere` in the binary [MV514]" in run.err


def test_the_template_names_what_a_pointer_may_lead_to(mauvec: Command, tmp_path: Path) -> None:
    elf = str(FIXTURES / "arm7tdmi-arm-O1.elf")
    run = mauvec("facts", elf, "call_through_pointer")
    asked, told = (line.strip() for line in run.out.splitlines() if "targets 0x" in line or "address is taken" in line)
    assert asked.startswith("targets 0x") and " to ?  // " in asked
    names = told.removeprefix("// all whose address is taken: ")
    facts = tmp_path / "facts.mauve"
    facts.write_text(f'mauve 1\nbinary "{elf}" {{\n  {asked.split(" to ?")[0]} to {names}\n}}\n')
    run = mauvec("wcet", elf, "call_through_pointer", "--board", "generic-arm7tdmi", "--facts", str(facts))
    assert "asm_twice" in names and "goes through a pointer" not in run.out + run.err
