"""Programs with loop bounds given by hand, for tests that want no flow analysis."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path

from mauve.wcet.binary.callgraph import build_program, order
from mauve.wcet.binary.elf import Binary, ElfProblem, load
from mauve.wcet.binary.loops import loop_nest
from mauve.wcet.flow.result import ContextKey, FunctionFlow, LoopBound, ProgramFlow
from mauve.wcet.result import Origin

FIXTURES = Path(__file__).parent / "fixtures"


@lru_cache
def image(name: str) -> Binary:
    """A fixture image."""
    binary = load(FIXTURES / name)
    assert not isinstance(binary, ElfProblem), binary.message
    return binary


def program_of(binary: Binary, function: str, bounds: Mapping[str, Sequence[int]] | None = None) -> ProgramFlow:
    """The program from a function on; `bounds`: by function, header executions of its loops in order of address."""
    symbol = binary.function(function)
    assert not isinstance(symbol, ElfProblem), symbol.message
    cfgs = build_program(binary, symbol.key)
    functions: dict[ContextKey, FunctionFlow] = {}
    for key in order(cfgs).functions:
        cfg = cfgs[key]
        nest = loop_nest(cfg)
        given = (bounds or {}).get(cfg.name, ())
        by_address = sorted(range(len(nest.loops)), key=lambda loop: cfg.blocks[nest.loops[loop].header].address)
        functions[key, ""] = FunctionFlow(
            cfg=cfg,
            nest=nest,
            bounds={loop: LoopBound(n, Origin.ANNOTATION, "test") for loop, n in zip(by_address, given, strict=False)},
            infeasible=frozenset(),
            accesses={},
            calls={i: tuple((c, "") for c in e.callees) for i, e in enumerate(cfg.edges) if e.callees},
            stack=0,
        )
    return ProgramFlow((symbol.key, ""), functions)
