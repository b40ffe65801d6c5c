"""What taking an edge of a jump through a table says of its index: that the entry there leads to the target."""

from __future__ import annotations

from typing import Protocol

from mauve.wcet.flow.exclusive.facts import Facts, Numbers, ValueKey, between, united
from mauve.wcet.flow.locations import WORD, Base, Cell
from mauve.wcet.flow.rank.terms import Term

MOST_ENTRIES = 256
"""Entries of a table that are looked at."""


class Constants(Protocol):
    """Memory that is never written."""

    def constant(self, cell: Cell) -> int | None:
        """The number in an absolute cell, if it is never written."""


def table_facts(
    address: Term, size: int, unit: int, origin: int, known: Facts, memory: Constants, target: int
) -> Facts:
    """The numbers that the index may have when control goes to `target` = origin + unit * entry, with the entry of
    `size` bytes at `address`; nothing where the entries are not known."""
    if len(address.parts) != 1:
        return {}
    ((of, factor),) = address.parts
    key = ValueKey(frozenset({(of, 1)}))
    allowed = known.get(key)
    if allowed is None or sum(high - low + 1 for low, high in allowed) > MOST_ENTRIES:
        return {}
    numbers: Numbers = ()
    for low, high in allowed:
        for value in range(low, high + 1):
            entry = memory.constant(Cell(Base.ABSOLUTE, (address.constant + factor * value) % WORD, size))
            if entry is None:
                return {}
            if (origin + unit * entry) % WORD & ~1 == target:
                numbers = united(numbers, between(value, value))
    return {key: numbers} if numbers else {}
