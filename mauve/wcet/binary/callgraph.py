"""All functions that an entry reaches: their graphs, who calls whom, and in which order to analyse them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

from mauve.wcet.binary.cfg import INSTRUCTION_LIMIT, Control, build_cfg
from mauve.wcet.binary.decode import Decoder
from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import Cfg, EdgeKind
from mauve.wcet.binary.loops import strong_components

PROGRAM_LIMIT = 2_000_000
"""How many instructions of a whole program are looked at before giving up."""


def callees(cfg: Cfg) -> tuple[int, ...]:
    """The keys of the functions that a function calls or ends in, each once, in order of address of the call."""
    return tuple(dict.fromkeys(key for edge in cfg.edges for key in edge.callees))


def build_program(
    binary: Binary, entry: int, control: Control | None = None, limit: int = PROGRAM_LIMIT
) -> Mapping[int, Cfg]:
    """The graphs of `entry` (a key) and of everything it calls, by key.

    Functions without a way to return are found on the way: calls of them end their path. Functions that reach each
    other by tail calls alone are a loop, not a recursion: they are put into one graph.
    """
    control = control or Control()
    decoder = Decoder(binary.read_code)
    cfgs: dict[int, Cfg] = {}
    while True:
        _close(binary, entry, control, decoder, cfgs, limit)
        silent = _without_return(cfgs) - control.no_return
        if silent:
            control = replace(control, no_return=control.no_return | silent)
            affected = [key for key, cfg in cfgs.items() if silent & set(callees(cfg))]
        else:
            rings = _tail_rings(cfgs) - control.inline
            if not rings:
                return {key: cfgs[key] for key in _reachable(cfgs, entry)}
            control = replace(control, inline=control.inline | rings)
            affected = [key for key, cfg in cfgs.items() if rings & set(_tail_callees(cfg))]
        for key in affected:
            cfgs[key] = build_cfg(binary, key, control, decoder)


def _close(binary: Binary, entry: int, control: Control, decoder: Decoder, cfgs: dict[int, Cfg], limit: int) -> None:
    """Add the graphs of all functions that are called and not there yet."""
    work = [entry, *(key for cfg in cfgs.values() for key in callees(cfg))]
    spent = sum(len(block.instructions) for cfg in cfgs.values() for block in cfg.blocks)
    while work:
        key = work.pop()
        if key in cfgs:
            continue
        cfg = build_cfg(binary, key, control, decoder, max(1, min(INSTRUCTION_LIMIT, limit - spent)))
        spent += sum(len(block.instructions) for block in cfg.blocks)
        cfgs[key] = cfg
        work += callees(cfg)


def _reachable(cfgs: Mapping[int, Cfg], entry: int) -> list[int]:
    seen: dict[int, None] = {}
    work = [entry]
    while work:
        key = work.pop()
        if key not in seen:
            seen[key] = None
            work += reversed(callees(cfgs[key]))
    return list(seen)


def _without_return(cfgs: Mapping[int, Cfg]) -> frozenset[int]:
    """Functions none of whose paths returns. One with a hole may return."""
    returns = {key for key, cfg in cfgs.items() if cfg.unresolved or any(e.kind is EdgeKind.RETURN for e in cfg.edges)}
    changed = True
    while changed:
        changed = False
        for key, cfg in cfgs.items():
            if key not in returns and returns & set(_tail_callees(cfg)):
                returns.add(key)
                changed = True
    return frozenset(cfgs) - returns


def _tail_callees(cfg: Cfg) -> tuple[int, ...]:
    return tuple(key for edge in cfg.edges if edge.kind is EdgeKind.TAIL_CALL for key in edge.callees)


def _tail_rings(cfgs: Mapping[int, Cfg]) -> frozenset[int]:
    """Functions on a cycle of tail calls."""
    numbers = {key: number for number, key in enumerate(cfgs)}
    following = [[numbers[k] for k in _tail_callees(cfg)] for cfg in cfgs.values()]
    keys = list(cfgs)
    rings = (c for c in strong_components(following, range(len(keys))) if len(c) > 1)
    return frozenset(keys[number] for ring in rings for number in ring)


# ---------------------------------------------------------------------------------------------------- order
@dataclass(frozen=True, slots=True)
class Cycle:
    """A recursion: `path` names the functions of one way round by key, the first again at the end."""

    members: frozenset[int]
    path: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Order:
    """All functions, callees before callers; members of a recursion stand in any order among themselves, and `cycles`
    names every recursion."""

    functions: tuple[int, ...]
    cycles: tuple[Cycle, ...] = ()


def order(cfgs: Mapping[int, Cfg]) -> Order:
    """All functions, callees first (members of a cycle in any order among themselves), and the cycles."""
    keys = list(cfgs)
    numbers = {key: number for number, key in enumerate(keys)}
    following = [[numbers[k] for k in callees(cfg) if k in numbers] for cfg in cfgs.values()]
    functions: list[int] = []
    cycles: list[Cycle] = []
    for component in strong_components(following, range(len(keys))):
        functions += [keys[number] for number in component]
        if len(component) > 1 or component[0] in following[component[0]]:
            path = _way_round(component, following)
            cycles.append(Cycle(frozenset(keys[n] for n in component), tuple(keys[n] for n in path)))
    return Order(tuple(functions), tuple(cycles))


def _way_round(component: list[int], following: list[list[int]]) -> list[int]:
    """A shortest cycle through the member that comes first in the program."""
    start = min(component)
    members = set(component)
    parent: dict[int, int] = {}
    frontier = [start]
    while frontier:
        reached: list[int] = []
        for node in frontier:
            for target in following[node]:
                if target == start:
                    path = [node]
                    while path[-1] != start:
                        path.append(parent[path[-1]])
                    return [*reversed(path), start]
                if target in members and target not in parent:
                    parent[target] = node
                    reached.append(target)
        frontier = reached
    raise AssertionError("a strongly connected component has a cycle")
