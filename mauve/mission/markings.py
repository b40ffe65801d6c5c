"""The graph of all markings, transient ones too: what the paper computes, and what checks our short cut.

It is not needed for the alternatives graph; it is made on request, for comparison and as an oracle.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeAlias

from mauve.mission.cascades import armed, bits, masks
from mauve.mission.graph import BudgetExceeded, MarkingsGraph
from mauve.mission.net import Level, Net, marking
from mauve.mission.stable import initial_marking, multipliers
from mauve.mission.verify import verify
from mauve.records import record

if TYPE_CHECKING:
    import numpy

    Words: TypeAlias = "numpy.ndarray[Any, numpy.dtype[numpy.uint64]]"

BUDGET = 20_000_000
"""Markings, where nobody says otherwise."""

PLAIN = 12_000
"""Markings for which numpy is not worth its import."""


@record
class Explored:
    """All markings in breadth-first order; edges (source, transition, target); which markings are stable; safety."""

    markings: tuple[int, ...]
    edges: tuple[tuple[int, int, int], ...]
    stable: tuple[int, ...]
    safe: bool


def explore(net: Net, budget: int = 1_000_000) -> Explored | BudgetExceeded:
    """All markings of a small net with their edges, numbered breadth first, transitions in order of declaration."""
    table = masks(net)
    inner = [index for index, level in enumerate(table.levels) if level]
    outer = [index for index, level in enumerate(table.levels) if not level]
    start = initial_marking(net)
    numbers = {start: 0}
    queue = [(start, sum(1 << index for index in inner))]
    edges, stable, safe = [], [], True
    for number, (state, candidates) in enumerate(queue):
        enabled = 0
        for index in bits(candidates & armed(table, state)):
            if not table.before[index] & ~state:
                enabled |= 1 << index
        chosen = next((mask for one in table.by_level[:0:-1] if (mask := enabled & one)), 0)
        if chosen:
            firing = list(bits(chosen))
        else:
            stable.append(number)
            firing = [index for index in outer if not table.before[index] & ~state]
        for index in firing:
            filled = table.filled[index]
            safe = safe and not state & filled
            after = state & ~table.taken[index] | filled
            target = numbers.get(after)
            if target is None:
                if len(numbers) >= budget:
                    return BudgetExceeded(budget, multipliers(net, list(numbers)))
                target = numbers[after] = len(numbers)
                queue.append((after, enabled | table.wakes[index]))
            edges.append((number, index, target))
    return Explored(tuple(numbers), tuple(edges), tuple(stable), safe)


def markings_graph(net: Net, budget: int = BUDGET, plain: int = PLAIN) -> MarkingsGraph | BudgetExceeded:
    """The size of the graph of all markings; beyond `plain` of them numpy takes over, which is slower to begin."""
    found = explore(net, min(plain, budget))
    if isinstance(found, Explored):
        return MarkingsGraph(len(found.markings), len(found.edges), len(found.stable), found.safe)
    return _packed(net, budget) if budget > plain else found


@record
class _Packed:
    """A transition over words of 64 places, as pairs (word, bits): what it needs, rarest first, and what changes.

    fills: the places filled that its shape does not show to be free.
    """

    before: int
    filled: int
    needs: tuple[tuple[int, numpy.uint64], ...]
    fills: tuple[tuple[int, numpy.uint64], ...]
    toggles: tuple[tuple[int, numpy.uint64], ...]


def _packed(net: Net, budget: int) -> MarkingsGraph | BudgetExceeded:
    """Breadth first, a layer at a time, each marking a column of words.

    What was seen is kept as sorted 64-bit fingerprints: for a million markings two of them agree with a chance of 3e-8.
    """
    import numpy

    words = max(1, -(-len(net.places) // 64))
    table = masks(net)

    def split(mask: int) -> tuple[tuple[int, numpy.uint64], ...]:
        parts = ((word, mask >> 64 * word & (1 << 64) - 1) for word in range(words))
        return tuple((word, numpy.uint64(part)) for word, part in parts if part)

    levels: list[list[_Packed]] = [[] for _ in Level]
    units = [marking(unit) for unit in net.units] if not verify(net) else []
    for index, level in enumerate(table.levels):
        before, taken, filled = table.before[index], table.taken[index], table.filled[index]
        for unit in units:  # the token of a unit moves: where it goes there was none
            if unit & taken:
                filled &= ~unit
        toggled = taken | table.filled[index]
        levels[level].append(_Packed(before, filled, split(before)[::-1], split(filled), split(toggled)))
    layer = numpy.zeros((words, 1), dtype=numpy.uint64)
    for word, part in split(initial_marking(net)):
        layer[word, 0] = part
    keys = _keys(words)
    seen = _Seen()
    seen.add(_fingerprints(layer, keys))
    states, edges, stable, safe = 1, 0, 0, True
    while layer.shape[1]:
        after, quiet, sound = _fire(layer, levels)
        stable, safe = stable + quiet, safe and sound
        edges += sum(part.shape[1] for part in after)
        if not after:
            break
        found = numpy.concatenate(after, axis=1)
        prints, where = numpy.unique(_fingerprints(found, keys), return_index=True)
        fresh = seen.missing(prints)
        seen.add(prints[fresh])
        layer = numpy.ascontiguousarray(found[:, where[fresh]])
        states += layer.shape[1]
        if states > budget:
            columns = layer[:, :10_000]
            sample = [sum(int(columns[w, n]) << 64 * w for w in range(words)) for n in range(columns.shape[1])]
            return BudgetExceeded(budget, multipliers(net, sample))
    return MarkingsGraph(states, edges, stable, safe)


def _fire(layer: Words, levels: list[list[_Packed]]) -> tuple[list[Words], int, bool]:
    """All successors of a layer, how many of its markings are stable, and whether no full place was filled."""
    import numpy

    after: list[Words] = []
    safe = True
    quiet = 0
    for level in range(len(levels) - 1, -1, -1):
        if not level:
            quiet = layer.shape[1]
        if not layer.shape[1]:
            break
        union = sum(int(part) << 64 * word for word, part in enumerate(numpy.bitwise_or.reduce(layer, axis=1)))
        acted = numpy.zeros(layer.shape[1], dtype=bool)
        rows = list(layer)
        for one in levels[level]:
            if one.before & ~union:
                continue
            (word, part), *others = one.needs
            chosen = ((rows[word] & part) == part).nonzero()[0]
            for word, part in others:
                if not chosen.size:
                    break
                chosen = chosen[(rows[word].take(chosen) & part) == part]
            if not chosen.size:
                continue
            acted[chosen] = True
            successors = layer.take(chosen, axis=1)
            if one.filled & union:
                for word, part in one.fills:
                    safe = safe and not (successors[word] & part).any()
            for word, part in one.toggles:
                successors[word] ^= part
            after.append(successors)
        if level:
            layer = layer[:, ~acted]
    return after, quiet, safe


def _keys(words: int) -> Words:
    """Odd multipliers for the fingerprint of each word, always the same."""
    import numpy

    random = numpy.random.default_rng(20_240_917)
    return random.integers(0, 2**63, size=(words, 2), dtype=numpy.uint64) * numpy.uint64(2) + numpy.uint64(1)


def _fingerprints(columns: Words, keys: Words) -> Words:
    """A 64-bit hash of each column: each word multiplied, folded and multiplied again, then all added."""
    import numpy

    total = numpy.zeros(columns.shape[1], dtype=numpy.uint64)
    fold = numpy.uint64(32)
    for word in range(columns.shape[0]):
        value = columns[word] * keys[word, 0]
        value ^= value >> fold
        value *= keys[word, 1]
        value ^= value >> fold
        total += value * keys[word, 0]
    return total


class _Seen:
    """A set of fingerprints as sorted arrays of falling size, merged where one comes near the one before."""

    def __init__(self) -> None:
        self.tiers: list[Words] = []

    def missing(self, prints: Words) -> Any:
        """Which of these sorted fingerprints are not in the set."""
        import numpy

        fresh = numpy.ones(prints.shape[0], dtype=bool)
        for tier in self.tiers:
            position = numpy.searchsorted(tier, prints)
            position[position == tier.shape[0]] = 0
            fresh &= tier[position] != prints
        return fresh

    def add(self, prints: Words) -> None:
        """Adds sorted fingerprints that are not in the set."""
        import numpy

        if not prints.shape[0]:
            return
        while self.tiers and self.tiers[-1].shape[0] < 4 * prints.shape[0]:
            prints = numpy.concatenate([self.tiers.pop(), prints])
            prints.sort(kind="stable")
        self.tiers.append(prints)
