"""Bounds of loops in library routines (libgcc, compiler-rt, newlib) that no general argument of ours proves.

A helper is recognised by a fingerprint of all its instructions, not by its name: registers, immediates and relative
branches count, the addresses of callees and where it was linked do not. So the code that establishes the condition
on which a loop is entered is part of what is recognised. For each loop the table holds the greatest number of
executions of its first instruction in one call of the helper, and why; that is a bound per entry of any loop with this
header, also of a copy that node splitting made. Where a routine goes through memory whose size is an argument, the
number is a formula of that argument on entry: "r2 / 16 + 1", by the greatest value that it can have in a context.
"""

from __future__ import annotations

import hashlib
import tomllib
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib import resources
from math import prod
from typing import Any

from mauve.wcet.binary.graph import EXIT, Cfg, Edge, EdgeKind
from mauve.wcet.binary.loops import Loop
from mauve.wcet.binary.microop import Call, CompareBranch, IndirectJump, Instruction, Jump

FORMAT = 1
"""Changes with the way a fingerprint is made; the table names the one it was made with."""


SUBNORMAL = ("single-denormal", "double-denormal")
"""The proofs of loops that are entered for subnormal operands only."""

LARGEST = 1 << 20
"""A formula of a greater argument is no bound: that is the range of a type, not what somebody knows."""


STRING = 16
"""STRING + n stands for the length, with the 0 at its end, of the string that register n points to on entry."""

Term = tuple[tuple[int, ...], int, int]
"""A product of registers on entry (by number, or STRING and more) with a factor, rounded down after a division."""


@dataclass(frozen=True, slots=True)
class Formula:
    """The least of some sums of terms; no registers: a constant. It grows with each register, and is 1 at least."""

    sums: tuple[tuple[Term, ...], ...]

    def most(self, greatest: Callable[[int], int] | None) -> int | None:
        """Its greatest value where `greatest` tells how large a register can be; None: not known."""
        known = [value for terms in self.sums if (value := _most(terms, greatest)) is not None]
        return min(known, default=None)

    def registers(self) -> frozenset[int]:
        """What it depends on."""
        return frozenset(register for terms in self.sums for term in terms for register in term[0])


def _most(terms: tuple[Term, ...], greatest: Callable[[int], int] | None) -> int | None:
    registers = {register for term in terms for register in term[0]}
    if registers and greatest is None:
        return None
    values = {register: greatest(register) for register in registers} if greatest is not None else {}
    if any(value > LARGEST for value in values.values()):
        return None
    parts = (factor * prod(values[r] for r in product) // divisor for product, factor, divisor in terms)
    return max(1, sum(parts))


def read_formula(text: str | int) -> Formula:
    """A formula as tables write it: `7`, or `r1 * r1 / 2 + 3 * r1 + 1`, or `s0 / 4 + 2 or s1 / 4 + 2` with the lengths
    of strings."""
    return Formula(tuple(_read_sum(one) for one in str(text).split(" or ")))


def _read_sum(text: str) -> tuple[Term, ...]:
    terms = []
    for term in text.split(" + "):
        product, _, divisor = term.partition(" / ")
        factors = product.split(" * ")
        registers = tuple(int(f[1:]) + (STRING if f[0] == "s" else 0) for f in factors if f[0] in "rs")
        terms.append((registers, prod(int(f) for f in factors if f[0] not in "rs"), int(divisor or "1")))
    return tuple(terms)


@dataclass(frozen=True, slots=True)
class KnownLoop:
    """A loop of a known routine: `offset` of its header from the function's start, executions of the header per call:
    `total`. `each`: those per entry of the loop, where it is known to be entered more often than once with fewer each
    time. `subnormal`: it is entered for subnormal operands only. `exchanges`: it
    exchanges elements that are sorted, 1: by bytes, so only where their place or size is no multiple of 4; 4: one by
    one by words, so only where their size is not 4."""

    offset: int
    total: Formula
    proof: str
    each: Formula | None = None
    subnormal: bool = False
    exchanges: int = 0


@dataclass(frozen=True, slots=True)
class KnownFunction:
    """A helper: its names and where this code was found. A routine that `sorts` calls its argument r3 to compare r1
    elements of r2 bytes; it has a frame of `stack` bytes and does not call itself for up to `most` elements."""

    names: tuple[str, ...]
    found: tuple[str, ...]
    loops: tuple[KnownLoop, ...]
    sorts: bool = False
    most: int = 0
    stack: int = 0


@dataclass(frozen=True, slots=True)
class Recognised:
    """A known routine found in a function: the address and the blocks of its code; `whole` where it is the function,
    and not a subroutine that was put into its graph."""

    known: KnownFunction
    address: int
    blocks: frozenset[int]
    whole: bool


@dataclass(frozen=True, slots=True)
class KnownBound:
    """At most `bound` executions of a loop's header per entry, at most `total` in one call of the function if that is
    not None; `method` names the routine."""

    bound: int
    method: str
    total: int | None = None


def recognise(cfg: Cfg) -> tuple[Recognised, ...]:
    """The known routines of which a function consists."""
    if cfg.unresolved:
        return ()
    table, found = known_functions(), []
    for start, blocks in _parts(cfg):
        address = cfg.blocks[start].address
        known = table.get(_fingerprint(cfg, address, blocks))
        if known is not None:
            found.append(Recognised(known, address, blocks, start == cfg.entry))
    return tuple(found)


def library_bound(
    cfg: Cfg,
    loop: Loop,
    greatest: Callable[[int], int] | None = None,
    recognised: tuple[Recognised, ...] | None = None,
) -> KnownBound | None:
    """The bound of a loop of a known routine, None for any other loop. `greatest` gives the greatest value that a
    register (0 to 3) can have on entry, without sign, and the greatest length of a string (STRING + 0 to 3); None:
    nothing is known of arguments. `recognised` is what
    `recognise` finds, if that is known already."""
    for part in recognise(cfg) if recognised is None else recognised:
        offset = cfg.blocks[loop.header].address - part.address
        for entry in part.known.loops if loop.header in part.blocks else ():
            if entry.offset == offset:
                return known_bound(part.known, entry, greatest if part.whole else None, part.whole)
    return None


def known_bound(
    known: KnownFunction, loop: KnownLoop, greatest: Callable[[int], int] | None, whole: bool
) -> KnownBound | None:
    """The bound of a loop of the table; `whole`: its function is called once in an execution of the graph's."""
    most = loop.total.most(greatest)
    each = most if loop.each is None else loop.each.most(greatest)
    if most is None or each is None:
        return None
    total = most if loop.each is not None and whole else None
    return KnownBound(min(each, most), f"known helper {known.names[0]}", total)


def fingerprint(cfg: Cfg) -> str:
    """The hash of a function's instructions in order of address, each once, with addresses outside it left out."""
    return _fingerprint(cfg, cfg.address, _parts(cfg)[0][1])


MOST_PARTS = 32
"""Subroutines that are told apart in one graph; the routines of the table have a few each."""


def _parts(cfg: Cfg) -> list[tuple[int, frozenset[int]]]:
    """The function and the subroutines that were put into its graph, which the table knows apart: the first block and
    all blocks of each. A call that is no call edge leads into such a subroutine, which comes back behind it (or it is a
    far jump, and what it leads to is no routine of the table)."""
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
                    if edge.target not in starts and len(starts) < MOST_PARTS:
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
            tuple(_known_loop(loop, proofs) for loop in entry["loops"]),
            entry.get("sorts", False),
            entry.get("most", 0),
            entry.get("stack", 0),
        )
        for entry in data.get("function", ())
    }


def _known_loop(entry: Mapping[str, Any], proofs: Mapping[str, str]) -> KnownLoop:
    """A loop of the table: its bound is a `total`, or a formula of arguments."""
    each = read_formula(entry["each"]) if "each" in entry else None
    total = read_formula(entry["bound"] if "bound" in entry else entry["total"])
    subnormal = entry["proof"] in SUBNORMAL
    return KnownLoop(entry["offset"], total, proofs[entry["proof"]], each, subnormal, entry.get("exchanges", 0))
