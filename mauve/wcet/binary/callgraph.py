"""All functions that an entry reaches: their graphs, who calls whom, and in which order to analyse them."""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Mapping
from dataclasses import dataclass, replace

from mauve.wcet.binary.cfg import INSTRUCTION_LIMIT, Control, build_cfg
from mauve.wcet.binary.decode import Decoder
from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import Cfg, EdgeKind
from mauve.wcet.binary.loops import strong_components
from mauve.wcet.binary.subroutine import put_into_callers
from mauve.wcet.clock import Deadline, check

PROGRAM_LIMIT = 2_000_000
"""How many instructions of a whole program are looked at before giving up."""

CLOSED_LIMIT = 16
"""How many instructions of a closed function are looked at."""


def callees(cfg: Cfg) -> tuple[int, ...]:
    """The keys of the functions that a function calls or ends in, each once, in order of address of the call."""
    return tuple(dict.fromkeys(key for edge in cfg.edges for key in edge.callees))


def build_program(
    binary: Binary, entry: int, control: Control | None = None, limit: int = PROGRAM_LIMIT
) -> Mapping[int, Cfg]:
    """The graphs of `entry` (a key) and of everything it calls, by key; see `Graphs`."""
    return Graphs(binary, control, limit).program(entry)


class Graphs:
    """The graphs of a binary's functions under fixed control facts, each made once whatever entries reach it.

    Functions without a way to return are found on the way: calls of them end their path. Functions that reach each
    other by tail calls alone are a loop, not a recursion: they are put into one graph. Both depend on nothing but what
    a function reaches, so a graph is the same for every entry.
    """

    def __init__(self, binary: Binary, control: Control | None = None, limit: int = PROGRAM_LIMIT) -> None:
        self._binary, self._control, self._limit = binary, control or Control(), limit
        self._decoder = Decoder(binary.read_code)
        self._settled: dict[int, Cfg] = {}
        self.instructions = 0
        """how many instructions all graphs hold"""

    def program(self, entry: int, deadline: Deadline = None) -> Mapping[int, Cfg]:
        """The graphs of `entry` (a key) and of everything it calls, by key. Raises OutOfTime: what is not complete
        then is not kept."""
        if entry not in self._settled:
            self._settle(entry, deadline)
        return {key: self._settled[key] for key in _reachable(self._settled, entry)}

    def _settle(self, entry: int, deadline: Deadline) -> None:
        control, cfgs = self._control, dict[int, Cfg]()
        while True:
            self._close(entry, control, cfgs, deadline)
            check(deadline, entry & ~1, self._binary.name_at(entry))
            everything = ChainMap(cfgs, self._settled)
            known = {key: everything[key] for key in _reachable(everything, *cfgs)}
            silent = _without_return(known) - control.no_return
            if silent:
                control = replace(control, no_return=control.no_return | silent)
                affected = [key for key, cfg in cfgs.items() if silent & set(callees(cfg))]
            else:
                rings = _tail_rings(known) - control.inline
                if not rings:
                    break
                control = replace(control, inline=control.inline | rings)
                affected = [key for key, cfg in cfgs.items() if rings & set(_tail_callees(cfg))]
            for key in affected:
                cfgs[key] = build_cfg(self._binary, key, control, self._decoder, deadline=deadline)
        self._control = control
        known = put_into_callers(known, self._binary)
        for key in _reachable(known, entry):
            if key not in self._settled:
                self._settled[key] = known[key]
                self.instructions += _size(known[key])

    def _close(self, entry: int, control: Control, cfgs: dict[int, Cfg], deadline: Deadline) -> None:
        """Add the graphs of all functions that are called and not there yet."""
        work = [entry, *(key for cfg in cfgs.values() for key in callees(cfg))]
        spent = sum(_size(cfg) for cfg in cfgs.values())
        while work:
            key = work.pop()
            if key in cfgs or key in self._settled:
                continue
            closed = key in control.closed
            limit = CLOSED_LIMIT if closed else max(1, min(INSTRUCTION_LIMIT, self._limit - spent))
            cfg = build_cfg(self._binary, key, control, self._decoder, limit, deadline)
            if closed:
                cfg = replace(cfg, edges=tuple(replace(edge, callees=()) for edge in cfg.edges))
            spent += _size(cfg)
            cfgs[key] = cfg
            work += callees(cfg)


def _size(cfg: Cfg) -> int:
    return sum(len(block.instructions) for block in cfg.blocks)


def _reachable(cfgs: Mapping[int, Cfg], *entries: int) -> list[int]:
    seen: dict[int, None] = {}
    work = list(entries)
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
            path = way_round(component, following)
            cycles.append(Cycle(frozenset(keys[n] for n in component), tuple(keys[n] for n in path)))
    return Order(tuple(functions), tuple(cycles))


def way_round(component: list[int], following: list[list[int]]) -> list[int]:
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
