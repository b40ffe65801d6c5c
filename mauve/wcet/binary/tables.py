"""Tables of jump targets whose length the code does not check.

Compilers leave the check of an index out where they know its values: for a variable that the file assigns only some
numbers, a default that cannot be reached, a computed goto. The table then ends where its entries do.
"""

from __future__ import annotations

import sys
from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence

from mauve.wcet.binary.elf import Binary, Content, Symbol
from mauve.wcet.binary.microop import Op
from mauve.wcet.binary.terms import MASK, Terms, concrete

MOST_ENTRIES = 1024
"""The most targets that one jump may have."""


def evaluate(terms: Terms, below: Iterable[int], given: dict[int, int], binary: Binary) -> int | None:
    """The value of the last term when some are given, loads read from constant memory; None when it takes more."""
    known: dict[int, int | None] = {}
    last: int | None = None
    for number in below:
        parts = terms.table[number]
        value: int | None = None
        if number in given:
            value = given[number]
        elif parts[0] == "constant":
            value = parts[1]
        elif isinstance(parts[0], Op):
            a, b = known[parts[1]], known[parts[2]]
            value = None if a is None or b is None else concrete(parts[0], a, b)
        elif parts[0] == "load" and (address := known[parts[1]]) is not None:
            raw = binary.read_constant(address, parts[2])
            value = None if raw is None else int.from_bytes(raw, "little", signed=parts[3]) & MASK
        known[number] = last = value
    return last


def _tables(
    terms: Terms, term: int, below: Sequence[int], fixed: dict[int, int], binary: Binary
) -> Iterator[tuple[int, Iterator[tuple[int, int] | None]]]:
    """The tables that a jump to the term may read: their addresses, with the places of entries and where those lead.
    Looks for terms such that their values 0, 1, 2, ... read entries one behind the other; None where they do not go
    on so: then that is no index."""
    loads = [number for number in below if terms.table[number][0] == "load" and number not in fixed]
    if not loads:
        return
    load = max(loads)  # of several the others are parts of its address
    size, where = terms.table[load][2], terms.below(terms.table[load][1])
    for number in reversed(where):
        if terms.value(number) is not None or number in fixed:
            continue
        start, second = (evaluate(terms, where, {**fixed, number: index}, binary) for index in (0, 1))
        if start is not None and second == start + size:
            yield start, _entries(terms, below, where, (start, size, number), fixed, binary)


def _entries(
    terms: Terms,
    below: Sequence[int],
    where: Sequence[int],
    table: tuple[int, int, int],
    fixed: dict[int, int],
    binary: Binary,
) -> Iterator[tuple[int, int] | None]:
    start, size, number = table
    for index in range(MOST_ENTRIES):
        given = {**fixed, number: index}
        at, target = (evaluate(terms, part, given, binary) for part in (where, below))
        if at != start + size * index:
            yield None
        if at is None or target is None:
            return
        yield at, target


def inline_table(
    terms: Terms,
    term: int,
    below: Sequence[int],
    fixed: dict[int, int],
    binary: Binary,
    place: int,
    taken: Callable[[int], bool],
) -> set[int] | None:
    """The targets in a table that follows the jump before `place`: it ends before the nearest code that it leads to, at
    the latest, and before what is `taken`: known code, and data that instructions name. Entries that would lead into
    the table itself are padding."""
    size = next((terms.table[number][2] for number in reversed(below) if terms.table[number][0] == "load"), 0)
    for start, entries in _tables(terms, term, below, fixed, binary):
        if not 0 <= start - place < 4 + size:
            continue
        targets: set[int] = set()
        content = binary.content_at(start)
        nearest: int | None = None
        for entry in entries:
            if entry is None:
                targets.clear()
                break
            at, target = entry
            if nearest is not None and at + size > nearest:
                break
            if binary.content_at(at) is not content or any(taken(byte) for byte in range(at, at + size)):
                break
            if not start <= target & ~1 <= at and binary.read_code(target & ~1, 2) is None:
                break  # what follows the table
            targets.add(target)
            nearest = min((t & ~1 for t in targets if t & ~1 > at), default=nearest)
        if nearest is not None and targets:
            return {t for t in targets if not start <= t & ~1 < nearest}
    return None


def open_table(
    terms: Terms, term: int, below: Sequence[int], fixed: dict[int, int], binary: Binary, entry: int
) -> set[int] | None:
    """The targets in a table anywhere in constant memory: entries as far as they lead into the function of the jump,
    and where the table has a symbol, as far as that says."""
    own = binary.function_at(entry)
    if own is None or not own.size:
        return None
    for start, entries in _tables(terms, term, below, fixed, binary):
        named = next((s for s in binary.objects if s.address <= start < s.address + s.size), None)
        targets: set[int] = set()
        for one in entries:
            if one is None:
                targets.clear()
                break
            at, target = one
            if (named is not None and at >= named.address + named.size) or not belongs(target, own, binary):
                break
            targets.add(target)
        if targets:
            return targets
    return None


def belongs(target: int, own: Symbol, binary: Binary) -> bool:
    """Whether code belongs to a function, or to the part of it that the compiler put elsewhere."""
    there = binary.function_at(target)
    if there is None or binary.content_at(target & ~1) is Content.DATA:
        return False
    return there is own or there.name.startswith(f"{own.name}.cold")


def labels(binary: Binary, entry: int, thumb: bool, made: Iterable[int]) -> frozenset[int]:
    """The places inside a function whose address is a word of the binary's data, or is `made` by its code, as keys:
    where jumps to the values of pointers can go. Only with mapping symbols, which tell code from data."""
    own = binary.function_at(entry)
    if own is None or not own.size:
        return frozenset()
    first, end = own.address + 1, own.address + own.size
    values = {value for value in made if first <= value < end}
    for segment in binary.segments:
        start = -segment.address % 4
        words = array("I", segment.data[start : start + (len(segment.data) - start) // 4 * 4])
        if sys.byteorder == "big":
            words.byteswap()
        for index, word in enumerate(words):
            if first <= word < end and binary.content_at(segment.address + start + 4 * index) in (Content.DATA, None):
                values.add(word)
    code, aligned = (Content.THUMB, 1) if thumb else (Content.ARM, 3)
    places = {value & ~1 if thumb else value for value in values}
    return frozenset(at | thumb for at in places if not at & aligned and binary.content_at(at) is code)
