"""Switches whose table is found through a constant that was kept somewhere, and those without a check."""

from __future__ import annotations

from dataclasses import replace

import pytest
from wcet.soundness.machine_code import START, branch, executable

from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.elf import Binary, Content, load_bytes
from mauve.wcet.binary.graph import Cfg, EdgeKind, UnresolvedKind
from mauve.wcet.flow.program import analyse_program
from mauve.wcet.result import ProblemKind

HEAD = [
    0xE92D_4010,  # push {r4, lr}
    0xE24D_D010,  # sub sp, sp, #16
    0xE59F_3038,  # ldr r3, =table
    0xE58D_3004,  # str r3, [sp, #4]
    0xE1A0_4000,  # mov r4, r0
]
DISPATCH = [
    0xE354_0003,  # cmp r4, #3
    0x8A00_0006,  # bhi out
    0xE59D_2004,  # ldr r2, [sp, #4]
    0xE792_3104,  # ldr r3, [r2, r4, lsl #2]
    0xE12F_FF13,  # bx r3
]
CASES = [
    0xE244_4001,  # sub r4, r4, #1
    0xEAFF_FFF6,  # b loop
    0xE244_4002,  # sub r4, r4, #2
    0xEAFF_FFF4,  # b loop
    0xE28D_D010,  # out: add sp, sp, #16
    0xE8BD_8010,  # pop {r4, pc}
]
FIRST, SECOND, OUT = START + 0x30, START + 0x38, START + 0x40
TABLE = [START + 0x4C, FIRST, SECOND, FIRST, OUT]


def _cfg(words: list[int]) -> Cfg:
    binary = load_bytes(executable(words), "f.elf")
    assert isinstance(binary, Binary), binary
    return build_cfg(binary, START)


def _switched(cfg: Cfg) -> set[int]:
    return {cfg.blocks[edge.target].address for edge in cfg.edges if edge.kind is EdgeKind.SWITCH}


@pytest.mark.parametrize(
    ("stores", "is_known"),
    [
        ((0xE28D_0008, 0xE580_4000), True),  # add r0, sp, #8; str r4, [r0]: next to it
        ((0xE28D_0008, 0xE584_0000), True),  # add r0, sp, #8; str r0, [r4]: what is above may change
        ((0xE28D_0004, 0xE584_0000), False),  # add r0, sp, #4; str r0, [r4]: somebody knows its address
        ((0xE28D_0004, 0xE580_4000), False),  # add r0, sp, #4; str r4, [r0]: it is overwritten
        ((0xE28D_0003, 0xE5C0_4002), False),  # add r0, sp, #3; strb r4, [r0, #2]: a byte of it is
        ((0xE1A0_0000, 0xE584_4000), True),  # str r4, [r4]: nobody knows the frame
        ((0xE08D_0004, 0xE580_4000), False),  # add r0, sp, r4; str r4, [r0]
    ],
)
def test_the_base_of_a_table_may_wait_in_the_frame(stores: tuple[int, int], is_known: bool) -> None:
    cfg = _cfg([*HEAD, *stores, *DISPATCH, *CASES, *TABLE])
    assert bool(cfg.unresolved) is not is_known
    assert _switched(cfg) == ({FIRST, SECOND, OUT} if is_known else set())


def test_a_register_that_another_path_changes_is_not_constant() -> None:
    other = list(CASES)
    other[2] = 0xE58D_4004  # str r4, [sp, #4]: the second case moves the table
    cfg = _cfg([*HEAD, 0xE1A0_0000, 0xE1A0_0000, *DISPATCH, *other, *TABLE])
    assert cfg.unresolved


def test_a_byte_that_is_not_checked_reads_the_table_behind_the_jump() -> None:
    """and r0, r0, #255; ldr pc, [pc, r0, lsl #2]: four words, then the first code that they lead to."""
    code = [START + 4 * place for place in (7, 8, 7, 8)]
    cfg = _cfg([0xE200_00FF, 0xE79F_F100, 0xE1A0_0000, *code, 0xE12F_FF1E, 0xE12F_FF1E])
    assert not cfg.unresolved and _switched(cfg) == {START + 28, START + 32}


def test_a_signed_byte_that_is_checked_as_an_unsigned_one() -> None:
    """ldrsb r3, [r0]; and r2, r3, #255 (or lsl, lsr); cmp r2, #1; bxhi lr; add r1, pc, #4; ldr pc, [r1, r3, lsl #2]."""
    jump = [0xE352_0001, 0x812F_FF1E, 0xE28F_1004, 0xE791_F103, 0xE12F_FF1E]
    start = START + 4 * 7
    table = [start + 8, start + 12]
    cfg = _cfg([0xE1D0_30D0, 0xE6EF_2073, *jump, *table, 0xE12F_FF1E, 0xE12F_FF1E])
    assert not cfg.unresolved and _switched(cfg) == set(table)


def test_a_register_keeps_its_constant_past_a_conditional_return() -> None:
    """ldr r4, =table; push {r4, lr}; popls {r4, pc}: where it does not return, r4 is as it was."""
    head = [0xE59F_4024, 0xE92D_4010, 0xE350_0000, 0x98BD_8010, 0xE200_0003, 0xE794_3100, 0xE12F_FF13]
    cases = [0xE8BD_8010] * 3
    table = [START + 4 * place for place in (7, 8, 9, 7)]
    cfg = _cfg([*head, *cases, 0, START + 48, *table])
    assert not cfg.unresolved and _switched(cfg) == set(table)


def test_a_table_ends_where_its_entries_leave_the_function() -> None:
    """ldr r2, =table; ldrb r3, [r0]; ldr r3, [r2, r3, lsl #2]; bx r3: a computed goto."""
    code = [0xE59F_2010, 0xE5D0_3000, 0xE792_3103, 0xE12F_FF13, 0xE12F_FF1E, 0xE12F_FF1E]
    table = [START + 16, START + 20, START + 16]
    words = [*code, START + 28, *table, 0, START + 4]
    binary = load_bytes(executable(words, [("f", START, 24)]), "f.elf")
    assert isinstance(binary, Binary)
    cfg = build_cfg(binary, START)
    assert not cfg.unresolved and _switched(cfg) == {START + 16, START + 20}


@pytest.mark.parametrize("has_frame", [True, False])
def test_a_pointer_from_memory_leads_to_labels_whose_address_is_taken(has_frame: bool) -> None:
    """ldr r3, [r0]; bx r3: where there is a frame still, no function is called that way; else it may be one."""
    enter, leave = (0xE92D_4010, 0xE8BD_8010) if has_frame else (0xE1A0_0000, 0xE12F_FF1E)
    words = [enter, 0xE590_3000, 0xE12F_FF13, leave, 0xE280_0004, branch(5, 1), START + 12, START + 16]
    found = load_bytes(executable(words, [("f", START, 24)]), "f.elf")
    assert isinstance(found, Binary)
    marks = ((START, Content.ARM), (START + 24, Content.DATA))
    binary = replace(found, mapping=marks, _marks=tuple(at for at, _ in marks))
    cfg = build_cfg(binary, START)
    assert _switched(cfg) == {START + 12, START + 16}
    assert [hole.kind for hole in cfg.unresolved] == ([] if has_frame else [UnresolvedKind.BRANCH])


def test_a_jump_to_what_memory_holds_decides_by_what_is_not_known() -> None:
    """loop: ldr r3, [r0]; bx r3, with labels that go on or return: nothing bounds the loop."""
    words = [0xE92D_4010, 0xE590_3000, 0xE12F_FF13, 0xE8BD_8010, branch(4, 1), START + 12, START + 16]
    found = load_bytes(executable(words, [("f", START, 20)]), "f.elf")
    assert isinstance(found, Binary)
    marks = ((START, Content.ARM), (START + 20, Content.DATA))
    binary = replace(found, mapping=marks, _marks=tuple(at for at, _ in marks))
    program = analyse_program(binary, START)
    (flow,) = program.functions.values()
    assert len(flow.nest.loops) == 1 and not flow.cfg.unresolved
    assert not flow.bounds and flow.problems[0].kind is ProblemKind.LOOP


def test_an_index_goes_up_by_one() -> None:
    """and r0, r0, #255; clz r3, r0; rsb r3, r3, #32; ldr pc, [pc, r3, lsl #2]: 0, 1, 2, 2 for r0 = 0 to 3 is no
    index, the result of rsb is."""
    code = [0xE200_00FF, 0xE16F_3F10, 0xE263_3020, 0xE79F_F103, 0xE1A0_0000]
    table = [START + 4 * place for place in (10, 11, 12, 13, 14)]
    cfg = _cfg([*code, *table, *[0xE12F_FF1E] * 5])
    assert not cfg.unresolved and _switched(cfg) == set(table)
