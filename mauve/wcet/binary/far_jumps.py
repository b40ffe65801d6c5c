"""Thumb `bl` that is a jump: compilers for cores without a long branch write it inside functions of more than 2 KB.

`bl` sets lr and jumps. Where nothing behind it reads lr before it is written again, that is all the same as a jump:
control never comes back behind the `bl` by it.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable

from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import Cfg, EdgeKind
from mauve.wcet.binary.microop import LR, Call, Condition, Instruction


def may_be_far(binary: Binary, instruction: Instruction, call: Call) -> bool:
    """Whether a call goes from within a function into the middle of the same one."""
    if not (instruction.thumb and call.thumb) or binary.symbol_at(call.target) is not None:
        return False
    function = binary.function_at(call.target)
    return function is not None and function.size > 0 and function is binary.function_at(instruction.address)


def link_read_behind(cfg: Cfg, jumps: Collection[int]) -> frozenset[int]:
    """Those of the `bl` in `jumps` (addresses; in the graph they are jumps) behind which lr may be read."""
    live = _live_at_start(cfg) if jumps else set()
    last = {block.id: block.instructions[-1].address for block in cfg.blocks}
    return frozenset(last[e.source] for e in cfg.edges if e.target in live and last[e.source] in jumps)


def _live_at_start(cfg: Cfg) -> set[int]:
    """The blocks at whose start lr may be read before it is written; of what is behind a hole in the graph nothing is
    known."""
    ways_out = {EdgeKind.TAIL_CALL, EdgeKind.STOP} if cfg.unresolved else {EdgeKind.TAIL_CALL}
    sources: dict[int, list[int]] = {}
    leaving: set[int] = set()
    for edge in cfg.edges:
        sources.setdefault(edge.target, []).append(edge.source)
        if edge.kind in ways_out:
            leaving.add(edge.source)
    live = {block.id for block in cfg.blocks if _reads(block.instructions, block.id in leaving)}
    work = list(live)
    while work:
        for source in sources.get(work.pop(), ()):
            if source not in live and _reads(cfg.blocks[source].instructions, True):
                live.add(source)
                work.append(source)
    return live


def _reads(instructions: Iterable[Instruction], behind: bool) -> bool:
    """Whether lr may be read before it is written, when it may be read `behind` the instructions or not."""
    for instruction in instructions:
        traits = instruction.traits
        if LR in traits.reads or LR in traits.late_reads:
            return True
        if LR in traits.writes and instruction.condition is Condition.AL:
            return False
    return behind
