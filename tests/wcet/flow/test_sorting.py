"""Calls of a known sorting routine: bounded by what is known of the arguments, else the one fact that is missing."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import cache

import pytest

from mauve.wcet.binary.graph import Block, Cfg, Edge, EdgeKind, Unresolved, UnresolvedKind
from mauve.wcet.binary.loops import loop_nest
from mauve.wcet.binary.microop import Condition, Instruction, Kind, Next, Traits
from mauve.wcet.flow.domain import Range, between, constant
from mauve.wcet.flow.library import Formula, KnownFunction, KnownLoop, known_functions, read_formula
from mauve.wcet.flow.sorting import Arguments, Sorted, comparisons, sorted_flow, sorting
from tests.wcet.flow.build_sorting_table import ALL, MOST, PHASES, SUM

AL, ALU, ANY = Condition.AL, Traits(Kind.ALU), between(0, (1 << 32) - 1)


def _value(text: str, elements: int) -> int:
    found = read_formula(text).most(lambda _: elements)
    assert found is not None
    return found


@cache
def greatest(elements: int, what: str) -> int:
    """The greatest count over all ways in which any answers can part a segment, by the recurrence itself."""
    if elements < 2:
        return 0
    leaf = {"phases": 1, "ends": 0, "insertion": 0}[what]
    if elements < 7:
        return leaf
    by_insertion = {"phases": 1, "ends": elements + 1, "insertion": elements * (elements - 1) // 2}[what]
    here = {"phases": 1, "ends": elements + 1, "insertion": 0}[what]
    parts = (
        greatest(left, what) + greatest(right, what)
        for left in range(elements)
        for right in (elements - left, elements - left - 1)
        if 0 <= right < elements
    )
    return max(by_insertion, here + max(parts))


@pytest.mark.parametrize(("what", "formula"), [("phases", PHASES), ("ends", SUM), ("insertion", ALL)])
def test_the_formulas_cover_every_way_to_part_the_elements(what: str, formula: str) -> None:
    for elements in range(2, 90):
        assert greatest(elements, what) <= _value(formula, elements), (what, elements)


def test_no_call_of_itself_for_so_many_elements() -> None:
    level = [MOST]
    for _ in range(8):
        level.append(level[-1] // 2)
    assert level[8] < 7 <= (MOST + 1) // 2**8


def routine(known_most: int = MOST) -> tuple[KnownFunction, Cfg]:
    """A function of three blocks: a loop around a call through a pointer, a call of itself."""

    def block(number: int) -> Block:
        return Block(number, (Instruction(0x100 + 4 * number, 4, False, "nop", AL, (), Next(), ALU),))

    edges = (
        Edge(0, 1, EdgeKind.CALL),
        Edge(1, 0, EdgeKind.TAKEN),
        Edge(1, 2, EdgeKind.FALL),
        Edge(2, -1, EdgeKind.RETURN),
        Edge(2, 1, EdgeKind.CALL, (0x100,)),
    )
    hole = Unresolved(0x100, UnresolvedKind.CALL, "where it goes is not known")
    cfg = Cfg("qsort", 0x100, False, 0, tuple(map(block, range(3))), edges, (hole,))
    loop = KnownLoop(0, read_formula("r1 + 1"), "because", Formula(((((), 3, 1),),)))
    inner = KnownLoop(4, read_formula("r1 + 1"), "because")
    return KnownFunction(("qsort",), ("here",), (loop, inner), True, known_most, 40), cfg


def flow(elements: Range, size: Range, compares: Sequence[int]) -> Sorted:
    known, cfg = routine()
    arguments = Arguments(elements, size, constant(0x200))
    return sorted_flow(known, cfg, loop_nest(cfg), arguments, tuple(compares))


def test_a_call_is_bounded_by_its_arguments() -> None:
    found = flow(constant(20), constant(4), [0x200])
    assert not found.flow.problems and not found.flow.cfg.unresolved
    assert found.called == {0: (0x200,)} and found.flow.cfg.edges[0].callees == (0x200,)
    assert found.flow.infeasible == {4} and found.flow.stack == 40
    assert all(bound.bound <= 21 for bound in found.flow.bounds.values())


@pytest.mark.parametrize(
    ("elements", "size", "compares", "reason"),
    [
        (constant(MOST + 1), constant(4), [0x200], "argument 2"),
        (ANY, constant(4), [0x200], "argument 2"),
        (constant(5), constant(0), [0x200], "argument 3"),
        (constant(5), ANY, [0x200], "argument 3"),
        (constant(5), constant(4), [], "argument 4"),
    ],
)
def test_what_is_missing_is_one_problem(elements: Range, size: Range, compares: list[int], reason: str) -> None:
    found = flow(elements, size, compares)
    (problem,) = found.flow.problems
    assert reason in problem.message and not found.flow.bounds and problem.address == 0x100


def test_only_the_table_knows_what_sorts() -> None:
    assert sorting(routine()[1]) is None
    entries = [known for known in known_functions().values() if known.sorts]
    assert len(entries) >= 4 and all(known.most == MOST and known.stack >= 100 for known in entries)
    known = Arguments(constant(1), constant(1), constant(0x300))
    assert comparisons(known, lambda key: key == 0x300) == (0x300,)
    assert comparisons(known, lambda key: False) == ()


@pytest.mark.parametrize(
    ("base", "size", "by_bytes", "by_words"),
    [
        (constant(0x2000), constant(4), False, False),
        (constant(0x2000), constant(12), False, True),
        (Range(0x2000, 8, 5), Range(4, 4, 2), False, True),
        (constant(0x2002), constant(4), True, True),
        (constant(0x2000), constant(6), True, True),
        (ANY, constant(4), True, True),
    ],
)
def test_elements_are_exchanged_as_their_place_and_size_ask_for(
    base: Range, size: Range, by_bytes: bool, by_words: bool
) -> None:
    arguments = Arguments(constant(5), size, constant(0x200), base)
    assert (arguments.exchanged(1), arguments.exchanged(4)) == (by_bytes, by_words)


def test_loops_of_other_exchanges_are_not_entered() -> None:
    known, cfg = routine()
    loops = tuple(replace(loop, exchanges=unit) for loop, unit in zip(known.loops, (0, 1), strict=True))
    nest = loop_nest(cfg)
    header = {cfg.blocks[loop.header].address - cfg.address: loop.header for loop in nest.loops}
    for base, expected in ((constant(0x2000), True), (constant(0x2001), False)):
        arguments = Arguments(constant(5), constant(4), constant(0x200), base)
        found = sorted_flow(replace(known, loops=loops), cfg, nest, arguments, (0x200,)).flow
        entering = {i for i, edge in enumerate(cfg.edges) if edge.target == header[4]}
        back = {i for loop in nest.loops if loop.header == header[4] for i in loop.back_edges}
        assert entering - back and (entering - back <= found.infeasible) is expected
