"""Subroutines of hand-written code that return for their caller."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from mauve.wcet.binary import subroutine
from mauve.wcet.binary.callgraph import build_program
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.graph import EdgeKind, UnresolvedKind
from mauve.wcet.flow.program import analyse_program
from tests.emulator import Emulator
from tests.wcet.soundness.replay import Replay, record

FIXTURES = Path(__file__).resolve().parents[1] / "fixtures"
DOUBLES = (0.0, -0.0, 1.5, -3e300, 5e-324, 2e-310, float("inf"), float("nan"), 1e-200, 4.0)


@pytest.mark.parametrize(("image", "cpu"), [("arm7tdmi-arm-O2", "arm7tdmi"), ("cortex-m3-thumb-O2", "cortex-m3")])
@pytest.mark.parametrize("function", ["__aeabi_dmul", "__aeabi_ddiv", "__aeabi_fmul", "__aeabi_fdiv"])
def test_executions_stay_in_the_graph(image: str, cpu: str, function: str) -> None:
    """Zeros, infinities and denormal numbers make libgcc's subroutines return from the function that called them."""
    binary = load(FIXTURES / f"{image}.elf")
    assert isinstance(binary, Binary)
    symbol = binary.function(function)
    program = analyse_program(binary, symbol.key)
    flow = program.functions[program.entry]
    assert all(edge.kind is not EdgeKind.CALL for edge in flow.cfg.edges)
    assert set(flow.bounds) == set(range(len(flow.nest.loops)))
    replay, emulator = Replay(program, ()), Emulator(FIXTURES / f"{image}.elf", cpu)
    for a in DOUBLES:
        for b in DOUBLES:
            if "_d" in function:
                arguments = [*struct.unpack("<2I", struct.pack("<d", a)), *struct.unpack("<2I", struct.pack("<d", b))]
            else:
                arguments = [struct.unpack("<I", struct.pack("<f", x if abs(x) < 1e30 else 2e38))[0] for x in (a, b)]
            replay.walk(record(emulator, function, arguments))
    assert not replay.wrong


def test_too_many_copies_leave_a_hole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(subroutine, "_MOST_BLOCKS", 10)
    binary = load(FIXTURES / "arm7tdmi-arm-O2.elf")
    assert isinstance(binary, Binary)
    symbol = binary.function("__aeabi_ddiv")
    cfg = build_program(binary, symbol.key)[symbol.key]
    assert [hole.kind for hole in cfg.unresolved] == [UnresolvedKind.LIMIT]
