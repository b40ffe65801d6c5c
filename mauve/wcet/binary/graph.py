"""The control flow graph of a function, recovered from its binary.

Blocks are numbered from 0 in order of address, block 0 is not necessarily the entry. Calls live on edges: an edge of
kind CALL goes from the calling block to the block after the call and names its callees; a tail call is an edge to EXIT.
A conditional call or return has a second, plain edge for the case that it does not happen.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

from mauve.wcet.binary.microop import Instruction

EXIT = -1
"""The target of edges that leave the function."""


class EdgeKind(Enum):
    """How control passes along an edge."""

    FALL = "fall"
    """to the next instruction: no branch, or one not taken"""
    TAKEN = "taken"
    """a direct branch taken"""
    SWITCH = "switch"
    """an indirect branch with known targets"""
    CALL = "call"
    """through the callees to the instruction after the call"""
    RETURN = "return"
    """out of the function"""
    TAIL_CALL = "tail"
    """out of the function through the callees"""
    STOP = "stop"
    """nowhere: a trap, or a call that does not return; the edge goes to EXIT"""


@dataclass(frozen=True, slots=True)
class Edge:
    """From block `source` to block `target` (or EXIT). `callees` are entry addresses, bit 0 set for Thumb."""

    source: int
    target: int
    kind: EdgeKind
    callees: tuple[int, ...] = ()


@dataclass(frozen=True, slots=True)
class Block:
    """A straight run of instructions: control enters at the first and leaves after the last."""

    id: int
    instructions: tuple[Instruction, ...]

    @property
    def address(self) -> int:
        """The address of the first instruction."""
        return self.instructions[0].address

    @property
    def size(self) -> int:
        """Bytes covered."""
        return self.instructions[-1].end - self.address


class UnresolvedKind(Enum):
    """Why a piece of control flow is not known."""

    BRANCH = "branch"
    """an indirect jump without known targets"""
    CALL = "call"
    """an indirect call without known targets"""
    DECODE = "decode"
    """bytes that are no instruction we know"""
    OUTSIDE = "outside"
    """control leaves the code of the binary"""
    SUPERVISOR = "supervisor"
    """a supervisor call"""
    LIMIT = "limit"
    """more instructions than the analysis is allowed to look at"""


@dataclass(frozen=True, slots=True)
class Unresolved:
    """A hole in a control flow graph: it makes every bound of the function an error."""

    address: int
    kind: UnresolvedKind
    message: str


@dataclass(frozen=True, slots=True)
class Cfg:
    """A function. Invariants: edges name existing blocks or EXIT; every block is reachable from `entry`; blocks do
    not overlap in the addresses of their instructions; `entry` has the function's address. A function whose first
    bytes are no instruction has no blocks, and an `unresolved` that says so. Splitting irreducible regions adds
    copies of blocks: then several blocks may have the same instructions, and ids do not follow addresses."""

    name: str
    address: int
    thumb: bool
    entry: int
    blocks: tuple[Block, ...]
    edges: tuple[Edge, ...]
    unresolved: tuple[Unresolved, ...] = ()

    @property
    def key(self) -> int:
        """The entry address with bit 0 set for Thumb, as callees are named."""
        return self.address | self.thumb

    def __str__(self) -> str:
        return format_cfg(self)


def format_cfg(cfg: Cfg) -> str:
    """The graph as text, a block a paragraph: its instructions and the edges that leave it."""
    lines = [f"function {cfg.name} at {cfg.address:#x} ({'thumb' if cfg.thumb else 'arm'}), entry b{cfg.entry}"]
    for block in cfg.blocks:
        lines.append(f"b{block.id}:")
        lines += [f"    {instruction}" for instruction in block.instructions]
        for edge in cfg.edges:
            if edge.source == block.id:
                target = "exit" if edge.target == EXIT else f"b{edge.target}"
                via = " via " + ", ".join(f"{callee & ~1:#x}" for callee in edge.callees) if edge.callees else ""
                lines.append(f"    -> {target} {edge.kind.value}{via}")
    lines += [f"unresolved {hole.kind.value} at {hole.address:#x}: {hole.message}" for hole in cfg.unresolved]
    return "\n".join(lines)
