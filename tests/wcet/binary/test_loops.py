"""Dominators, natural loops and node splitting on random graphs, against their definitions."""

from __future__ import annotations

from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.wcet.binary.graph import EXIT, Block, Cfg, Edge, EdgeKind
from mauve.wcet.binary.loops import dominator_intervals, immediate_dominators, loop_nest, successors
from mauve.wcet.binary.microop import Condition, Instruction, Kind, Next, Traits
from mauve.wcet.binary.split import restricted, split_irreducible


def graph(following: list[list[int]]) -> Cfg:
    """A graph whose blocks are single instructions; nodes without successors leave it."""
    blocks = tuple(
        Block(n, (Instruction(4 * n, 4, False, "nop", Condition.AL, (), Next(), Traits(Kind.ALU)),))
        for n in range(len(following))
    )
    edges = [Edge(n, t, EdgeKind.FALL) for n, targets in enumerate(following) for t in targets]
    edges += [Edge(n, EXIT, EdgeKind.RETURN) for n, targets in enumerate(following) if not targets]
    return Cfg("g", 0, False, 0, blocks, tuple(edges))


@st.composite
def graphs(draw: st.DrawFn) -> list[list[int]]:
    size = draw(st.integers(1, 9))
    following = [draw(st.lists(st.integers(0, size - 1), max_size=3, unique=True)) for _ in range(size)]
    for node in range(1, size):
        parent = draw(st.integers(0, node - 1))
        if node not in following[parent]:
            following[parent].append(node)
    return following


def _reach(following: list[list[int]], start: int, without: int | None) -> set[int]:
    seen: set[int] = set()
    work = [start]
    while work:
        node = work.pop()
        if node != without and node not in seen:
            seen.add(node)
            work += following[node]
    return seen


@given(graphs())
@settings(max_examples=120, deadline=None)
def test_dominators_follow_the_definition(following: list[list[int]]) -> None:
    intervals = dominator_intervals(immediate_dominators(following, 0), 0)
    for a in range(len(following)):
        for b in range(len(following)):
            first, last = intervals[a]
            claimed = first <= intervals[b][0] <= last
            assert claimed == (a == b or b not in _reach(following, 0, a))


@given(graphs())
@settings(max_examples=120, deadline=None)
def test_loops_are_natural_and_nested(following: list[list[int]]) -> None:
    cfg = graph(following)
    nest = loop_nest(cfg)
    for number, loop in enumerate(nest.loops):
        assert loop.id == number and loop.header in loop.blocks
        assert all(cfg.edges[e].source in loop.blocks and cfg.edges[e].target == loop.header for e in loop.back_edges)
        assert all(cfg.edges[e].source not in loop.blocks for e in loop.entry_edges)
        for edge in cfg.edges:
            if edge.target in loop.blocks and edge.source not in loop.blocks:
                assert edge.target == loop.header
        if loop.parent is None:
            assert loop.depth == 1
        else:
            parent = nest.loops[loop.parent]
            assert loop.parent < number and loop.blocks < parent.blocks and loop.depth == parent.depth + 1
    removed = {e for loop in nest.loops for e in loop.back_edges}
    inside = {node for region in nest.irreducible for node in region}
    forward = [[] for _ in following]
    for number, edge in enumerate(cfg.edges):
        if number not in removed and edge.target != EXIT and not {edge.source, edge.target} <= inside:
            forward[edge.source].append(edge.target)
    for node in range(len(following)):
        assert all(node not in _reach(forward, t, None) for t in forward[node]) or node in inside


@given(graphs())
@settings(max_examples=120, deadline=None)
def test_splitting_removes_irreducible_regions_and_keeps_paths(following: list[list[int]]) -> None:
    cfg = graph(following)
    copy = split_irreducible(cfg)
    assert not loop_nest(copy).irreducible
    wanted, found = successors(cfg), successors(copy)
    number = {block.id: block.address // 4 for block in copy.blocks}
    assert number[copy.entry] == 0
    for block in copy.blocks:
        ways = sorted(number[target] for target in found[block.id])
        assert ways == sorted(wanted[number[block.id]])
        leaves = any(e.source == block.id and e.target == EXIT for e in copy.edges)
        assert leaves == any(e.source == number[block.id] and e.target == EXIT for e in cfg.edges)


def test_a_long_chain_needs_no_recursion() -> None:
    size = 40_000
    following = [[n + 1] if n + 1 < size else [] for n in range(size)]
    following[-1] = [size // 2]
    parents = immediate_dominators(following, 0)
    assert parents[size - 1] == size - 2
    (loop,) = loop_nest(graph(following)).loops
    assert loop.header == size // 2 and len(loop.blocks) == size // 2


def test_the_edges_that_a_run_took_can_leave_a_region_one_entry() -> None:
    """From 0 into the loop of 1 and 2 at either; the run came in at 1."""
    cfg = graph([[1, 2], [2], [1, 3], []])
    assert loop_nest(cfg).irreducible
    taken = {number for number, edge in enumerate(cfg.edges) if (edge.source, edge.target) != (0, 2)}
    kept = restricted(cfg, taken)
    nest = loop_nest(kept)
    assert not nest.irreducible and [kept.blocks[loop.header].address for loop in nest.loops] == [cfg.blocks[1].address]
    assert {block.address for block in kept.blocks} == {block.address for block in cfg.blocks}


def test_the_header_of_a_threaded_loop_is_where_all_ways_meet() -> None:
    """An unrolled loop whose steps a compiler made twice, for each value of a flag, entered for both. With an entry as
    the header what is left would be entered in two places again, step after step."""
    steps = 12
    following: list[list[int]] = [[1, 2]]
    for step in range(steps):
        after = [2 * step + 3, 2 * step + 4] if step + 1 < steps else [2 * steps + 1]
        following += [after, after]
    following += [[1, 2, 2 * steps + 2], []]
    cfg = graph(following)
    copy = split_irreducible(cfg)
    (loop,) = loop_nest(copy).loops
    assert copy.blocks[loop.header].address == cfg.blocks[2 * steps + 1].address
    assert len(copy.blocks) == len(cfg.blocks) + 2 * steps
