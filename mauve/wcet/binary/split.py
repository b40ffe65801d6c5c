"""Node splitting: an irreducible graph becomes reducible by copies of blocks.

A region that is entered in more than one place (Duff's device, libgcc's Thumb-1 division, loops through which a
compiler threaded its jumps) is no loop. Splitting chooses a header for it; the blocks that the entries from outside
come to before that header get a copy each for these entries, and the copies lead to the header. The graph keeps
exactly the paths it had: each copy has the instructions and the ways on of its block. (Hecht and Ullman's node
splitting; Janssen and Corporaal, "Making graphs reducible with controlled node splitting".)
"""

from __future__ import annotations

from collections.abc import Collection, Container, Iterator, Mapping
from dataclasses import replace

from mauve.wcet.binary.graph import EXIT, Block, Cfg, Edge
from mauve.wcet.binary.loops import strong_components
from mauve.wcet.clock import Deadline, check

GROWTH_LIMIT = 4.0
"""How many times the instructions of the function the result may have."""
_SMALL = 2000
"""Instructions that are always allowed, whatever the growth."""
_EFFORT, _FEWEST = 500_000, 8
"""Edges that are looked at to choose the header of one region, and headers that are tried in any case."""
_AGAIN = 1
"""What an instruction counts for in a region that is still irreducible: it will be copied again, perhaps often."""


def split_irreducible(cfg: Cfg, growth: float = GROWTH_LIMIT, deadline: Deadline = None) -> Cfg:
    """A graph with the same paths and no irreducible region, as far as the growth limit lets it. Copies of a block
    share its instructions; in a graph with copies, block ids no longer follow addresses. Raises OutOfTime."""
    allowed = max(_SMALL, int(growth * _size(cfg.blocks)))
    while True:
        regions = _irregular(*_graph(cfg))
        before = cfg
        for region in regions:
            check(deadline, cfg.address, cfg.name)
            found = _Region(cfg, region)
            copied = found.copied()
            if _size(cfg.blocks) + found.weight(copied) <= allowed:
                cfg = _copy(cfg, region, copied)
        if cfg is before:
            return cfg
        cfg = _prune(cfg)


def restricted(cfg: Cfg, edges: Container[int]) -> Cfg:
    """The graph with these of its edges (by index) and the blocks that they lead to."""
    return _prune(replace(cfg, edges=tuple(edge for index, edge in enumerate(cfg.edges) if index in edges)))


def _size(blocks: tuple[Block, ...]) -> int:
    return sum(len(block.instructions) for block in blocks)


def _graph(cfg: Cfg) -> tuple[dict[int, list[int]], set[int]]:
    """The blocks behind each block, and where the function is entered."""
    following: dict[int, list[int]] = {block.id: [] for block in cfg.blocks}
    for edge in cfg.edges:
        if edge.target != EXIT:
            following[edge.source].append(edge.target)
    return following, {cfg.entry}


def _irregular(following: Mapping[int, Collection[int]], entries: Collection[int]) -> Iterator[frozenset[int]]:
    """The outermost cycles that are entered in several places, of a graph that is entered at `entries`. Inside a cycle
    with one entry, they are found without that."""
    waiting = [(sorted(following), list[int]())]
    while waiting:
        order, before = waiting.pop()
        number = {block: index for index, block in enumerate(order)}
        inside = [[number[t] for t in following[block] if t in number] for block in order]
        cycle_of: dict[int, int] = {}
        cycles = [component for component in strong_components(inside, range(len(order))) if len(component) > 1]
        for position, component in enumerate(cycles):
            cycle_of |= {order[index]: position for index in component}
        entered: list[set[int]] = [set() for _ in cycles]
        for block in entries:
            if block in cycle_of:
                entered[cycle_of[block]].add(block)
        for block in (*order, *before):
            for target in following[block]:
                if target in cycle_of and cycle_of.get(block) != cycle_of[target]:
                    entered[cycle_of[target]].add(target)
        for component, heads in zip(cycles, entered, strict=True):
            cycle = {order[index] for index in component}
            if len(heads) > 1:
                yield frozenset(cycle)
            elif heads:
                waiting.append((sorted(cycle - heads), list(heads)))


class _Region:
    """An irreducible region: blocks on cycles that are entered at several of them."""

    def __init__(self, cfg: Cfg, blocks: frozenset[int]) -> None:
        self._blocks = blocks
        self._weight = {block: len(cfg.blocks[block].instructions) for block in blocks}
        self._following: dict[int, list[int]] = {block: [] for block in blocks}
        self._before: dict[int, list[int]] = {block: [] for block in blocks}
        self._entries = {cfg.entry} & blocks
        for edge in cfg.edges:
            if edge.target in blocks and edge.source in blocks:
                self._following[edge.source].append(edge.target)
                self._before[edge.target].append(edge.source)
            elif edge.target in blocks:
                self._entries.add(edge.target)

    def copied(self) -> frozenset[int]:
        """The blocks to copy: everything that entries reach before the header that makes that the cheapest.

        Any block of the region can be the header. Where each entry leads to all the others, the best one is often the
        place at which their ways meet.
        """
        best, least = frozenset[int](), -1
        for header in self._headers():
            copied = self._until(header)
            cost = self.weight(copied)
            if 0 <= least <= cost:
                continue
            cost += _AGAIN * sum(self.weight(rest) for rest in self._left(header, copied))
            if least < 0 or cost < least:
                best, least = copied, cost
        return best

    def weight(self, blocks: Collection[int]) -> int:
        """The instructions of some blocks."""
        return sum(self._weight[block] for block in blocks)

    def _headers(self) -> list[int]:
        """The blocks to try: the entries and those at which ways meet, as many as there is time for."""
        edges = sum(len(targets) for targets in self._following.values())
        meeting = (block for block in self._blocks - self._entries if len(self._before[block]) > 1)
        ordered = sorted(meeting, key=lambda block: (-len(self._before[block]), block))
        return [*sorted(self._entries), *ordered][: max(_FEWEST, _EFFORT // edges)]

    def _until(self, header: int) -> frozenset[int]:
        """The blocks that the other entries reach without passing the header."""
        seen: set[int] = set()
        work = list(self._entries)
        while work:
            block = work.pop()
            if block != header and block not in seen:
                seen.add(block)
                work += self._following[block]
        return frozenset(seen)

    def _left(self, header: int, copied: frozenset[int]) -> Iterator[frozenset[int]]:
        """The cycles that will be entered in several places, without the header: among the blocks and among the
        copies."""
        others = {block: [t for t in targets if t != header] for block, targets in self._following.items()}
        del others[header]
        yield from _irregular(others, {t for t in self._following[header] if t != header})
        copies = {block: [t for t in others[block] if t in copied] for block in copied}
        yield from _irregular(copies, self._entries - {header})


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
