"""Assuming something of a value never loses a number for which it holds."""

from __future__ import annotations

from random import Random

from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MASK, Range
from mauve.wcet.flow.state import State, Symbols

FACTORS = (1, -1, 2, 3, -4, 7, 100, 256, -256, 4096, 65536, -65536, 1 << 20, 1 << 24, -(1 << 28), 1 << 31)


def number(random: Random) -> int:
    near = random.choice([0, 1, 255, 65535, 65536, 524288, 1 << 31, MASK]) + random.randint(-12, 12)
    return random.choice([near, random.getrandbits(32)]) & MASK


def a_range(random: Random) -> Range:
    count = random.choice([0, 1, 2, 9, 65535, 65534, 255, random.getrandbits(20)])
    step = random.choice([1, 1, 1, 2, 4, 8, 65536])
    return domain.progression(number(random), step, min(count, MASK // step))


def members(known: Range, random: Random) -> list[int]:
    places = {0, 1, 2, 8, 9, known.n, known.n - 1, *(random.randint(0, known.n) for _ in range(12))}
    return [(known.low + known.step * place) & MASK for place in places if 0 <= place <= known.n]


def test_what_fits_an_assumption_is_kept() -> None:
    random = Random(1)
    for _ in range(2_500):
        state = State(Symbols())
        known = a_range(random)
        symbol = state.fresh(known)
        if isinstance(symbol, int):
            continue
        factor, offset = random.choice(FACTORS), number(random)
        value = (offset, symbol[1], factor)
        wanted = random.choice(members(known, random))
        low = (offset + factor * wanted - random.choice([0, 0, 1, 70_000])) & MASK
        high = (offset + factor * wanted + random.choice([0, 0, 3, 1 << 20])) & MASK
        fitting = [m for m in members(known, random) if (offset + factor * m - low) & MASK <= (high - low) & MASK]
        holds = state.require(value, low, high)
        if fitting:
            assert holds, (known, factor, offset, low, high)
            left = state.range_of(state.pinned(symbol))
            assert all(m in left for m in fitting), (known, factor, offset, low, high, left)
