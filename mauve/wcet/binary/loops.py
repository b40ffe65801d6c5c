"""Dominators and the loop nest of a control flow graph."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from mauve.wcet.binary.graph import EXIT, Cfg


@dataclass(frozen=True, slots=True)
class Loop:
    """A natural loop: the blocks from which a back edge to `header` is reached without passing it.

    `back_edges` and `entry_edges` are indices into `Cfg.edges`; `parent` is the index in `LoopNest.loops` of the loop
    around it; `depth` counts from 1.
    """

    id: int
    header: int
    blocks: frozenset[int]
    back_edges: tuple[int, ...]
    entry_edges: tuple[int, ...]
    parent: int | None
    depth: int


@dataclass(frozen=True, slots=True)
class LoopNest:
    """All loops of a function, outer ones before inner ones. `irreducible` lists the regions entered in more than one
    place (sets of block ids); they are no loops, and a function that still has one has no bound."""

    loops: tuple[Loop, ...]
    irreducible: tuple[frozenset[int], ...] = ()


def successors(cfg: Cfg) -> list[list[int]]:
    """The blocks behind each block, EXIT left out, each once."""
    found: list[dict[int, None]] = [{} for _ in cfg.blocks]
    for edge in cfg.edges:
        if edge.target != EXIT:
            found[edge.source][edge.target] = None
    return [list(targets) for targets in found]


def predecessors(cfg: Cfg) -> list[list[int]]:
    """The blocks before each block, each once."""
    found: list[list[int]] = [[] for _ in cfg.blocks]
    for source, targets in enumerate(successors(cfg)):
        for target in targets:
            found[target].append(source)
    return found


def reverse_postorder(following: Sequence[Sequence[int]], entry: int) -> list[int]:
    """The nodes that `entry` reaches, each before its successors except along back edges."""
    order: list[int] = []
    seen = {entry}
    stack = [(entry, iter(following[entry]))]
    while stack:
        node, rest = stack[-1]
        for target in rest:
            if target not in seen:
                seen.add(target)
                stack.append((target, iter(following[target])))
                break
        else:
            order.append(node)
            stack.pop()
    order.reverse()
    return order


def immediate_dominators(following: Sequence[Sequence[int]], entry: int) -> list[int | None]:
    """The immediate dominator of each node: None for the entry and for nodes it does not reach.

    Cooper, Harvey and Kennedy, "A Simple, Fast Dominance Algorithm": iterate over the reverse postorder; the
    intersection walks up numbers, so deep graphs need no recursion.
    """
    order = reverse_postorder(following, entry)
    number = {node: position for position, node in enumerate(order)}
    before: list[list[int]] = [[] for _ in order]
    for position, node in enumerate(order):
        for target in following[node]:
            before[number[target]].append(position)
    parent = [-1] * len(order)
    parent[0] = 0
    changed = True
    while changed:
        changed = False
        for position in range(1, len(order)):
            new = -1
            for source in before[position]:
                if parent[source] < 0:
                    continue
                new = source if new < 0 else _meet(parent, source, new)
            if parent[position] != new:
                parent[position] = new
                changed = True
    result: list[int | None] = [None] * len(following)
    for position in range(1, len(order)):
        result[order[position]] = order[parent[position]]
    return result


def _meet(parent: list[int], first: int, second: int) -> int:
    while first != second:
        while first > second:
            first = parent[first]
        while second > first:
            second = parent[second]
    return first


def dominator_intervals(parents: Sequence[int | None], entry: int) -> list[tuple[int, int]]:
    """Preorder number and last number below, per node of the dominator tree: a dominates b exactly when a's interval
    holds b's first number. Nodes outside the tree get (-1, -2)."""
    children: list[list[int]] = [[] for _ in parents]
    for node, parent in enumerate(parents):
        if parent is not None:
            children[parent].append(node)
    first, last = [-1] * len(parents), [-2] * len(parents)
    count = 0
    stack = [(entry, False)]
    while stack:
        node, done = stack.pop()
        if done:
            last[node] = count - 1
            continue
        first[node] = count
        count += 1
        stack.append((node, True))
        stack += [(child, False) for child in children[node]]
    return list(zip(first, last, strict=True))


def strong_components(following: Sequence[Sequence[int]], nodes: Sequence[int]) -> list[list[int]]:
    """The strongly connected components among `nodes` (Tarjan, without recursion); successors come before
    predecessors."""
    allowed = set(nodes)
    index: dict[int, int] = {}
    low: dict[int, int] = {}
    on_stack: set[int] = set()
    path: list[int] = []
    result: list[list[int]] = []
    for root in nodes:
        if root in index:
            continue
        index[root] = low[root] = len(index)
        path.append(root)
        on_stack.add(root)
        work = [(root, iter(following[root]))]
        while work:
            node, rest = work[-1]
            for target in rest:
                if target not in allowed:
                    continue
                if target not in index:
                    index[target] = low[target] = len(index)
                    path.append(target)
                    on_stack.add(target)
                    work.append((target, iter(following[target])))
                    break
                if target in on_stack:
                    low[node] = min(low[node], index[target])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    at = len(path) - 1
                    while path[at] != node:
                        at -= 1
                    component = path[at:]
                    del path[at:]
                    on_stack.difference_update(component)
                    result.append(component)
    return result


def loop_nest(cfg: Cfg) -> LoopNest:
    """The natural loops, those of one header merged, outer before inner; and the irreducible regions.

    An edge u -> v is a back edge when v dominates u. What is still cyclic without the back edges is entered in more
    than one place: each such strongly connected component is one irreducible region.
    """
    if not cfg.blocks:
        return LoopNest(())
    following = successors(cfg)
    intervals = dominator_intervals(immediate_dominators(following, cfg.entry), cfg.entry)
    back: dict[int, list[int]] = {}
    for number, edge in enumerate(cfg.edges):
        if edge.target != EXIT:
            first, last = intervals[edge.target]
            if first <= intervals[edge.source][0] <= last:
                back.setdefault(edge.target, []).append(number)
    irreducible = _irreducible(following, back, cfg)
    before = predecessors(cfg)
    bodies = {header: _body(header, (cfg.edges[e].source for e in edges), before) for header, edges in back.items()}
    return LoopNest(_nest(cfg, back, bodies), irreducible)


def _irreducible(following: list[list[int]], back: dict[int, list[int]], cfg: Cfg) -> tuple[frozenset[int], ...]:
    removed = {(cfg.edges[e].source, header) for header, edges in back.items() for e in edges}
    forward = [[t for t in targets if (source, t) not in removed] for source, targets in enumerate(following)]
    components = strong_components(forward, range(len(cfg.blocks)))
    return tuple(sorted((frozenset(c) for c in components if len(c) > 1), key=min))


def _body(header: int, latches: Iterable[int], before: list[list[int]]) -> frozenset[int]:
    body = {header}
    work = list(latches)
    while work:
        node = work.pop()
        if node not in body:
            body.add(node)
            work += before[node]
    return frozenset(body)


def _nest(cfg: Cfg, back: dict[int, list[int]], bodies: dict[int, frozenset[int]]) -> tuple[Loop, ...]:
    headers = sorted(bodies, key=lambda header: (-len(bodies[header]), header))
    innermost: dict[int, int] = {}
    entering: dict[int, list[int]] = {header: [] for header in headers}
    for number, edge in enumerate(cfg.edges):
        if edge.target in entering and edge.source not in bodies[edge.target]:
            entering[edge.target].append(number)
    loops: list[Loop] = []
    for number, header in enumerate(headers):
        parent = innermost.get(header)
        depth = 1 if parent is None else loops[parent].depth + 1
        loops.append(Loop(number, header, bodies[header], tuple(back[header]), tuple(entering[header]), parent, depth))
        for block in bodies[header]:
            innermost[block] = number
    return tuple(loops)
