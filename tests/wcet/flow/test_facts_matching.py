"""Facts find their loops, and their numbers become header executions."""

from __future__ import annotations

from pathlib import Path

import pytest

from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import LoopNest, loop_nest
from mauve.wcet.flow.facts import AtAddress, AtLine, AtSymbol, Counting, LoopFact
from mauve.wcet.flow.matching import match_facts, same_line, unmatched
from mauve.wcet.result import ProblemKind

FIXTURES = Path(__file__).resolve().parents[1] / "fixtures"


def function(image: str, name: str) -> tuple[Cfg, LoopNest]:
    binary = load(FIXTURES / image)
    assert isinstance(binary, Binary)
    cfg = build_cfg(binary, binary.function(name).key)
    return cfg, loop_nest(cfg)


def no_lines(address: int) -> None:
    return None


def no_symbols(name: str) -> None:
    return None


@pytest.mark.parametrize(("image", "shape"), [("arm7tdmi-arm-O0.elf", "unrotated"), ("arm7tdmi-arm-O2.elf", "rotated")])
def test_ff_numbers_count_back_edges(image: str, shape: str) -> None:
    """100 passes along the back edge are 101 executions of the header, for either shape of the loop."""
    cfg, nest = function(image, "sum")
    header = cfg.blocks[nest.loops[0].header].address
    fact = LoopFact(AtAddress(header), 100, Counting.BACK, 100)
    found = match_facts([fact], cfg, nest, no_lines, no_symbols)
    assert (found.bounds[0].bound, found.bounds[0].total) == (101, 101), shape


def test_address_facts_count_headers_and_may_name_the_branch_back() -> None:
    cfg, nest = function("arm7tdmi-arm-O2.elf", "loop_nested")
    inner = cfg.blocks[nest.loops[1].header]
    for address in (inner.address, inner.instructions[-1].address):
        found = match_facts([LoopFact(AtAddress(address), 12, Counting.HEADER)], cfg, nest, no_lines, no_symbols)
        assert {index: b.bound for index, b in found.bounds.items()} == {1: 12}
    symbol = LoopFact(AtSymbol("loop_nested", inner.address - cfg.address), 9, Counting.HEADER)
    assert match_facts([symbol], cfg, nest, no_lines, lambda name: cfg.address).bounds[1].bound == 9


def test_body_facts_by_line() -> None:
    """One more header execution where the test comes first, the same number where it comes last."""
    for image, expected in (("arm7tdmi-arm-O0.elf", 101), ("arm7tdmi-arm-O2.elf", 100)):
        cfg, nest = function(image, "sum")
        latch = max(i.address for b in nest.loops[0].blocks for i in cfg.blocks[b].instructions)

        def lines(address: int, latch: int = latch) -> tuple[str, int]:
            return ("./loops.c", 10 if address == latch else 11)

        fact = LoopFact(AtLine("loops.c", 10), 100, Counting.BODY)
        assert match_facts([fact], cfg, nest, lines, no_symbols).bounds[0].bound == expected


def test_a_body_fact_on_a_loop_of_one_line_keeps_the_extra_execution() -> None:
    cfg, nest = function("arm7tdmi-arm-O2.elf", "string_length")
    fact = LoopFact(AtLine("data.c", 5), 20, Counting.BODY)
    assert match_facts([fact], cfg, nest, lambda address: ("data.c", 5), no_symbols).bounds[0].bound == 21


def test_several_none_loose_and_contradicted() -> None:
    cfg, nest = function("arm7tdmi-arm-O2.elf", "loop_sequence")
    everywhere = LoopFact(AtLine("loops.c", 7), 50, Counting.BODY, written="a.mauve:3")
    found = match_facts([everywhere], cfg, nest, lambda a: ("loops.c", 7), no_symbols, derived={0: 11}, least={1: 99})
    assert [n.kind for n in found.notes] == [ProblemKind.FACT_SEVERAL, ProblemKind.FACT_LOOSE]
    assert [p.kind for p in found.problems] == [ProblemKind.FACT_CONTRADICTED]
    nowhere = LoopFact(AtAddress(0x10), 5, Counting.HEADER, written="a.mauve:9")
    (problem,) = unmatched([nowhere], match_facts([nowhere], cfg, nest, no_lines, no_symbols).matched)
    assert problem.kind is ProblemKind.FACT_NOWHERE
    assert problem.written == "a.mauve:9"


def test_files_match_by_their_last_components() -> None:
    assert same_line(("./src/robot/nav.c", 4), AtLine("robot/nav.c", 4))
    assert not same_line(("./src/robot/nav.c", 4), AtLine("v.c", 4))
    assert not same_line(("./src/robot/nav.c", 4), AtLine("nav.c", 5))
