"""A control flow graph arranged for abstract execution: regions (the function and its loops) with their nodes in
order."""

from __future__ import annotations

from dataclasses import dataclass

from mauve.wcet.binary.graph import EXIT, Cfg, Edge, EdgeKind
from mauve.wcet.binary.loops import LoopNest

FUNCTION = -1
"""The region of the whole function; a loop's region has the loop's index."""


@dataclass(frozen=True, slots=True)
class Region:
    """`nodes` in topological order (back edges left out): blocks directly in the region and headers of the loops
    directly inside."""

    id: int
    header: int
    blocks: frozenset[int]
    nodes: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Order:
    """`inner[header]` is the loop that a header block starts; `innermost[block]` the region that holds a block
    directly; `taken` and `fall` the indices of the edges that leave a block when its last instruction acts, and when
    it does not; `always[loop]` the blocks that every full iteration of a loop passes; `height[loop]` how many loops lie
    inside each other in it."""

    cfg: Cfg
    nest: LoopNest
    regions: dict[int, Region]
    inner: dict[int, int]
    innermost: tuple[int, ...]
    taken: tuple[tuple[int, ...], ...]
    fall: tuple[tuple[int, ...], ...]
    always: dict[int, frozenset[int]]
    height: tuple[int, ...]


def arrange(cfg: Cfg, nest: LoopNest) -> Order:
    """The order of a reducible graph."""
    leaving: list[list[int]] = [[] for _ in cfg.blocks]
    for index, edge in enumerate(cfg.edges):
        leaving[edge.source].append(index)
    position = {block: i for i, block in enumerate(_reverse_postorder(cfg, leaving))}
    inner = {loop.header: loop.id for loop in nest.loops}
    innermost = [FUNCTION] * len(cfg.blocks)
    for loop in nest.loops:  # outer loops come first
        for block in loop.blocks:
            innermost[block] = loop.id
    contents: dict[int, list[int]] = {FUNCTION: []}
    for loop in nest.loops:
        contents[loop.id] = []
    for loop in nest.loops:
        contents[FUNCTION if loop.parent is None else loop.parent].append(loop.header)
        contents[loop.id].append(loop.header)
    for number in range(len(cfg.blocks)):
        if number not in inner and number in position:
            contents[innermost[number]].append(number)
    regions = {}
    for region, nodes in contents.items():
        header = cfg.entry if region == FUNCTION else nest.loops[region].header
        blocks = frozenset(range(len(cfg.blocks))) if region == FUNCTION else nest.loops[region].blocks
        regions[region] = Region(region, header, blocks, tuple(sorted(set(nodes), key=position.__getitem__)))
    taken, fall = [], []
    for indices in leaving:
        edges = [(index, cfg.edges[index]) for index in indices]
        fall.append(tuple(index for index, edge in edges if edge.kind is EdgeKind.FALL))
        taken.append(tuple(index for index, edge in edges if edge.kind is not EdgeKind.FALL))
    always = {loop.id: _always(cfg, nest, loop.id, leaving) for loop in nest.loops}
    height = [0] * len(nest.loops)
    for loop in reversed(nest.loops):
        if loop.parent is not None:
            height[loop.parent] = max(height[loop.parent], height[loop.id] + 1)
    return Order(cfg, nest, regions, inner, tuple(innermost), tuple(taken), tuple(fall), always, tuple(height))


def _reverse_postorder(cfg: Cfg, leaving: list[list[int]]) -> list[int]:
    order: list[int] = []
    seen = {cfg.entry}
    stack = [(cfg.entry, iter(leaving[cfg.entry]))]
    while stack:
        block, edges = stack[-1]
        for index in edges:
            target = cfg.edges[index].target
            if target != EXIT and target not in seen:
                seen.add(target)
                stack.append((target, iter(leaving[target])))
                break
        else:
            order.append(block)
            stack.pop()
    return order[::-1]


def _always(cfg: Cfg, nest: LoopNest, loop_id: int, leaving: list[list[int]]) -> frozenset[int]:
    """The blocks with an exit edge on all ways from the header to a back edge."""
    loop = nest.loops[loop_id]
    latches = {cfg.edges[index].source for index in loop.back_edges}
    exits = {b for b in loop.blocks if any(cfg.edges[index].target not in loop.blocks for index in leaving[b])}
    return frozenset(b for b in exits if not _reaches(cfg.edges, loop.header, latches, b, loop.blocks, leaving))


def _reaches(
    edges: tuple[Edge, ...], start: int, goals: set[int], avoid: int, blocks: frozenset[int], leaving: list[list[int]]
) -> bool:
    if start == avoid:
        return False
    seen, stack = {start}, [start]
    while stack:
        block = stack.pop()
        if block in goals:
            return True
        for index in leaving[block]:
            target = edges[index].target
            if target in blocks and target != avoid and target != start and target not in seen:
                seen.add(target)
                stack.append(target)
    return False
