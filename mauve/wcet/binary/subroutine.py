"""Local subroutines that may return for their caller, put into the graphs of their callers.

Hand-written code (libgcc's floating point) calls parts of itself with bl that either come back, or take the caller's
frame off the stack and return from the caller. As a call that would be wrong: control does not come back to the
caller. Such a subroutine has no symbol, and a return that leaves the stack pointer above where it was at its entry.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import EXIT, Block, Cfg, Edge, EdgeKind, Unresolved, UnresolvedKind
from mauve.wcet.binary.microop import SP, Compute, Condition, Imm, Instruction, Load, Op

_MOST_ROUNDS = 4
_MOST_BLOCKS = 20_000
"""Blocks of a graph with the copies in it; libgcc's graphs stay below a hundred."""


def put_into_callers(cfgs: Mapping[int, Cfg], binary: Binary) -> dict[int, Cfg]:
    """The graphs with such subroutines in the place of their calls, a copy each."""
    result = dict(cfgs)
    local = {key: cfg for key, cfg in cfgs.items() if binary.symbol_at(key & ~1) is None}
    for _ in range(_MOST_ROUNDS):
        leaving = {key: found for key in local if (found := _returns_for_caller(result[key]))}
        changed = False
        for key, cfg in result.items():
            mine = {callee: edges for callee, edges in leaving.items() if callee != key}
            inlined = _inline(cfg, result, mine) if mine else cfg
            changed |= inlined is not cfg
            result[key] = inlined
        if not changed:
            break
    return result


def _returns_for_caller(cfg: Cfg) -> frozenset[int]:
    """The returns (indices of edges) with the stack pointer above where it was at the entry."""
    heights: dict[int, int | None] = {cfg.entry: 0}
    work = [cfg.entry]
    found = set()
    leaving: dict[int, list[int]] = {}
    for index, edge in enumerate(cfg.edges):
        leaving.setdefault(edge.source, []).append(index)
    while work:
        block = work.pop()
        for index in leaving.get(block, ()):
            edge = cfg.edges[index]
            height = _height(cfg.blocks[block].instructions, edge.kind is EdgeKind.FALL, heights[block])
            if edge.kind is EdgeKind.RETURN and height is not None and height > 0:
                found.add(index)
            if edge.target == EXIT:
                continue
            if edge.target not in heights:
                heights[edge.target] = height
                work.append(edge.target)
            elif heights[edge.target] not in (height, None):
                heights[edge.target] = None
                work.append(edge.target)
    return frozenset(found)


def _height(instructions: tuple[Instruction, ...], falls: bool, height: int | None) -> int | None:
    """The distance of sp from where it was at the entry, behind a block."""
    for instruction in instructions:
        if falls and instruction is instructions[-1] and instruction.condition is not Condition.AL:
            continue
        for op in instruction.ops:
            if not isinstance(op, Compute | Load) or op.dst != SP:
                continue
            if height is None or not isinstance(op, Compute) or op.a != SP or not isinstance(op.b, Imm):
                return None
            sure = instruction.condition is Condition.AL or instruction is instructions[-1]
            if op.op not in (Op.ADD, Op.SUB) or not sure:
                return None
            height += op.b.value if op.op is Op.ADD else -op.b.value
    return height


def _inline(cfg: Cfg, cfgs: Mapping[int, Cfg], leaving: Mapping[int, frozenset[int]]) -> Cfg:
    """The graph with the subroutines in `leaving` instead of their calls."""
    blocks, edges = list(cfg.blocks), []
    holes = list(cfg.unresolved)
    for edge in cfg.edges:
        if edge.kind is not EdgeKind.CALL or len(edge.callees) != 1 or edge.callees[0] not in leaving:
            edges.append(edge)
            continue
        callee = cfgs[edge.callees[0]]
        base = len(blocks)
        if base + len(callee.blocks) > _MOST_BLOCKS:
            message = f"the subroutines that return for {cfg.name} call each other too often to be followed"
            hole = Unresolved(cfg.address, UnresolvedKind.LIMIT, message)
            return cfg if hole in cfg.unresolved else replace(cfg, unresolved=(*cfg.unresolved, hole))
        blocks += [Block(base + block.id, block.instructions) for block in callee.blocks]
        holes += [hole for hole in callee.unresolved if hole not in holes]
        edges.append(Edge(edge.source, base + callee.entry, EdgeKind.TAKEN))
        for index, inner in enumerate(callee.edges):
            target = inner.target if inner.target == EXIT else base + inner.target
            if inner.kind is EdgeKind.RETURN and index not in leaving[edge.callees[0]]:
                edges.append(Edge(base + inner.source, edge.target, EdgeKind.SWITCH))
            else:
                edges.append(Edge(base + inner.source, target, inner.kind, inner.callees))
    if len(blocks) == len(cfg.blocks):
        return cfg
    return replace(cfg, blocks=tuple(blocks), edges=tuple(edges), unresolved=tuple(holes))
