"""Which conditional instructions between two changes of the flags can execute together."""

from __future__ import annotations

from functools import lru_cache
from itertools import product

from mauve.wcet.binary.microop import Condition


def holds(condition: Condition, n: bool, z: bool, c: bool, v: bool) -> bool:
    """Whether a condition holds for the flags N, Z, C and V (ARM Architecture Reference Manual, table A3-1)."""
    base = (z, c, n, v, c and not z, n == v, not z and n == v, True)[condition.value >> 1]
    return base if condition.value % 2 == 0 else not base


@lru_cache(maxsize=4096)
def outcomes(conditions: frozenset[Condition]) -> tuple[frozenset[Condition], ...]:
    """Every set of those conditions that holds for some value of the flags, while all others fail."""
    found = {
        frozenset(condition for condition in conditions if holds(condition, *flags))
        for flags in product((False, True), repeat=4)
    }
    return tuple(sorted(found, key=lambda held: sorted(condition.value for condition in held)))
