"""What a branch tells, put in the place of the words that it tells of."""

from __future__ import annotations

from typing import Any

from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.run.compile import RELATED
from mauve.wcet.flow.run.memory import Memory
from mauve.wcet.flow.run.narrow import Told, narrower
from mauve.wcet.flow.run.related import Related, difference, follow, with_difference
from mauve.wcet.flow.run.words import Ranged, Some


def learn(registers: list[Any], memory: Memory, found: Told) -> None:
    """Leave words the values that are told of them, and so those that they are sums of, those that they move in step
    with, and the addresses that they were read at."""
    related: Related = registers[RELATED]
    for word, values in found:
        _leave(registers, memory, word, values)
        less = word.base.less if type(word.base) is Some else None
        if less is not None:
            _bring_near(registers, memory, *less, domain.shift(values, -word.offset))
        for other, rest in follow(word, values, related) if related else ():
            _leave(registers, memory, other, rest)
        addresses = None if word.source is None else memory.where(word.source, values)
        if word.source is not None and addresses is not None:
            _leave(registers, memory, word.source.address, addresses)
        base = word.base
        for term, apart in () if base.terms is None else (base.terms, base.terms[::-1]):
            rest = domain.sub(domain.shift(values, -word.offset), apart.range)
            if not domain.includes(rest, term.range):
                _leave(registers, memory, term, rest)


def _bring_near(registers: list[Any], memory: Memory, a: Ranged, b: Ranged, values: Range) -> None:
    """Leave two words no difference but one of these values."""
    related: Related = registers[RELATED]
    before = difference(a, b, related)
    kept = None if before is None else domain.meet(before, values)
    if kept is not None:
        registers[RELATED] = with_difference(a, b, kept, related)
        _leave(registers, memory, b, domain.sub(a.range, kept))
        _leave(registers, memory, a, domain.add(b.range, kept))


def _leave(registers: list[Any], memory: Memory, word: Ranged, values: Range) -> None:
    """Leave a word, and those with a known distance from it, no other values."""
    base = word.base
    for register in range(15):
        old = registers[register]
        if not isinstance(old, Ranged) or old.base is not base:
            continue
        kept = domain.meet(old.range, domain.shift(values, old.offset - word.offset))
        if kept is not None and kept != old.range:
            new = narrower(old, kept)
            registers[register] = new
            memory.narrow(old, new)
    kept = domain.meet(word.range, values)
    if kept is not None:
        memory.narrow(word, narrower(word, kept))


__all__ = ["learn"]
