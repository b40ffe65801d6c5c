"""What the walk asks of the binary and of the value analysis: constants, accesses, names, effects of calls."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence

from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.graph import Edge
from mauve.wcet.binary.microop import SP
from mauve.wcet.flow.domain import MASK
from mauve.wcet.flow.effects import UNKNOWN, Place, Summary
from mauve.wcet.flow.exclusive.walk import Written
from mauve.wcet.flow.image import Image
from mauve.wcet.flow.linear import FRAME
from mauve.wcet.flow.locations import Base, Cell, Region
from mauve.wcet.flow.state import ABSOLUTE


class FunctionMemory:
    """The memory that a function sees: `places` are those that its accesses touch whatever it is called with."""

    def __init__(self, image: Image, places: Mapping[tuple[int, int], Place]) -> None:
        self._image, self._places = image, places

    def constant(self, cell: Cell) -> int | None:
        """Read-only data."""
        return self._image.constant(cell.offset, cell.size) if cell.base is Base.ABSOLUTE else None

    def tracked(self, cell: Cell) -> bool:
        """Memory of the binary changes only by its own code (a listed assumption); other addresses may be devices."""
        return cell.base is Base.ABSOLUTE and self._image.constant(cell.offset, 0) is not None

    def access(self, address: int, index: int) -> Region | None:
        """The bytes touched by a micro-operation."""
        place = self._places.get((address, index))
        if place is None or place[0] not in (FRAME, ABSOLUTE):
            return None
        return Region(Base.SP if place[0] == FRAME else Base.ABSOLUTE, place[1], place[2])


def written(edges: Sequence[Edge], summaries: Mapping[int, Summary]) -> dict[int, Written]:
    """What the call on each edge may write."""
    return {
        index: Written(
            tuple(
                dict.fromkeys(
                    place
                    for callee in edge.callees
                    for found in summaries.get(callee, UNKNOWN).writes
                    for place in _seen_by_caller(found)
                )
            )
        )
        for index, edge in enumerate(edges)
        if edge.callees
    }


def _seen_by_caller(place: Place) -> list[tuple[int | Base | None, int, int]]:
    """A place in the words of the walk: what lies below the callee's entry sp is nothing to the caller."""
    region, low, high = place
    if region is None or (region == ABSOLUTE and not 0 <= low <= high <= MASK):
        return [(None, 0, MASK)]
    if region == ABSOLUTE:
        return [(Base.ABSOLUTE, low, high)]
    if region == FRAME:
        return [(SP, max(low, 0), high)] if high >= 0 else []
    return [(region - 1, low, high)]


class Names:
    """The names of a binary's objects by address."""

    def __init__(self, binary: Binary) -> None:
        self._objects = binary.objects
        self._starts = [symbol.address for symbol in binary.objects]

    def __call__(self, address: int) -> str:
        """`mode`, or `state+4`; empty where no object is."""
        at = bisect_right(self._starts, address) - 1
        if at < 0 or address >= self._objects[at].address + max(self._objects[at].size, 1):
            return ""
        distance = address - self._objects[at].address
        return f"{self._objects[at].name}+{distance}" if distance else self._objects[at].name
