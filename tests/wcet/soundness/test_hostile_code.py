"""Code and symbol tables that no compiler writes; large and deep programs: a bound or a reason, soon."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from emulator import Emulator
from wcet.soundness.machine_code import BX_LR, NOP, START, Symbol, branch, chain, executable, nest
from wcet.soundness.replay import Replay, record

from mauve.wcet.analysis import analyse
from mauve.wcet.binary.elf import Binary, load_bytes
from mauve.wcet.flow.facts import AtAddress, AtLine, AtSymbol, ControlFact, ControlKind, Counting, Fact, LoopFact
from mauve.wcet.flow.program import analyse_program
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import ProblemKind, WcetResult

BOARD = Board("bench", "arm7tdmi", 1_000_000)

STATE_MACHINE = [
    0xE3A0_3000,  # mov r3, #0
    0xE3A0_0000,  # mov r0, #0
    0xE59F_4028,  # ldr r4, =table
    0xE1A0_5004,  # mov r5, r4
    0xE085_6103,  # next: add r6, r5, r3, lsl #2
    0xE596_6000,  # ldr r6, [r6]
    0xE12F_FF16,  # bx r6
    0xE3A0_3001,  # first: mov r3, #1
    0xEAFF_FFFA,  # b next
    0xE280_0001,  # second: add r0, r0, #1
    0xE350_0064,  # cmp r0, #100
    0xA3A0_3002,  # movge r3, #2
    0xEAFF_FFF6,  # b next
    0xE12F_FF1E,  # third: bx lr
    START + 15 * 4,
    START + 7 * 4,  # table: first, second, third
    START + 9 * 4,
    START + 13 * 4,
]


def image(words: list[int], symbols: list[Symbol] | None = None) -> Binary:
    loaded = load_bytes(executable(words, symbols or [("f", START, 0)]), "code.elf")
    assert isinstance(loaded, Binary), loaded
    return loaded


def result(words: list[int], symbols: list[Symbol] | None = None, timeout: float | None = 60.0) -> WcetResult:
    (found,) = analyse(image(words, symbols), ["f"], BOARD, timeout=timeout)
    assert found.bounded or found.problems
    assert all(problem.message for problem in found.problems)
    return found


def test_a_jump_whose_targets_lead_to_further_targets_has_them_all(tmp_path: Path) -> None:
    """The state that selects the target changes behind the targets: each target makes further ones known."""
    path = tmp_path / "machine.elf"
    path.write_bytes(executable(STATE_MACHINE))
    flow = analyse_program(image(STATE_MACHINE), START)
    run = record(Emulator(path, "arm7tdmi"), "f", [])
    replay = Replay(flow, ())
    assert replay.walk(run) is not None
    assert not replay.wrong
    assert run.addresses.count(START + 16) == 102
    found = result(STATE_MACHINE)
    assert found.cycles is None or found.cycles > 100 * 8


def test_a_jump_whose_targets_go_on_changing_has_no_bound() -> None:
    """Eight targets, found one at a time: more rounds than are made."""
    words = [0xE3A0_3000, 0xE59F_5000 | 4 * 4 - 8 + 16 - 4, 0xE085_6103, 0xE596_6000, 0xE12F_FF16, NOP, 0]
    words[1] = 0xE59F_5000 | (6 * 4 - 4 - 8)
    states = 8
    targets = []
    for state in range(1, states):
        targets.append(START + 4 * len(words))
        words += [0xE3A0_3000 | state, branch(len(words) + 1, 2)]
    targets.append(START + 4 * len(words))
    words.append(BX_LR)
    words[6] = START + 4 * len(words)
    words += targets
    found = result(words)
    if found.bounded:
        assert found.cycles is not None and found.cycles >= 8 * (states - 1)
    else:
        assert {problem.kind for problem in found.problems} <= {ProblemKind.BRANCH, ProblemKind.NO_RETURN}


@pytest.mark.parametrize(("depth", "calls"), [(300, 1), (300, 2), (1500, 1)])
def test_deep_chains_of_calls_are_bounded(depth: int, calls: int) -> None:
    """2 ** 300 paths, and more calls in each other than the interpreter of the analysis may nest."""
    words, symbols = chain(depth, calls)
    started = time.process_time()
    found = result(words, symbols)
    assert found.bounded
    assert found.cycles is not None and found.cycles > calls**depth
    assert found.stack == 4 * depth
    assert time.process_time() - started < 20


def test_a_long_straight_function_is_bounded() -> None:
    found = result([NOP] * 20_000 + [BX_LR])
    assert found.cycles == 20_000 + 3


def test_a_deep_nest_ends_in_time() -> None:
    started = time.process_time()
    found = result(nest(12, 3), timeout=5.0)
    assert found.bounded or {p.kind for p in found.problems} <= {ProblemKind.LIMIT, ProblemKind.LOOP}
    assert time.process_time() - started < 10


@pytest.mark.parametrize("depth", [1, 2, 3, 4])
def test_nests_of_loops_are_bounded(depth: int) -> None:
    found = result(nest(depth, 3))
    assert found.bounded
    assert sorted(loop.bound or 0 for loop in found.loops) == [3] * depth


ODD_SYMBOLS: dict[str, list[Symbol]] = {
    "one inside another": [("f", START, 16), ("inner", START + 4, 4), ("other", START + 4, 400)],
    "past the end": [("f", START, 1 << 31), ("far", 0xFFFF_FFF0, 64)],
    "several names": [("f", START, 8), ("g", START, 8), ("h", START, 0)],
    "two of one name": [("f", START, 8), ("f", START + 8, 8)],
    "odd address in A32": [("f", START + 2, 8)],
    "Thumb of A32 code": [("f", START | 1, 8)],
    "nowhere": [("f", 0x1234_5678, 8)],
    "at the last word": [("f", START + 12, 4)],
    "empty name": [("f", START, 8), ("", START + 4, 8)],
}


@pytest.mark.parametrize("symbols", ODD_SYMBOLS.values(), ids=ODD_SYMBOLS.keys())
def test_odd_symbols_do_no_harm(symbols: list[Symbol]) -> None:
    result([NOP, NOP, branch(2, 3, condition=1), BX_LR], symbols)


ODD_CODE = {
    "runs off the end": [NOP, NOP],
    "endless": [branch(0, 0)],
    "jumps outside": [branch(0, 1000)],
    "data in the way": [NOP, 0xFFFF_FFFF, BX_LR],
    "zeros": [0, 0, 0, 0],
    "calls itself": [branch(0, 0, link=True), BX_LR],
    "jumps through what it computes": [0xE080_F001],
    "jumps into a literal": [0xE59F_F000, NOP, START + 8],
    "writes its stack pointer": [0xE1A0_D000, 0xE49D_F004],
    "conditional end": [0x012F_FF1E],
    "changes the state": [0xE28F_0001, 0xE12F_FF10, 0x4770_4770],
    "swi": [0xEF00_0000, BX_LR],
    "coprocessor": [0xEE11_0F10, BX_LR],
    "loads all and the counter": [0xE8BD_FFFF],
    "status": [0xE129_F000, BX_LR],
}


@pytest.mark.parametrize("words", ODD_CODE.values(), ids=ODD_CODE.keys())
def test_odd_code_has_a_reason(words: list[int]) -> None:
    found = result(words)
    assert found.cycles is None or found.cycles > 0


ENDS = {
    "runs off the end",
    "endless",
    "jumps outside",
    "data in the way",
    "calls itself",
    "jumps through what it computes",
}


@pytest.mark.parametrize("name", sorted(ENDS))
def test_code_that_does_not_return_has_no_bound(name: str) -> None:
    found = result(ODD_CODE[name])
    assert not found.bounded
    assert found.problems[0].address is not None


LOOP = [0xE3A0_000A, 0xE250_0001, branch(2, 1, condition=1), BX_LR]
"""Ten times round."""

FACTS: dict[str, Fact] = {
    "zero": LoopFact(AtAddress(START + 4), 0, Counting.HEADER),
    "negative": LoopFact(AtAddress(START + 4), -3, Counting.HEADER),
    "huge": LoopFact(AtAddress(START + 4), 1 << 70, Counting.BACK),
    "only a total": LoopFact(AtAddress(START + 4), None, Counting.HEADER, 11),
    "total below the maximum": LoopFact(AtAddress(START + 4), 12, Counting.HEADER, 2),
    "neither": LoopFact(AtAddress(START + 4), None, Counting.BODY),
    "nowhere": LoopFact(AtAddress(0xFFFF_FFFF), 5, Counting.BODY),
    "no symbol": LoopFact(AtSymbol("nothing", 1 << 40), 5, Counting.BODY),
    "no line": LoopFact(AtLine("nothing.c", -1), 5, Counting.BODY),
    "targets of a plain instruction": ControlFact(ControlKind.TARGETS, AtAddress(START), (AtAddress(START),)),
    "targets outside": ControlFact(ControlKind.TARGETS, AtAddress(START + 12), (AtAddress(0x1000_0000),)),
    "no targets": ControlFact(ControlKind.TARGETS, AtAddress(START + 12)),
    "itself does not return": ControlFact(ControlKind.NO_RETURN, AtSymbol("f")),
    "no call here": ControlFact(ControlKind.NO_CALL, AtAddress(START + 4)),
    "returns": ControlFact(ControlKind.RETURN, AtSymbol("nothing")),
}


@pytest.mark.parametrize("fact", FACTS.values(), ids=FACTS.keys())
def test_odd_facts_never_lower_a_proven_bound_in_silence(fact: Fact) -> None:
    """A fact below what is proven either is told of or changes nothing."""
    (plain,), (found,) = (analyse(image(LOOP), ["f"], BOARD, facts) for facts in ((), (fact,)))
    assert plain.cycles is not None
    if found.cycles is None or found.cycles < plain.cycles:
        assert (
            found.problems or found.notes or "annotation" in {loop.origin.value for loop in found.loops if loop.origin}
        )


@pytest.mark.parametrize("timeout", [0.0, -1.0, 1e-9])
def test_no_time_is_a_reason(timeout: float) -> None:
    found = result(LOOP, timeout=timeout)
    assert found.bounded or found.problems[0].kind is ProblemKind.LIMIT
