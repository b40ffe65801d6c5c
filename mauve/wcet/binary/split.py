"""Node splitting: an irreducible graph becomes reducible by copies of blocks.

A region that is entered in more than one place (Duff's device, libgcc's Thumb-1 division) is no loop. Splitting gives
the blocks that can be entered from outside, and are not the chosen header, a copy each for the entries from outside;
the copies lead into the region. The graph keeps exactly the paths it had: each copy has the instructions and the ways
on of its block. (Hecht and Ullman's node splitting; Janssen and Corporaal, "Making graphs reducible with controlled
node splitting".)
"""

from __future__ import annotations

from collections.abc import Container
from dataclasses import replace

from mauve.wcet.binary.graph import EXIT, Block, Cfg, Edge
from mauve.wcet.binary.loops import loop_nest
from mauve.wcet.clock import Deadline, check

GROWTH_LIMIT = 4.0
"""How many times the instructions of the function the result may have."""
_SMALL = 2000
"""Instructions that are always allowed, whatever the growth."""


def split_irreducible(cfg: Cfg, growth: float = GROWTH_LIMIT, deadline: Deadline = None) -> Cfg:
    """A graph with the same paths and no irreducible region, as far as the growth limit lets it. Copies of a block
    share its instructions; in a graph with copies, block ids no longer follow addresses. Raises OutOfTime."""
    allowed = max(_SMALL, int(growth * _size(cfg.blocks)))
    while True:
        regions = loop_nest(cfg).irreducible
        before = cfg
        for region in regions:
            check(deadline, cfg.address, cfg.name)
            attempt = _split(cfg, region)
            if _size(attempt.blocks) <= allowed:
                cfg = attempt
        if cfg is before:
            return cfg
        cfg = _prune(cfg)


def restricted(cfg: Cfg, edges: Container[int]) -> Cfg:
    """The graph with these of its edges (by index) and the blocks that they lead to."""
    return _prune(replace(cfg, edges=tuple(edge for index, edge in enumerate(cfg.edges) if index in edges)))


def _size(blocks: tuple[Block, ...]) -> int:
    return sum(len(block.instructions) for block in blocks)


def _split(cfg: Cfg, region: frozenset[int]) -> Cfg:
    """Make one entry of the region its only one: everything reached in the region from its other entries before that
    header is copied once."""
    entries = {edge.target for edge in cfg.edges if edge.target in region and edge.source not in region}
    if cfg.entry in region:
        entries.add(cfg.entry)
    following: dict[int, list[int]] = {block: [] for block in region}
    for edge in cfg.edges:
        if edge.source in region and edge.target in region:
            following[edge.source].append(edge.target)
    best: frozenset[int] | None = None
    for header in sorted(entries):
        copied = _before(header, entries - {header}, following)
        if best is None or _weight(cfg, copied) < _weight(cfg, best):
            best = copied
    assert best is not None, "an irreducible region is entered somewhere"
    return _copy(cfg, region, best)


def _before(header: int, others: set[int], following: dict[int, list[int]]) -> frozenset[int]:
    """The blocks of the region that the other entries reach without passing the header."""
    seen: set[int] = set()
    work = list(others)
    while work:
        block = work.pop()
        if block != header and block not in seen:
            seen.add(block)
            work += following[block]
    return frozenset(seen)


def _weight(cfg: Cfg, blocks: frozenset[int]) -> int:
    return sum(len(cfg.blocks[block].instructions) for block in blocks)


def _copy(cfg: Cfg, region: frozenset[int], copied: frozenset[int]) -> Cfg:
    """Entries from outside go to copies; a copy leads to copies as long as it stays among the copied blocks."""
    twin = {block: len(cfg.blocks) + number for number, block in enumerate(sorted(copied))}
    blocks = (*cfg.blocks, *(replace(cfg.blocks[block], id=twin[block]) for block in sorted(copied)))
    edges: list[Edge] = []
    for edge in cfg.edges:
        enters = edge.source not in region and edge.target in twin
        edges.append(replace(edge, target=twin[edge.target]) if enters else edge)
    for edge in cfg.edges:
        if edge.source in twin:
            target = twin.get(edge.target, edge.target) if edge.target != EXIT else EXIT
            edges.append(replace(edge, source=twin[edge.source], target=target))
    entry = twin.get(cfg.entry, cfg.entry)
    return replace(cfg, blocks=blocks, edges=tuple(edges), entry=entry)


def _prune(cfg: Cfg) -> Cfg:
    """Drop what the entry does not reach, number the rest anew."""
    following: dict[int, list[int]] = {block.id: [] for block in cfg.blocks}
    for edge in cfg.edges:
        if edge.target != EXIT:
            following[edge.source].append(edge.target)
    seen = {cfg.entry}
    work = [cfg.entry]
    while work:
        for target in following[work.pop()]:
            if target not in seen:
                seen.add(target)
                work.append(target)
    number = {block: new for new, block in enumerate(sorted(seen))}
    blocks = tuple(replace(cfg.blocks[block], id=number[block]) for block in sorted(seen))
    edges = tuple(
        replace(e, source=number[e.source], target=EXIT if e.target == EXIT else number[e.target])
        for e in cfg.edges
        if e.source in number
    )
    return replace(cfg, blocks=blocks, edges=edges, entry=number[cfg.entry])
