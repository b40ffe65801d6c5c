"""Jumps whose targets no code checks, executed: every address and every step lies in the graphs."""

from __future__ import annotations

from functools import cache
from itertools import pairwise
from pathlib import Path
from random import Random

import pytest
from emulator import Emulator
from wcet.soundness.replay import record

from mauve.wcet.binary.callgraph import build_program
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.graph import EXIT
from mauve.wcet.binary.loops import loop_nest
from mauve.wcet.binary.split import split_irreducible

JUMPS = Path(__file__).parent / "jumps"
CORES = {
    "arm7tdmi-gcc": "arm7tdmi",
    "cortex-m0-gcc": "cortex-m0",
    "cortex-m3-gcc": "cortex-m3",
    "cortex-m3-clang": "cortex-m3",
}
MOST = {"computed": 4, "threaded": 3, "unchecked": 4, "resumed": 4, "lowest": 255, "middle": 2}
"""The greatest number in the data that each function reads."""


@cache
def image(name: str) -> Binary:
    found = load(JUMPS / f"{name}.elf")
    assert isinstance(found, Binary)
    return found


@pytest.mark.parametrize("function", MOST)
@pytest.mark.parametrize("name", CORES)
def test_what_is_executed_lies_in_the_graphs(name: str, function: str) -> None:
    binary = image(name)
    cfgs = build_program(binary, binary.function(function).key).values()  # type: ignore[union-attr]
    assert not any(cfg.unresolved for cfg in cfgs)
    steps, inside = set(), set()
    for cfg in cfgs:
        copy = split_irreducible(cfg)
        assert not loop_nest(copy).irreducible
        for block in copy.blocks:
            inside |= {instruction.address for instruction in block.instructions}
        for edge in copy.edges:
            if edge.target != EXIT:
                steps.add((copy.blocks[edge.source].instructions[-1].address, copy.blocks[edge.target].address))
    calls = {i.address for cfg in cfgs for e in cfg.edges if e.callees for i in cfg.blocks[e.source].instructions}
    last = {block.instructions[-1].address for cfg in cfgs for block in cfg.blocks}
    emulator = Emulator(JUMPS / f"{name}.elf", CORES[name])
    for seed in range(3):
        random = Random(seed)
        emulator.reset()
        data = bytes(random.randint(0, MOST[function]) for _ in range(16))
        emulator.write(emulator.by_name["data"].address, data)
        run = record(emulator, function, [], most=20_000)
        assert inside.issuperset(run.addresses)
        ways = {(a, b) for a, b in pairwise(run.addresses) if a in last and a not in calls}
        entries = {cfg.address for cfg in cfgs}
        leaving = {cfg.blocks[e.source].instructions[-1].address for cfg in cfgs for e in cfg.edges if e.target == EXIT}
        assert all(way in steps or way[0] in leaving or way[1] in entries for way in ways)
