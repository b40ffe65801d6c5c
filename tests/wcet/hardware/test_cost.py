"""Costs of instructions, blocks and edges, against the manuals' figures."""

from __future__ import annotations

from dataclasses import dataclass, replace

import pytest

from mauve.wcet.binary.graph import EXIT, EdgeKind
from mauve.wcet.hardware.board import Board, Memory
from mauve.wcet.hardware.cost import board_problems, edge_costs, return_waits
from mauve.wcet.result import ProblemKind
from tests.wcet.hardware.code import BASE, board, core, cost, graph

FALL, TAKEN, CALL, RETURN = EdgeKind.FALL, EdgeKind.TAKEN, EdgeKind.CALL, EdgeKind.RETURN

ADD = 0xE0810002  # add r0, r1, r2
USE = 0xE0844000  # add r4, r4, r0
NOP = 0xE1A00000  # mov r0, r0
NOP5 = 0xE1A05005  # mov r5, r5
BX_LR = 0xE12FFF1E


@pytest.mark.parametrize(
    ("text", "word", "arm7", "arm9", "arm9e"),
    [
        ("add r0, r1, r2", ADD, 1, 1, 1),
        ("add r0, r1, r2, lsl r3", 0xE0810312, 2, 2, 2),
        ("mov pc, lr", 0xE1A0F00E, 3, 3, 4),
        ("add pc, pc, r0, lsl #2", 0xE08FF100, 3, 3, 4),
        ("add pc, pc, r0", 0xE08FF000, 3, 3, 3),
        ("ldr r0, [r1]", 0xE5910000, 3, 1, 1),
        ("ldrb r0, [r1]", 0xE5D10000, 3, 1, 1),
        ("ldrh r0, [r1]", 0xE1D100B0, 3, 1, 1),
        ("ldrsb r0, [r1]", 0xE1D100D0, 3, 1, 1),
        ("ldr r0, [r1, r2, lsl #2]", 0xE7910102, 3, 1, 2),
        ("ldrb r0, [r1, r2, lsl #2]", 0xE7D10102, 3, 1, 2),
        ("ldr pc, [r1]", 0xE591F000, 5, 5, 5),
        ("str r0, [r1]", 0xE5810000, 2, 1, 1),
        ("strh r0, [r1]", 0xE1C100B0, 2, 1, 1),
        ("str r0, [r1, r2, lsl #2]", 0xE7810102, 2, 1, 2),
        ("ldm r0, {r1, r2, r3}", 0xE890000E, 5, 3, 3),
        ("ldm r0, {r1}", 0xE8900002, 3, 2, 2),
        ("pop {r4, r5, pc}", 0xE8BD8030, 7, 7, 7),
        ("push {r4, r5, lr}", 0xE92D4030, 4, 3, 3),
        ("stm r0, {r1, r2, r3}", 0xE880000E, 4, 3, 3),
        ("swp r0, r1, [r2]", 0xE1020091, 4, 2, 2),
        ("mul r0, r1, r2", 0xE0000291, 5, 6, 2),
        ("muls r0, r1, r2", 0xE0100291, 5, 6, 4),
        ("mla r0, r1, r2, r3", 0xE0203291, 6, 6, 2),
        ("umull r0, r1, r2, r3", 0xE0810392, 6, 7, 3),
        ("smlal r0, r1, r2, r3", 0xE0E10392, 7, 7, 3),
        ("clz r0, r1", 0xE16F0F11, None, None, 1),
        ("smulbb r0, r1, r2", 0xE1600281, None, None, 1),
        ("qadd r0, r1, r2", 0xE1020051, None, None, 1),
        ("ldrd r0, [r2]", 0xE1C200D0, None, None, 2),
        ("bx lr", BX_LR, 3, 3, 3),
        ("blx r3", 0xE12FFF33, None, None, 3),
        ("cmp r0, #1", 0xE3500001, 1, 1, 1),
        ("mrs r0, cpsr", 0xE10F0000, 1, 1, 2),
        ("msr cpsr_f, r0", 0xE128F000, 1, 1, 1),
    ],
)
def test_single_instructions(text: str, word: int, arm7: int | None, arm9: int | None, arm9e: int) -> None:
    for name, expected in (("arm7tdmi", arm7), ("arm920t", arm9), ("arm926ej-s", arm9e)):
        if expected is None:
            cfg = graph([[word]], [(0, EXIT, RETURN)])
            problems = edge_costs(cfg, core(name), board(), {}).problems
            assert [problem.kind for problem in problems] == [ProblemKind.HARDWARE]
            assert problems[0].address == BASE
        else:
            assert cost(name, [word]) == expected, (text, name)


@pytest.mark.parametrize(
    ("what", "words", "arm9", "arm9e"),
    [
        ("a loaded word is used at once", [0xE5910000, USE], 3, 3),
        ("a loaded word is used one instruction later", [0xE5910000, NOP5, USE], 3, 3),
        ("a loaded byte is used at once", [0xE5D10000, USE], 4, 4),
        ("a loaded byte is used one instruction later", [0xE5D10000, NOP5, USE], 4, 4),
        ("a loaded byte is used two instructions later", [0xE5D10000, NOP5, NOP5, USE], 4, 4),
        ("the second use of a loaded byte does not wait again", [0xE5D10000, USE, USE], 5, 5),
        ("a loaded byte is stored at once: no forwarding to store data", [0xE5D10000, 0xE5820000], 4, 3),
        ("a loaded byte is stored one instruction later", [0xE5D10000, NOP5, 0xE5820000], 4, 3),
        ("the last register of a multiple load is used at once", [0xE890000E, 0xE0844003], 5, 5),
        ("another register of a multiple load is used at once", [0xE890000E, 0xE0844002], 4, 4),
        ("a base register that was just loaded", [0xE5910000, 0xE8900006], 4, 4),
        ("a product is used at once", [0xE0000291, USE], 7, 4),
        ("a product is accumulated at once: forwarded", [0xE0000291, 0xE0240291], 12, 4),
        ("a product is stored at once: forwarded", [0xE0000291, 0xE5820000], 7, 3),
        ("a loaded value is overwritten, not used", [0xE5910000, 0xE3A00001, USE], 3, 3),
    ],
)
def test_interlocks(what: str, words: list[int], arm9: int, arm9e: int) -> None:
    assert cost("arm920t", words) == arm9, what
    assert cost("arm926ej-s", words) == arm9e, what
    assert cost("arm7tdmi", words) == sum(cost("arm7tdmi", [word]) for word in words), "no state on this core"


def test_a_late_result_is_waited_for_in_the_next_block() -> None:
    # ldrb r0, [r1]; beq L  |  add r4, r4, r0  |  L: bx lr
    blocks = [[0xE5D10000, 0x0A000000], [USE], [BX_LR]]
    cfg = graph(blocks, [(0, 1, FALL), (0, 2, TAKEN), (1, 2, FALL), (2, EXIT, RETURN)])
    costs = edge_costs(cfg, core("arm926ej-s"), board(), {})
    # The branch that is not taken takes one of the two cycles; the addition waits for the other.
    assert costs.cycles == (2, 4, 2, 3)


def test_the_worst_way_into_a_block_counts() -> None:
    # ldrb on one way, nothing on the other; both fall or jump to the use.
    blocks = [[0x0A000001], [NOP5, 0xE5D10000], [USE, BX_LR]]
    cfg = graph(blocks, [(0, 1, FALL), (0, 2, TAKEN), (1, 2, FALL), (2, EXIT, RETURN)])
    assert edge_costs(cfg, core("arm926ej-s"), board(), {}).cycles == (1, 3, 2, 2 + 1 + 3)


def test_loops_carry_results_round_to_their_header() -> None:
    # header: add r4, r4, r0; body: ldrb r0, [r1] falls into the header again by layout of edges
    blocks = [[USE, 0x0A000001], [0xE5D10000], [BX_LR]]
    cfg = graph(blocks, [(0, 1, FALL), (0, 2, TAKEN), (1, 0, FALL), (2, EXIT, RETURN)])
    assert edge_costs(cfg, core("arm926ej-s"), board(), {}).cycles == (2 + 1 + 1, 2 + 1 + 3, 1, 3)


@dataclass(frozen=True)
class Conditional:
    what: str
    words: list[int]
    taken: int
    fall: int


@pytest.mark.parametrize(
    "case",
    [
        Conditional("branch alone", [0x0A000000], 3, 1),
        # moveq r0, #1 with a multiply's cost: muleq r0, r1, r2; beq
        Conditional("an instruction with the branch's condition", [0x00000291, 0x0A000000], 5 + 3, 1 + 1),
        Conditional("an instruction with the opposite condition", [0x10000291, 0x0A000000], 1 + 3, 5 + 1),
        Conditional("the flags change between", [0x00000291, 0xE3500001, 0x0A000000], 5 + 1 + 3, 5 + 1 + 1),
        Conditional("two that exclude each other", [0x00000291, 0x10000291, 0xE3500001, 0x0A000000], 10, 8),
        Conditional("greater implies not equal", [0xC0000291, 0x0A000000], 1 + 3, 5 + 1),
        Conditional("two that go together", [0x00000291, 0x00000291, 0xE3500001, 0x0A000000], 14, 12),
    ],
    ids=lambda case: case.what,
)
def test_conditional_execution(case: Conditional) -> None:
    cfg = graph([case.words, [BX_LR]], [(0, 1, TAKEN), (0, 1, FALL), (1, EXIT, RETURN)])
    assert edge_costs(cfg, core("arm7tdmi"), board(), {}).cycles[:2] == (case.taken, case.fall)


def test_conditional_return_and_conditional_call() -> None:
    # bxeq lr  |  blne callee
    edges = [(0, EXIT, RETURN), (0, 1, FALL), (1, EXIT, EdgeKind.TAIL_CALL), (1, EXIT, FALL)]
    cfg = graph([[0x012FFF1E], [0x1B000000]], edges)
    assert edge_costs(cfg, core("arm7tdmi"), board(), {}).cycles == (3, 1, 3, 1)


@dataclass(frozen=True)
class Range:
    low: int
    high: int


FLASH = Memory("flash", 0x0, 0x10000, 2)
RAM = Memory("ram", 0x40000, 0x1000, 0)
SLOW = Memory("slow", 0x80000, 0x1000, 5, 7)


def waits(name: str, word: int, place: Range | None, memories: tuple[Memory, ...] = (FLASH, RAM, SLOW)) -> int:
    """Cycles of one instruction above those of the board without memories."""
    cfg = graph([[word]], [(0, EXIT, FALL)])
    loads = [i for i, op in enumerate(cfg.blocks[0].instructions[0].ops) if type(op).__name__ in ("Load", "Store")]
    accesses = {} if place is None else {(BASE, index): place for index in loads}
    with_waits = edge_costs(cfg, core(name), board(*memories), accesses)
    assert with_waits.problems == ()
    return with_waits.cycles[0] - edge_costs(cfg, core(name), board(), {}).cycles[0]


@pytest.mark.parametrize("name", ["arm7tdmi", "arm920t", "arm926ej-s"])
def test_wait_states_per_region(name: str) -> None:
    assert waits(name, ADD, None) == 2
    assert waits(name, 0xE5910000, Range(0x40010, 0x40013)) == 2 + 0
    assert waits(name, 0xE5910000, Range(0x80010, 0x80013)) == 2 + 5
    assert waits(name, 0xE5910000, Range(0x40010, 0x80013)) == 2 + 5, "the slowest memory it may touch"
    assert waits(name, 0xE5910000, None) == 2 + 5, "an unknown address"
    assert waits(name, 0xE5810000, Range(0x80010, 0x80013)) == 2 + 7, "stores may wait longer"
    assert waits(name, 0xE890000E, Range(0x80010, 0x8001B)) == 2 + 3 * 5, "every word of a multiple load"


def test_waits_of_a_branch_on_one_bus_fall_on_its_target() -> None:
    cfg = graph([[0xEA000000], [BX_LR]], [(0, 1, TAKEN), (1, EXIT, RETURN)])
    fast_and_slow = (Memory("fast", 0x0, BASE + 4, 0), Memory("slow", BASE + 4, 0x1000, 4))
    seven = edge_costs(cfg, core("arm7tdmi"), board(*fast_and_slow), {})
    # The fetch behind the branch and two at its target; the return's own fetch (its target is the caller's matter).
    assert seven.cycles == (3 + 4 + 2 * 4, 3 + 4)
    assert return_waits(core("arm7tdmi"), board(*fast_and_slow)) == 2 * 4


def test_a_call_pays_for_the_fetches_at_its_callee_and_of_the_return() -> None:
    cfg = graph([[0xEB000000], [BX_LR]], [(0, 1, CALL), (1, EXIT, RETURN)])
    call = replace(cfg.edges[0], callees=(0x80000,))
    cfg = replace(cfg, edges=(call, cfg.edges[1]))
    assert edge_costs(cfg, core("arm7tdmi"), board(FLASH, SLOW), {}).cycles[0] == 3 + 2 + 2 * 5 + 2 * 2


def test_code_outside_the_memories_is_a_problem() -> None:
    cfg = graph([[ADD, BX_LR]], [(0, EXIT, RETURN)])
    problems = edge_costs(cfg, core("arm7tdmi"), board(RAM), {}).problems
    assert [(p.kind, p.address, p.message) for p in problems] == [
        (ProblemKind.OUTSIDE, BASE, "the code of f at 0x8000 is in no memory of the board")
    ]


def test_an_access_that_no_memory_holds_is_a_problem() -> None:
    cfg = graph([[0xE5910000, BX_LR]], [(0, EXIT, RETURN)])
    problems = edge_costs(cfg, core("arm7tdmi"), board(FLASH), {(BASE, 0): Range(0x10100000, 0x10100003)}).problems
    assert [(p.kind, p.address) for p in problems] == [(ProblemKind.HARDWARE, BASE)]
    assert problems[0].message == "ldr r0, [r1]: no memory of the board holds 0x10100000"


def test_infeasible_code_costs_nothing_and_needs_no_timing() -> None:
    # clz, which this core does not have, behind an edge that is never taken
    cfg = graph([[0x0A000000], [0xE16F0F11], [BX_LR]], [(0, 2, TAKEN), (0, 1, FALL), (1, 2, FALL), (2, EXIT, RETURN)])
    costs = edge_costs(cfg, core("arm7tdmi"), board(), {}, frozenset({1}))
    assert costs.problems == ()
    assert costs.cycles == (3, 0, 0, 3)


def test_declared_features_and_unknown_cores_are_problems() -> None:
    fancy = Board("fancy", "arm926ej-s", 1, (), ("icache 16KiB 4-way", "mmu"))
    assert [p.message for p in board_problems(fancy, core("arm926ej-s"))] == [
        "icache 16KiB 4-way is declared by the board fancy and not modelled",
        "mmu is declared by the board fancy and not modelled",
    ]
    assert [p.kind for p in board_problems(Board("odd", "pdp-11", 1), None)] == [ProblemKind.HARDWARE]


def test_wait_states_need_a_compositional_core() -> None:
    slow = Board("m3", "cortex-m3", 1, (FLASH,))
    assert len(board_problems(slow, core("cortex-m3"))) == 1
    assert board_problems(Board("m3", "cortex-m3", 1), core("cortex-m3")) == ()
    assert board_problems(Board("m0", "cortex-m0", 1, (FLASH,)), core("cortex-m0")) == ()


def test_falling_into_the_next_function_does_not_take_the_branch() -> None:
    """muleq r0, r1, r2; bne back: on the way past the branch the multiply has executed."""
    cfg = graph([[0x00000291, 0x1A000000]], [(0, EXIT, TAKEN), (0, EXIT, EdgeKind.TAIL_CALL)])
    behind = replace(cfg.edges[1], callees=(BASE + 8,))
    cfg = replace(cfg, edges=(cfg.edges[0], behind))
    assert edge_costs(cfg, core("arm7tdmi"), board(), {}).cycles == (1 + 3, 5 + 1)


def test_a_skipped_call_still_costs_its_branch() -> None:
    cfg = graph([[0x0B000000]], [(0, EXIT, FALL)])
    assert edge_costs(cfg, core("arm7tdmi"), board(), {}).cycles == (3,)


def test_results_that_are_late_when_code_falls_into_the_next_function() -> None:
    cfg = graph([[0xE5D10000]], [(0, EXIT, EdgeKind.TAIL_CALL)])
    cfg = replace(cfg, edges=(replace(cfg.edges[0], callees=(BASE + 4,)),))
    assert edge_costs(cfg, core("arm926ej-s"), board(), {}).cycles == (1 + 2,)
    # a branch in between hides them
    cfg = graph([[0xE5D10000, 0xEA000000]], [(0, EXIT, EdgeKind.TAIL_CALL)])
    cfg = replace(cfg, edges=(replace(cfg.edges[0], callees=(BASE + 0x100,)),))
    assert edge_costs(cfg, core("arm926ej-s"), board(), {}).cycles == (1 + 3,)


def test_a_preload_waits_for_the_slowest_memory() -> None:
    assert waits("arm926ej-s", 0xF5D1F000, None) == 2 + 7
