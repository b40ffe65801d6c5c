"""Bounds of loops in run-time helpers (libgcc, compiler-rt) that no general argument of ours proves.

A helper is recognised by a fingerprint of all its instructions, not by its name: registers, immediates and relative
branches count, the addresses of callees and where it was linked do not. So the code that establishes the condition
on which a loop is entered is part of what is recognised. For each loop the table holds the greatest number of
executions of its first instruction in one call of the helper, and why; that is a bound per entry of any loop with this
header, also of a copy that node splitting made.
"""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources

from mauve.wcet.binary.graph import EXIT, Cfg, Edge, EdgeKind
from mauve.wcet.binary.loops import Loop
from mauve.wcet.binary.microop import Call, CompareBranch, IndirectJump, Instruction, Jump
from mauve.wcet.flow.ranking import RankBound

FORMAT = 1
"""Changes with the way a fingerprint is made; the table names the one it was made with."""


@dataclass(frozen=True, slots=True)
class KnownLoop:
    """A loop of a known helper: `offset` of its header from the function's start, executions of the header per call."""

    offset: int
    total: int
    proof: str


@dataclass(frozen=True, slots=True)
class KnownFunction:
    """A helper: its names and where this code was found."""

    names: tuple[str, ...]
    found: tuple[str, ...]
    loops: tuple[KnownLoop, ...]


def library_bound(cfg: Cfg, loop: Loop) -> RankBound | None:
    """The bound of a loop of a known helper, None for any other loop."""
    table = known_functions()
    if cfg.unresolved:
        return None
    for start, blocks in _parts(cfg):
        if loop.header not in blocks:
            continue
        address = cfg.blocks[start].address
        known = table.get(_fingerprint(cfg, address, blocks))
        offset = cfg.blocks[loop.header].address - address
        for entry in known.loops if known is not None else ():
            if entry.offset == offset:
                return RankBound(entry.total, f"known helper {known.names[0] if known is not None else ''}")
    return None


def fingerprint(cfg: Cfg) -> str:
    """The hash of a function's instructions in order of address, each once, with addresses outside it left out."""
    return _fingerprint(cfg, cfg.address, _parts(cfg)[0][1])


def _parts(cfg: Cfg) -> list[tuple[int, frozenset[int]]]:
    """The function and the subroutines that were put into its graph, which the table knows apart: the first block and
    all blocks of each. A call that is no call edge leads into such a subroutine, which comes back behind it."""
    leaving: dict[int, list[Edge]] = {}
    for edge in cfg.edges:
        leaving.setdefault(edge.source, []).append(edge)
    parts: list[tuple[int, frozenset[int]]] = []
    starts = [cfg.entry]
    for start in starts:
        seen, work = {start}, [start]
        while work:
            block = work.pop()
            flow = cfg.blocks[block].instructions[-1].flow
            following: list[int] = []
            for edge in leaving.get(block, ()):
                inside = isinstance(flow, Call) and edge.kind is EdgeKind.TAKEN
                if inside:
                    starts.append(edge.target)
                    following += [b.id for b in cfg.blocks if b.address == cfg.blocks[block].instructions[-1].end][:1]
                elif edge.target != EXIT and not (
                    edge.kind is EdgeKind.SWITCH and isinstance(flow, IndirectJump) and flow.returns
                ):
                    following.append(edge.target)
            fresh = [target for target in following if target not in seen]
            seen.update(fresh)
            work += fresh
        parts.append((start, frozenset(seen)))
    return parts


def _fingerprint(cfg: Cfg, start: int, blocks: frozenset[int]) -> str:
    instructions = {i.address: i for block in blocks for i in cfg.blocks[block].instructions}
    inside = set(instructions)
    words = [f"format {FORMAT} {'thumb' if cfg.thumb else 'arm'}"]
    words += [_normal(instructions[address], start, inside) for address in sorted(instructions)]
    return hashlib.sha256("\n".join(words).encode()).hexdigest()[:32]


def _normal(instruction: Instruction, start: int, inside: set[int]) -> str:
    """Offset, condition and text; a branch as its mnemonic and relative target."""
    text = instruction.text
    match instruction.flow:
        case Jump(target) | CompareBranch(target=target):
            operands = text.partition(" ")[2].rpartition("#")[0]
            place = f"{target - start:+d}" if target in inside else "out"
            text = f"{text.partition(' ')[0]} {operands}{place}"
        case Call():
            text = f"{text.partition(' ')[0]} call"
    return f"{instruction.address - start} {instruction.condition.name} {text}"


@cache
def known_functions() -> Mapping[str, KnownFunction]:
    """The table, by fingerprint."""
    table: dict[str, KnownFunction] = {}
    for item in resources.files("mauve.wcet.flow").joinpath("library").iterdir():
        if item.name.endswith(".toml"):
            table.update(read_table(item.read_text(encoding="utf-8")))
    return table


def read_table(text: str) -> dict[str, KnownFunction]:
    """A table file; one of another format is empty."""
    data = tomllib.loads(text)
    if data.get("format") != FORMAT:
        return {}
    proofs: dict[str, str] = data["proofs"]
    return {
        entry["fingerprint"]: KnownFunction(
            tuple(entry["names"]),
            tuple(entry["found"]),
            tuple(KnownLoop(loop["offset"], loop["total"], proofs[loop["proof"]]) for loop in entry["loops"]),
        )
        for entry in data["function"]
    }
