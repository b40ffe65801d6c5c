"""No executed address lies outside the graph: functions of the fixtures run in the emulator with many arguments, and every
instruction that was executed is in the graphs of what the function reaches, entered and left along an edge of them."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from emulator import EmulationError, Emulator

from mauve.wcet.binary.callgraph import build_program
from mauve.wcet.binary.elf import Bind, Binary, load
from mauve.wcet.binary.graph import EXIT

FIXTURES = Path(__file__).parent.parent / "fixtures"
IMAGES = {
    "arm7tdmi-arm-O0": "arm7tdmi",
    "arm7tdmi-arm-O2": "arm7tdmi",
    "arm7tdmi-thumb-O2": "arm7tdmi",
    "arm926ej-s-arm-O2": "arm926ej-s",
    "cortex-m0-thumb-Os": "cortex-m0",
    "cortex-m0-thumb-O2": "cortex-m0",
    "cortex-m3-thumb-O2": "cortex-m3",
}
ENDLESS = {"_start", "spin_forever", "wait_for_flag", "call_through_pointer", "tail_call_through_pointer"}


@pytest.mark.parametrize("image", IMAGES)
def test_executed_addresses_are_in_the_graph(image: str) -> None:
    path = FIXTURES / f"{image}.elf"
    binary = load(path)
    assert isinstance(binary, Binary)
    emulator = Emulator(path, IMAGES[image])
    chance = random.Random(7)
    compared = 0
    for symbol in binary.functions:
        if symbol.bind is not Bind.GLOBAL or symbol.name in ENDLESS or symbol.name.startswith("__"):
            continue
        program = build_program(binary, symbol.key)
        if any(cfg.unresolved for cfg in program.values()):
            continue
        blocks = {b.address: b for cfg in program.values() for b in cfg.blocks}
        inside = {i.address for b in blocks.values() for i in b.instructions}
        for number in range(6):
            emulator.reset()
            arguments = [_argument(emulator, chance, number) for _ in range(4)]
            try:
                run = emulator.call(symbol.name, arguments, max_instructions=20_000, trace=True)
            except EmulationError:
                continue
            outside = sorted(set(run.counts) - inside)
            assert not outside, f"{symbol.name}: {[hex(a) for a in outside[:4]]} executed but not in the graph"
            compared += 1
    assert compared > 300


def _argument(emulator: Emulator, chance: random.Random, number: int) -> int:
    """Mostly a pointer to an object that can be read and written, else a small number."""
    if number % 2:
        return chance.randrange(12)
    return emulator.alloc(bytes(chance.randrange(32) for _ in range(1024)))


@pytest.mark.parametrize("image", IMAGES)
def test_graphs_keep_their_invariants(image: str) -> None:
    binary = load(FIXTURES / f"{image}.elf")
    assert isinstance(binary, Binary)
    for symbol in binary.functions:
        for cfg in build_program(binary, symbol.key).values():
            assert cfg.blocks[cfg.entry].address == cfg.address
            assert [b.id for b in cfg.blocks] == list(range(len(cfg.blocks)))
            addresses = [i.address for b in cfg.blocks for i in b.instructions]
            assert addresses == sorted(set(addresses)), cfg.name
            targets = {e.target for e in cfg.edges} - {EXIT}
            assert targets | {cfg.entry} == set(range(len(cfg.blocks))), cfg.name
            assert {e.source for e in cfg.edges} == set(range(len(cfg.blocks))), cfg.name
            for edge in cfg.edges:
                assert all(callee in build_keys(binary, callee) for callee in edge.callees)


def build_keys(binary: Binary, callee: int) -> set[int]:
    """A callee is code of this binary."""
    return {callee} if binary.read_code(callee & ~1, 2) is not None else set()
