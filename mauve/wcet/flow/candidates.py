"""Calls through pointers whose targets stay unknown, and what they may lead to: the functions whose address the binary
takes. That is a help for who states the targets, and it keeps what may be executed in the result; it bounds nothing.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mauve.wcet.binary.elf import Binary, Symbol
from mauve.wcet.binary.graph import Cfg, EdgeKind, Unresolved, UnresolvedKind
from mauve.wcet.binary.microop import IndirectJump
from mauve.wcet.result import Problem, ProblemKind

MOST = 256
"""How many candidates are looked at; a program with more is an operating system, and any would do."""
NAMED = 6
"""How many candidates a message names."""
_KINDS = {UnresolvedKind.CALL: ProblemKind.CALL, UnresolvedKind.BRANCH: ProblemKind.BRANCH}


def open_calls(cfg: Cfg) -> dict[int, Unresolved]:
    """The holes of a graph through which functions may be called, by address: calls, and jumps that may be the last
    call of the function; not jumps through tables."""
    holes = {hole.address: hole for hole in cfg.unresolved if hole.kind in _KINDS}
    if not holes:
        return {}
    last = (block.instructions[-1] for block in cfg.blocks)
    jumps = {i.address for i in last if isinstance(i.flow, IndirectJump) and i.flow.exchanges}
    return {at: hole for at, hole in holes.items() if hole.kind is UnresolvedKind.CALL or at in jumps}


def open_edges(cfg: Cfg) -> Iterator[tuple[int, int]]:
    """The edges (by index) by which control goes into such holes, with their addresses."""
    holes = open_calls(cfg)
    for index, edge in enumerate(cfg.edges) if holes else ():
        at = cfg.blocks[edge.source].instructions[-1].address
        if at in holes and edge.kind in (EdgeKind.CALL, EdgeKind.STOP) and not edge.callees:
            yield index, at


def pointer_problems(cfg: Cfg, candidates: Sequence[int], binary: Binary) -> tuple[Problem, ...]:
    """What is said of the open calls of a function: how many candidates (keys) there are, and the fact that names the
    targets, to be shortened."""
    if not candidates:
        return ()
    names = [_name(key, binary) for key in candidates]
    found = []
    for at, hole in open_calls(cfg).items():
        if len(names) > MOST:
            count = f"the binary takes the address of {len(names)} functions, too many to look at"
            found.append(Problem(_KINDS[hole.kind], f"{hole.message}; {count}", at, cfg.name))
            continue
        shown = ", ".join(name.strip('"') for name in names[:NAMED])
        more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
        what = "function has its address" if len(names) == 1 else "functions have their address"
        message = f"{hole.message}; {len(names)} {what} taken ({shown}{more})"
        fact = f"targets {at:#x} to {', '.join(names)}"
        found.append(Problem(_KINDS[hole.kind], message, at, cfg.name, suggestions=(fact,)))
    return tuple(found)


def _name(key: int, binary: Binary) -> str:
    """A function as a fact names it: by its symbol where that means it alone."""
    symbol = binary.symbol_at(key)
    found = None if symbol is None else binary.function(symbol.name)
    return f'"{found.name}"' if isinstance(found, Symbol) and found.key == key else f"{key & ~1:#x}"
