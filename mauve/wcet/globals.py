"""Which objects of a binary a function reads and writes, as far as the addresses of its accesses are known."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator

from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.microop import Store, StoreUnknown
from mauve.wcet.flow.result import FunctionFlow, ProgramFlow
from mauve.wcet.result import GlobalUse


def global_uses(program: ProgramFlow, binary: Binary) -> tuple[GlobalUse, ...]:
    """The writable objects that the functions of a program access on feasible paths, by name. An access at a variable
    place counts for the object in which it begins: an index does not leave its array."""
    objects = [symbol for symbol in binary.objects if _is_writable(binary, symbol.address)]
    starts = [symbol.address for symbol in objects]
    found: dict[str, list[bool]] = {}
    for flow in program.functions.values():
        for address, writes in _accesses(flow):
            at = bisect_right(starts, address) - 1
            if at >= 0 and address < objects[at].address + max(objects[at].size, 1):
                found.setdefault(objects[at].name, [False, False])[writes] = True
    return tuple(GlobalUse(name, reads, writes) for name, (reads, writes) in sorted(found.items()))


def _is_writable(binary: Binary, address: int) -> bool:
    segment = binary.segment_at(address)
    return segment is not None and segment.writable and binary.read_constant(address, 1) is None


def _accesses(flow: FunctionFlow) -> Iterator[tuple[int, bool]]:
    """The first byte of each access at a known place, and whether it writes."""
    live = {edge.source for index, edge in enumerate(flow.cfg.edges) if index not in flow.infeasible}
    for number in live:
        for instruction in flow.cfg.blocks[number].instructions:
            for index, op in enumerate(instruction.ops):
                place = flow.accesses.get((instruction.address, index))
                if place is not None:
                    yield place.low, isinstance(op, Store | StoreUnknown)
