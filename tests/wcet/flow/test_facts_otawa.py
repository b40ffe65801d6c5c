"""OTAWA's flow fact files: every statement is understood, remarked on or a located problem, never an exception."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mauve.wcet.flow.facts import AtAddress, AtLine, AtSymbol, ControlFact, ControlKind, Counting, LoopFact
from mauve.wcet.flow.otawa import parse_facts


def test_loop_addresses_and_numbers() -> None:
    read = parse_facts(
        'loop 0x8018 max 10 total 0x64 min 3; # ok\nloop "f" + 0x10 max 010;\nloop "a/b.c":12 max 7;', "x.ff"
    )
    assert read.problems == ()
    assert read.facts == (
        LoopFact(AtAddress(0x8018), 10, Counting.BACK, 100, "x.ff:1", 0),
        LoopFact(AtSymbol("f", 16), 8, Counting.BACK, None, "x.ff:2", 1),
        LoopFact(AtLine("a/b.c", 12), 7, Counting.BACK, None, "x.ff:3", 2),
    )


def test_control_statements() -> None:
    read = parse_facts(
        'noreturn "exit"; return 4; nocall "f" - 2; multibranch 8 to 16, "g"; multicall 12 to "h";', "x.ff"
    )
    assert [f.kind for f in read.facts if isinstance(f, ControlFact)] == [
        ControlKind.NO_RETURN,
        ControlKind.RETURN,
        ControlKind.NO_CALL,
        ControlKind.TARGETS,
        ControlKind.TARGETS,
    ]
    assert read.facts[3].targets == (AtAddress(16), AtSymbol("g"))


def test_statements_without_influence_are_notes() -> None:
    text = """checksum "a.elf" 0x12; noblock 1; doinline 2; noinline 3; force branch 4; force call 5; ignorecontrol 6;
    ignore entry "f"; preserve 7; memory access 8 : 1 .. 2; memory 9 : RAM; register sp = 0x100; loop 3 max ?;
    loop 4 max 2 in "main" / "f"; multibranch 5 to ?;"""
    read = parse_facts(text, "x.ff")
    assert read.facts == ()
    assert len(read.problems) == 15
    assert not any(problem.is_error for problem in read.problems)


def test_problems_are_located_and_reading_goes_on() -> None:
    read = parse_facts('loop 1 max 2;\n  frobnicate 3;\nloop "x max 3;\nloop 5 max 6\nnoreturn 7;', "x.ff")
    assert [(p.line, p.column) for p in read.problems if p.is_error] == [(2, 3), (3, 6), (5, 1)]
    assert [f.place for f in read.facts] == [AtAddress(1), AtAddress(7)]


@given(st.text(alphabet='loop max"0x1;:+?,/*# \nnreturn', max_size=80))
def test_never_an_exception(text: str) -> None:
    read = parse_facts(text, "x.ff")
    lines = text.count("\n") + 1
    assert all(1 <= problem.line <= lines and problem.column >= 1 for problem in read.problems)
