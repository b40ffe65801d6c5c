"""Graphs of the fixtures: golden text for the paper's `sum` (figure 2 of seed 001), and every kind of control flow."""

from __future__ import annotations

import random
from pathlib import Path

import pytest

from mauve.wcet.binary.callgraph import build_program, order
from mauve.wcet.binary.cfg import Control, build_cfg
from mauve.wcet.binary.elf import Binary, Symbol, load, load_bytes
from mauve.wcet.binary.graph import Cfg, EdgeKind, UnresolvedKind, format_cfg
from mauve.wcet.binary.loops import loop_nest
from mauve.wcet.binary.split import split_irreducible

FIXTURES = Path(__file__).parent.parent / "fixtures"


def _binary(image: str) -> Binary:
    binary = load(FIXTURES / f"{image}.elf")
    assert isinstance(binary, Binary)
    return binary


def _cfg(image: str, name: str, control: Control | None = None) -> Cfg:
    binary = _binary(image)
    symbol = binary.function(name)
    assert isinstance(symbol, Symbol)
    return build_cfg(binary, symbol.key, control)


def _kinds(cfg: Cfg) -> list[str]:
    return sorted(edge.kind.value for edge in cfg.edges)


SUM_O0 = """\
function sum at 0x8000 (arm), entry b0
b0:
    0x8000: str fp, [sp, #-4]!
    0x8004: add fp, sp, #0
    0x8008: sub sp, sp, #0x14
    0x800c: str r0, [fp, #-0x10]
    0x8010: mov r3, #0
    0x8014: str r3, [fp, #-0xc]
    0x8018: mov r3, #0
    0x801c: str r3, [fp, #-8]
    0x8020: b #0x8050
    -> b2 taken
b1:
    0x8024: ldr r3, [fp, #-8]
    0x8028: lsl r3, r3, #2
    0x802c: ldr r2, [fp, #-0x10]
    0x8030: add r3, r2, r3
    0x8034: ldr r3, [r3]
    0x8038: ldr r2, [fp, #-0xc]
    0x803c: add r3, r2, r3
    0x8040: str r3, [fp, #-0xc]
    0x8044: ldr r3, [fp, #-8]
    0x8048: add r3, r3, #1
    0x804c: str r3, [fp, #-8]
    -> b2 fall
b2:
    0x8050: ldr r3, [fp, #-8]
    0x8054: cmp r3, #0x63
    0x8058: ble #0x8024
    -> b1 taken
    -> b3 fall
b3:
    0x805c: ldr r3, [fp, #-0xc]
    0x8060: mov r0, r3
    0x8064: add sp, fp, #0
    0x8068: pop {fp}
    0x806c: bx lr
    -> exit return"""

SUM_O2 = """\
function sum at 0x802c (arm), entry b0
b0:
    0x802c: mov r2, #0
    0x8030: sub r3, r0, #4
    0x8034: add r0, r0, #0x18c
    -> b1 fall
b1:
    0x8038: ldr r1, [r3, #4]!
    0x803c: cmp r3, r0
    0x8040: add r2, r2, r1
    0x8044: bne #0x8038
    -> b1 taken
    -> b2 fall
b2:
    0x8048: mov r0, r2
    0x804c: bx lr
    -> exit return"""


def test_sum_at_O0_is_figure_2() -> None:
    cfg = _cfg("arm7tdmi-arm-O0", "sum")
    assert format_cfg(cfg) == SUM_O0
    (loop,) = loop_nest(cfg).loops
    assert (loop.header, loop.blocks) == (2, frozenset({1, 2}))


def test_sum_at_O2_is_rotated() -> None:
    assert format_cfg(_cfg("arm7tdmi-arm-O2", "sum")) == SUM_O2


SWITCHES = [
    (image, name)
    for image in ("arm7tdmi-arm-O0", "arm7tdmi-arm-O2", "arm926ej-s-arm-O2", "arm7tdmi-thumb-O2", "cortex-m0-thumb-O2",
                  "cortex-m0-thumb-Os", "cortex-m3-thumb-O2")
    for name in ("switch_dense", "switch_offset", "switch_in_loop", "switch_wide")
]  # fmt: skip


@pytest.mark.parametrize(("image", "name"), SWITCHES)
def test_every_switch_table_is_read(image: str, name: str) -> None:
    cfg = _cfg(image, name)
    assert not cfg.unresolved
    binary = _binary(image)
    ways: dict[int, set[int]] = {}
    for edge in cfg.edges:
        helper = any("thumb1_case" in binary.name_at(key) for key in edge.callees)
        if edge.kind is EdgeKind.SWITCH or helper:
            ways.setdefault(edge.source, set()).add(edge.target)
    assert [len(found) >= 6 for found in ways.values()] == [True]


@pytest.mark.parametrize(
    ("image", "name", "kinds"),
    [
        ("arm7tdmi-arm-O2", "asm_call_mov_lr", ["call", "return"]),
        ("arm7tdmi-arm-O2", "asm_call_mov_pc", ["call", "return"]),
        ("arm7tdmi-arm-O2", "asm_return_pop_bx", ["return"]),
        ("arm7tdmi-arm-O2", "asm_return_mov", ["return"]),
        ("arm7tdmi-arm-O2", "asm_return_bxeq", ["fall", "return", "return"]),
        ("arm7tdmi-arm-O2", "asm_return_popne", ["fall", "return", "return"]),
        ("arm7tdmi-arm-O2", "asm_return_ldmfd", ["return"]),
        ("arm7tdmi-arm-O2", "asm_conditional_call", ["call", "fall", "return"]),
        ("arm7tdmi-arm-O2", "asm_tail_conditional", ["fall", "return", "tail"]),
        ("arm7tdmi-arm-O2", "asm_call_thumb", ["call", "return"]),
        ("arm7tdmi-arm-O2", "asm_undefined_path", ["fall", "return", "stop", "taken"]),
        ("arm7tdmi-arm-O2", "asm_thumb_enters_arm", ["return", "taken"]),
        ("arm7tdmi-arm-O2", "__asm_thumb_triple_from_arm", ["tail"]),
        ("cortex-m3-thumb-O2", "thumb2_it_return", ["fall", "return", "return"]),
        ("cortex-m3-thumb-O2", "thumb2_it_pop", ["fall", "return", "return"]),
        ("cortex-m3-thumb-O2", "tail_call", ["tail"]),
    ],
)
def test_idioms(image: str, name: str, kinds: list[str]) -> None:
    cfg = _cfg(image, name)
    assert not cfg.unresolved
    assert _kinds(cfg) == kinds


def test_a_pointer_call_is_a_hole_until_a_fact_names_its_targets() -> None:
    cfg = _cfg("cortex-m3-thumb-O2", "call_through_pointer")
    (hole,) = cfg.unresolved
    assert hole.kind is UnresolvedKind.CALL and "blx r3" in hole.message and "call_through_pointer" in hole.message
    binary = _binary("cortex-m3-thumb-O2")
    leaf = binary.function("leaf_add")
    assert isinstance(leaf, Symbol)
    told = _cfg("cortex-m3-thumb-O2", "call_through_pointer", Control(targets={hole.address: (leaf.key,)}))
    assert not told.unresolved
    assert [edge.callees for edge in told.edges if edge.kind is EdgeKind.CALL] == [(leaf.key,)]


def test_a_constant_table_of_functions_is_read() -> None:
    cfg = _cfg("cortex-m3-thumb-O2", "call_through_table")
    assert not cfg.unresolved
    assert len([edge for edge in cfg.edges if edge.kind is EdgeKind.TAIL_CALL]) == 4


def test_recursion_is_named_with_its_path() -> None:
    binary = _binary("arm7tdmi-arm-O2")
    symbol = binary.function("recursive_even")
    assert isinstance(symbol, Symbol)
    program = build_program(binary, symbol.key)
    (cycle,) = order(program).cycles
    assert [program[key].name for key in cycle.path] == ["recursive_even", "recursive_odd", "recursive_even"]


def test_callees_come_first() -> None:
    binary = _binary("arm7tdmi-arm-O2")
    symbol = binary.function("call_chain")
    assert isinstance(symbol, Symbol)
    program = build_program(binary, symbol.key)
    names = [program[key].name for key in order(program).functions]
    assert names[-1] == "call_chain" and sorted(names[:-1]) == ["leaf_add", "leaf_max", "leaf_mix", "leaf_sub"]


def test_a_call_that_does_not_return_ends_its_path() -> None:
    binary = _binary("arm7tdmi-arm-O2")
    symbol = binary.function("leaf_add")
    assert isinstance(symbol, Symbol)
    cfg = _cfg("arm7tdmi-arm-O2", "call_chain", Control(no_return=frozenset({symbol.key})))
    assert _kinds(cfg) == ["stop"] and len(cfg.blocks) == 1


@pytest.mark.parametrize("image", ("arm7tdmi-arm-O0", "cortex-m0-thumb-Os"))
def test_splitting_makes_every_function_reducible(image: str) -> None:
    binary = _binary(image)
    split = 0
    for symbol in binary.functions:
        cfg = build_cfg(binary, symbol.key)
        if loop_nest(cfg).irreducible:
            copy = split_irreducible(cfg)
            assert not loop_nest(copy).irreducible
            assert {b.address for b in copy.blocks} == {b.address for b in cfg.blocks}
            split += 1
    assert split >= 1


def test_the_instruction_budget_is_a_located_hole() -> None:
    binary = _binary("arm7tdmi-arm-O2")
    symbol = binary.function("switch_wide")
    assert isinstance(symbol, Symbol)
    cfg = build_cfg(binary, symbol.key, limit=30)
    assert UnresolvedKind.LIMIT in {hole.kind for hole in cfg.unresolved}
    assert sum(len(block.instructions) for block in cfg.blocks) <= 30


@pytest.mark.parametrize("seed", range(3))
def test_damaged_code_gives_graphs_and_holes_in_bounded_time(seed: int) -> None:
    image = ("arm7tdmi-arm-O2", "cortex-m3-thumb-O2", "cortex-m0-thumb-Os")[seed]
    chance = random.Random(seed)
    damaged = bytearray((FIXTURES / f"{image}.elf").read_bytes())
    for _ in range(400):
        damaged[0x1000 + chance.randrange(0x4000)] = chance.randrange(256)
    binary = load_bytes(bytes(damaged), "damaged")
    assert isinstance(binary, Binary)
    cfgs = [split_irreducible(build_cfg(binary, symbol.key)) for symbol in binary.functions]
    assert any(cfg.unresolved for cfg in cfgs)
    assert all(loop_nest(cfg).loops is not None for cfg in cfgs)
