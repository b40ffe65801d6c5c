"""Where the ways on from a block meet again: immediate postdominators."""

from __future__ import annotations

from mauve.wcet.binary.graph import EXIT, Cfg


def meeting_points(cfg: Cfg) -> list[int]:
    """For each block the first block that lies on all ways from it out of the function; EXIT where there is none.

    Cooper, Harvey and Kennedy, "A simple, fast dominance algorithm", on the reversed graph. A block from which no way
    leads out meets at EXIT.
    """
    end = len(cfg.blocks)
    following: list[list[int]] = [[] for _ in range(end + 1)]
    before: list[list[int]] = [[] for _ in range(end + 1)]
    for edge in cfg.edges:
        target = end if edge.target == EXIT else edge.target
        following[edge.source].append(target)
        before[target].append(edge.source)
    order: list[int] = []
    seen = {end}
    stack = [(end, iter(before[end]))]
    while stack:
        node, rest = stack[-1]
        for previous in rest:
            if previous not in seen:
                seen.add(previous)
                stack.append((previous, iter(before[previous])))
                break
        else:
            order.append(node)
            stack.pop()
    number = {node: i for i, node in enumerate(order)}
    parent: list[int | None] = [None] * (end + 1)
    parent[end] = end
    changed = True
    while changed:
        changed = False
        for node in order[-2::-1]:
            best: int | None = None
            for target in following[node]:
                if target in number and parent[target] is not None:
                    best = target if best is None else _common(parent, number, best, target)
            if parent[node] != best:
                parent[node], changed = best, True
    return [EXIT if parent[node] in (None, end) else parent[node] for node in range(end)]  # type: ignore[misc]


def _common(parent: list[int | None], number: dict[int, int], a: int, b: int) -> int:
    while a != b:
        while number[a] < number[b]:
            up = parent[a]
            assert up is not None
            a = up
        while number[b] < number[a]:
            up = parent[b]
            assert up is not None
            b = up
    return a
