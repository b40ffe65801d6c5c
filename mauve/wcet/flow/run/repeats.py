"""Whether an iteration of a loop does anything that an earlier one did not do, and paths that cover all iterations."""

from __future__ import annotations

from collections.abc import Container, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MASK, SIGN, Range
from mauve.wcet.flow.run.cells import parts_of
from mauve.wcet.flow.run.compared import Compared, Pairs, Register, Where
from mauve.wcet.flow.run.compared import borders as beside
from mauve.wcet.flow.run.compile import ASKED, ASSUMED, DEPTH, RELATED, TARGET
from mauve.wcet.flow.run.covering import covers, widened
from mauve.wcet.flow.run.joining import covers_cell, pairs_apart, widen_layer
from mauve.wcet.flow.run.joining import includes as memory_includes
from mauve.wcet.flow.run.layers import Cell, Half, Layer, Part, Value
from mauve.wcet.flow.run.memory import DATA_END, Memory
from mauve.wcet.flow.run.paths import Path, Starts, word_at, words_at
from mauve.wcet.flow.run.related import (
    SUM,
    Related,
    Triple,
    apart,
    base_of,
    difference,
    multiple,
    together,
    with_difference,
)
from mauve.wcet.flow.run.words import UNKNOWN, Ranged, Some, Stack, Stacks, Word

_NO_VALUES = frozenset({TARGET, DEPTH, ASKED, ASSUMED, RELATED})
"""Slots of registers whose content no instruction reads."""


CLOSE, STEPS = 2, 4
"""How often ranges grow to the next border that any comparison draws, and to borders at all, before they grow to their
ends."""


@dataclass(slots=True)
class Kept:
    """A path as it was at the header of a loop. `starts` are the words in it that the function compares, `since` the
    work done before the first such path of the loop, `rounds` how often it was made wider, `vague` see Memory."""

    path: Path
    starts: Starts
    since: int = 0
    rounds: int = 0
    vague: int = 0
    _uses: dict[int, int] | None = None

    @property
    def uses(self) -> dict[int, int]:
        """How often each word occurs in the path, by the identity of its base."""
        if self._uses is None:
            self._uses = _uses_in(self.path.registers, self.path.layer)
        return self._uses


def keep(
    memory: Memory,
    path: Path,
    places: Sequence[Where],
    pairs: Pairs = (),
    outer: Starts = (),
    since: int = 0,
    rounds: int = 0,
) -> Kept:
    """Remember a path with the words at `places`; its layer is not written to any more. What words in its registers
    tell of other words is forgotten, on the path as well, but for how `pairs` of them differ: of a later iteration it
    need not be so. `outer` are the starts of loops around."""
    registers = path.registers
    both = [(a.number, b.number) for a, b in pairs if isinstance(a, Register) and isinstance(b, Register)]
    known = [(a, b, difference(registers[a], registers[b], registers[RELATED])) for a, b in both]
    multiples = _multiples(registers)
    plain: dict[int, Ranged] = {}
    for number in range(15):
        word = registers[number]
        if isinstance(word, Ranged) and _tells(word):
            base = plain.setdefault(id(word.base), type(word)(_range_of(word, registers[RELATED])))
            registers[number] = base.moved(word.offset)
    if plain:
        for a, b, values in known:
            left = difference(registers[a], registers[b], registers[RELATED])
            if values is not None and left is not None and values.span < left.span:
                registers[RELATED] = with_difference(registers[a], registers[b], values, registers[RELATED])
    for a, b, factor, rest in multiples:
        registers[RELATED] = with_difference(registers[a], registers[b], rest, registers[RELATED], factor)
    related: Related = registers[RELATED]
    uses = _uses_in(registers, path.layer) if related else None
    if related and uses is not None:
        wanted = uses.keys() | {id(start.base) for _, start in outer}
        registers[RELATED] = dict(_lasting_of(related, wanted, plain))
    found = [(place, word_at(memory, place, path)) for place in places]
    starts = [(place, word) for place, word in found if isinstance(word, Ranged)]
    before = Path(path.block, registers[:], path.layer, path.counters.copy())
    return Kept(before, starts, since, rounds, memory.vague, uses)


def _range_of(word: Ranged, related: Related) -> Range:
    """What is known of the base of a word, which may be a difference."""
    values = domain.shift(word.range, -word.offset)
    less = word.base.less if type(word.base) is Some else None
    apart = None if less is None else difference(*less, related)
    return values if apart is None else domain.meet(values, apart) or values


def _uses_in(registers: Sequence[Any], layer: Layer) -> dict[int, int]:
    """How often each word occurs in registers and memory, by the identity of its base."""
    uses: dict[int, int] = {}
    for word in (*registers, *_words_below(layer)):
        if isinstance(word, Ranged):
            base = word.base
            uses[id(base)] = uses.get(id(base), 0) + 1
    return uses


def _lasting_of(related: Related, wanted: Container[int], plain: Mapping[int, Ranged]) -> Iterator[tuple[Any, Any]]:
    """What is known of words that are still `wanted`, and of sums of two such, which may be `plain` words now."""
    for key, (x, y, values) in related.items():
        if key[0] in wanted and key[1] in wanted:
            yield key, (x, y, values)
        elif key[2] == SUM and y.terms is not None:
            parts = [plain.get(id(part.base), part.base) for part in (x, *y.terms)]
            if all(id(part) in wanted for part in parts):
                end, one, other = (to.moved(of.offset) for to, of in zip(parts, (x, *y.terms), strict=True))
                total = type(y)(y.range)
                total.terms = one, other  # type: ignore[assignment]
                yield (id(end), id(total), key[2]), (end, total, values)


def _multiples(registers: Sequence[Any]) -> list[tuple[int, int, int, Range]]:
    """Registers of which one was made as a multiple of the other: both, the factor, and what one is less the
    multiple."""
    found = []
    wholes = [(n, word) for n, word in enumerate(registers[:15]) if isinstance(word, Ranged)]
    for a, word in wholes:
        for part in (word.base, *(word.base.terms or ())):
            low = part.base.low if type(part.base) is Some else None
            for b, other in wholes if low is not None and low[2] else ():
                values = multiple(word.base, other.base, 1 << low[2]) if low is not None else None
                if low is not None and values is not None:
                    factor = 1 << low[2]
                    found.append((a, b, factor, domain.shift(values, word.offset - factor * other.offset)))
    return found


def _tells(word: Ranged) -> bool:
    """Whether what a branch tells of a word is told of others as well: terms, a whole, an address."""
    told = (word.low, word.base.less) if type(word) is Some and type(word.base) is Some else ()
    return word.base.terms is not None or word.source is not None or any(one is not None for one in told)


def changed(kept: Kept, path: Path) -> list[Where]:
    """The registers that hold other numbers on a later path."""
    pairs = enumerate(zip(kept.path.registers[:15], path.registers, strict=False))
    return [Register(n) for n, (a, b) in pairs if a is not b and isinstance(b, Ranged) and not b.range.is_top]


def _words_below(layer: Layer) -> Iterator[Value]:
    """The words in memory as a path sees it."""
    seen: set[int] = set()
    forgotten = False
    one: Layer | None = layer
    while one is not None:
        for key, cell in one.cells.items():
            if key not in seen and not (forgotten and key < DATA_END):
                seen.add(key)
                yield from _words_of(cell)
        forgotten = forgotten or one.forgets
        one = one.below


def _words_of(cell: Cell) -> Iterator[Value]:
    if isinstance(cell, list):
        for part in cell:
            yield part.value if isinstance(part, Half) else part
    else:
        yield cell


class _Places:
    """What stands on a later path where a word stands on an earlier one."""

    def __init__(self, kept: Kept) -> None:
        self._kept = kept
        self._found: dict[int, tuple[Ranged | None, int]] = {}
        self._seen: dict[int, int] = {}
        self._words: dict[int, Word] = {}

    def agree(self, wide: Word, word: Word) -> bool:
        """Whether a word may stand in the place of another, given those seen before: words with a known distance have
        it on the later path as well."""
        if not isinstance(wide, Ranged):
            return True
        if type(word) is not int and type(word) is not Stack and not isinstance(word, Ranged):
            return self._kept.uses.get(id(wide.base)) == 1 and not _tells(wide)
        base, at = base_of(word)
        if base is not wide.base and _tells(wide):
            return False
        moved = (at - wide.offset) & MASK
        key = id(wide.base)
        self._seen[key] = self._seen.get(key, 0) + 1
        self._words[key] = word if not wide.offset else word - wide.offset
        known = self._found.setdefault(key, (base, moved))
        return known[0] is base and known[1] == moved

    def complete(self) -> bool:
        """Whether no word that became another stands anywhere else."""
        moved = [key for key, (base, _) in self._found.items() if id(base) != key]
        return all(self._seen[key] == self._kept.uses.get(key, 0) for key in moved)

    def now(self, base: Ranged) -> Word:
        """What a word is on the later path."""
        return self._words.get(id(base), base)


def includes(memory: Memory, kept: Kept, path: Path) -> bool:
    """Whether everything that may be so on `path` may be so on the path that was kept, from which it came."""
    wide, places = kept.path, _Places(kept)
    for number, (a, b) in enumerate(zip(wide.registers, path.registers, strict=True)):
        if number not in _NO_VALUES and not ((a is b or covers(a, b)) and places.agree(a, b)):
            return False
    pairs = pairs_apart(memory, wide.layer, path.layer)
    if pairs is None:
        return False
    for _, first, second in pairs:
        if not covers_cell(first, second) or not _cell_agrees(first, second, places):
            return False
    if not places.complete():
        return False
    for key, (x, y, values) in wide.registers[RELATED].items():
        found = _apart_now(key[2], x, y, places, path)
        if found is None or not domain.includes(values, found):
            return False
    return True


def _apart_now(factor: int, x: Ranged, y: Ranged, places: _Places, path: Path) -> Range | None:
    """How two words of an earlier path that are related differ on a later one."""
    if factor != SUM or y.terms is None:
        return apart(places.now(x), places.now(y), factor, path.registers[RELATED])
    one, other = (places.now(term.base) + term.offset for term in y.terms)
    return difference(places.now(x), one + other, path.registers[RELATED])


def _cell_agrees(wide: Cell, cell: Cell, places: _Places) -> bool:
    """Whether a cell may stand in the place of another, as far as it holds words that stand elsewhere as well."""
    if not isinstance(wide, list):
        return isinstance(wide, Range) or places.agree(wide, UNKNOWN if isinstance(cell, list | Range) else cell)
    return all(_agree(a, b, places) for a, b in zip(wide, parts_of(cell), strict=True))


def _agree(wide: Part, part: Part, places: _Places) -> bool:
    if isinstance(wide, Half):
        if isinstance(wide.value, Range):
            return True
        same = isinstance(part, Half) and wide.index == part.index and not isinstance(part.value, Range)
        return same and places.agree(wide.value, part.value)  # type: ignore[union-attr,arg-type]
    if isinstance(wide, Range):
        return True
    return places.agree(wide, UNKNOWN if isinstance(part, Half | Range) else part)


def is_less(memory: Memory, kept: Kept, path: Path) -> bool:
    """Whether less may be so on `path` than on the path that was kept, which includes it."""
    if not _covers(memory, path, kept.path):
        return True
    places = _Places(kept)
    for a, b in zip(kept.path.registers, path.registers, strict=True):
        if isinstance(a, Ranged):
            places.agree(a, b)
    for key, (x, y, values) in kept.path.registers[RELATED].items():
        found = _apart_now(key[2], x, y, places, path)
        if found is None or not domain.includes(found, values):
            return True
    return False


def _covers(memory: Memory, wide: Path, path: Path) -> bool:
    for number, (a, b) in enumerate(zip(wide.registers, path.registers, strict=True)):
        if a is not b and number not in _NO_VALUES and not covers(a, b):
            return False
    return memory_includes(memory, wide.layer, path.layer)


def widen(memory: Memory, kept: Kept, path: Path, compared: Compared, starts: Starts) -> Path:
    """A path that covers both, such that doing this again and again comes to an end; see Meeting.join."""
    before = kept.path
    made: dict[tuple[int, int], Triple] = {}
    borders = _Borders(kept, path, compared, memory.ends)

    def wider(a: Any, b: Any, ends: Sequence[int] = borders.all) -> Any:
        if a is b or (type(a) is int and type(b) is int and a == b):
            return a
        if (id(a), id(b)) not in made:
            in_stack = type(a) is Stack or type(a) is Stacks
            made[id(a), id(b)] = a, b, widened(a, b, borders.stack if in_stack else ends)
        return made[id(a), id(b)][2]

    registers = list(path.registers)
    for number, (a, b) in enumerate(zip(before.registers, path.registers, strict=True)):
        if number not in _NO_VALUES and a is not b:
            registers[number] = wider(a, b, borders.of(number))
    places = {*(place for pair in compared.pairs for place in pair), *(place for place, _ in starts)}
    words = {place: words_at(memory, place, before, path, registers, wider) for place in places}
    known = [(one, two) for a, b in compared.pairs if (one := words[a]) is not None and (two := words[b]) is not None]
    known += [(one, (start, start, start)) for place, start in starts if (one := words[place]) is not None]
    begun = {id(start.base) for _, start in starts}
    alive = {id(word.base) for word in registers[:15] if isinstance(word, Ranged)}
    combine = _grown if kept.rounds < STEPS else _lasting
    one, other = before.registers[RELATED], path.registers[RELATED]
    lines = _in_step(before, path, registers, compared)
    registers[RELATED] = together(one, other, made.values(), known, alive, begun, combine, lines)
    _tighten(registers[RELATED], {id(word) for _, _, word in made.values()})
    layer = widen_layer(memory, before.layer, path.layer, wider)
    return Path(path.block, registers, layer, path.counters)


def _in_step(before: Path, path: Path, registers: list[Any], compared: Compared) -> list[tuple[Triple, Triple, int]]:
    """Registers that an iteration moves, each with one that the function compares, and how many times as far."""
    moved: dict[int, int] = {}
    for number, (a, b) in enumerate(zip(before.registers[:15], path.registers, strict=False)):
        step = None if a is b else difference(b, a, path.registers[RELATED])
        if step is not None and step.n == 0 and step.low:
            moved[number] = domain.signed(step.low)
    leaders = [place.number for place in compared.places if isinstance(place, Register) and place.number in moved]
    found = []
    for number, far in moved.items():
        near = [(abs(moved[leader]), leader) for leader in leaders if leader != number and not far % moved[leader]]
        if near:
            leader = min(near)[1]
            one, other = ((before.registers[n], path.registers[n], registers[n]) for n in (number, leader))
            found.append((one, other, far // moved[leader]))
    return found


def _tighten(related: Related, fresh: Container[int]) -> None:
    """Leave words that were just made no values that they cannot have beside others."""
    for key, (x, y, values) in related.items():
        fits = id(x) in fresh and key[2] != SUM
        kept = domain.meet(x.range, domain.add(domain.scale(y.range, key[2]), values)) if fits else None
        if kept is not None:
            x.range = kept


class _Borders:
    """Where ranges may end that grow: beside what words are compared with, beside numbers, addresses and ranges that
    stay as they are, and beside the ends of objects."""

    def __init__(self, kept: Kept, path: Path, compared: Compared, ends: Sequence[int]) -> None:
        self._numbers = compared.numbers
        near = kept.rounds < CLOSE
        found: set[int] = set(_SMALL if near else _ENDS)
        stack: set[int] = set()
        for end in ends:
            found.update(beside(end))
        for old, word in zip(kept.path.registers[:15], path.registers, strict=False):
            if type(word) is int:
                found.update(beside(word))
            elif type(word) is Stack:
                stack.update(beside(word.offset))
            elif old is word and isinstance(word, Ranged):
                for end in word.range.unsigned_bounds():
                    (stack if type(word) is Stacks else found).update(beside(end))
        self._found = found
        numbers = set().union(*compared.numbers.values()) if near else set()
        self.all = sorted(found | numbers) if kept.rounds < STEPS else []
        self.stack = sorted(stack | {0, SIGN, MASK}) if kept.rounds < STEPS else []

    def of(self, register: int) -> list[int]:
        """The borders for what a register holds."""
        own = self._numbers.get(Register(register))
        return self.all if own is None or not self.all else sorted(self._found | own)


def _grown(before: Range, after: Range) -> Range:
    return domain.widen(before, after, sorted(_SMALL))


def _lasting(before: Range, after: Range) -> Range:
    return before if domain.includes(before, after) else domain.TOP


_ENDS = (0, SIGN - 1, SIGN, MASK)
_SMALL = (*_ENDS, 1, 0xFF, 0xFFFF)


__all__ = ["Kept", "changed", "includes", "is_less", "keep", "widen"]
