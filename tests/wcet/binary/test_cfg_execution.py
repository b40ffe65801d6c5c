"""No executed address lies outside the graph: functions of the fixtures run in the emulator with many arguments, and
every instruction that was executed is in the graphs of what the function reaches."""

from __future__ import annotations

import random
from pathlib import Path

import pytest
from emulator import EmulationError, Emulator

from mauve.wcet.binary.callgraph import callees
from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.decode import Decoder
from mauve.wcet.binary.elf import Binary, Bind, load
from mauve.wcet.binary.graph import EXIT, Cfg

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


class Graphs:
    """The graphs of a binary, built when they are needed."""

    def __init__(self, image: str) -> None:
        binary = load(FIXTURES / f"{image}.elf")
        assert isinstance(binary, Binary)
        self.binary = binary
        self._decoder = Decoder(binary.read_code)
        self._cfgs: dict[int, Cfg] = {}

    def graph(self, key: int) -> Cfg:
        if key not in self._cfgs:
            self._cfgs[key] = build_cfg(self.binary, key, decoder=self._decoder)
        return self._cfgs[key]

    def closure(self, key: int) -> list[Cfg]:
        seen = {key}
        work = [key]
        while work:
            fresh = set(callees(self.graph(work.pop()))) - seen
            seen |= fresh
            work += fresh
        return [self.graph(member) for member in seen]


def _compare(image: str, repetitions: int) -> int:
    graphs, emulator = Graphs(image), Emulator(FIXTURES / f"{image}.elf", IMAGES[image])
    chance = random.Random(7)
    compared = 0
    for symbol in graphs.binary.functions:
        if symbol.bind is not Bind.GLOBAL or symbol.name in ENDLESS or symbol.name.startswith("__"):
            continue
        closure = graphs.closure(symbol.key)
        if any(cfg.unresolved for cfg in closure):
            continue
        inside = {i.address for cfg in closure for b in cfg.blocks for i in b.instructions}
        for number in range(repetitions):
            emulator.reset()
            arguments = [_argument(emulator, chance, number) for _ in range(4)]
            try:
                run = emulator.call(symbol.name, arguments, max_instructions=3_000)
            except EmulationError:
                continue
            outside = sorted(set(run.counts) - inside)
            assert not outside, f"{symbol.name}: {[hex(a) for a in outside[:4]]} executed but not in the graph"
            compared += 1
    return compared


def _argument(emulator: Emulator, chance: random.Random, number: int) -> int:
    """A pointer to an object that can be read and written, or a small number."""
    if number % 2 == 0:
        return chance.randrange(12)
    return emulator.alloc(bytes(chance.randrange(32) for _ in range(256)))


@pytest.mark.parametrize("image", ("arm7tdmi-arm-O2", "cortex-m0-thumb-Os", "cortex-m3-thumb-O2"))
def test_executed_addresses_are_in_the_graph(image: str) -> None:
    assert _compare(image, 2) > 150


@pytest.mark.slow
@pytest.mark.parametrize("image", IMAGES)
def test_executed_addresses_are_in_the_graph_of_every_image(image: str) -> None:
    assert _compare(image, 10) > 500


@pytest.mark.parametrize("image", IMAGES)
def test_graphs_keep_their_invariants(image: str) -> None:
    graphs = Graphs(image)
    for symbol in graphs.binary.functions:
        cfg = graphs.graph(symbol.key)
        assert cfg.blocks[cfg.entry].address == cfg.address
        assert [b.id for b in cfg.blocks] == list(range(len(cfg.blocks)))
        addresses = [i.address for b in cfg.blocks for i in b.instructions]
        assert addresses == sorted(set(addresses)), cfg.name
        assert {e.target for e in cfg.edges} - {EXIT} | {cfg.entry} == set(range(len(cfg.blocks))), cfg.name
        assert {e.source for e in cfg.edges} == set(range(len(cfg.blocks))), cfg.name
        for callee in callees(cfg):
            assert graphs.binary.read_code(callee & ~1, 2) is not None
