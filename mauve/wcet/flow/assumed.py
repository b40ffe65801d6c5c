"""What facts assume of arguments and of memory, resolved to the registers, stack slots and addresses of a binary."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import field

from mauve.records import record
from mauve.wcet.binary.elf import Binary, ElfProblem, Symbol
from mauve.wcet.flow import domain
from mauve.wcet.flow.domain import MASK, Range
from mauve.wcet.flow.facts import Argument, AssumeFact, AtAddress, AtLine, AtSymbol, Fact, Place
from mauve.wcet.flow.linear import FRAME
from mauve.wcet.flow.state import State
from mauve.wcet.flow.strings import ending
from mauve.wcet.result import Problem, ProblemKind

IN_REGISTERS = 4
"""Argument slots that are registers; the others are words on the stack (AAPCS 5.5)."""


@record
class Stretch:
    """Addresses from `start` up to but without `end` hold numbers of `width` bytes within `low` to `high`; unknown
    bytes where `width` is 0."""

    start: int
    end: int
    width: int
    low: int
    high: int


@record
class Assumed:
    """What is assumed of the arguments of functions, by key and slot, and of stretches of memory. `strings`: the bytes
    that an argument points to, in which strings end, by key and slot."""

    arguments: Mapping[int, tuple[tuple[int, Range], ...]]
    memory: tuple[Stretch, ...] = ()
    problems: tuple[Problem, ...] = ()
    sentences: tuple[str, ...] = ()
    strings: Mapping[int, tuple[tuple[int, int], ...]] = field(default_factory=dict)

    def reading(self, addresses: Range, size: int, is_signed: bool) -> Range | None:
        """What is assumed of a number of `size` bytes read at any of these addresses, as it is after extension."""
        if not self.memory:
            return None
        low, high = addresses.unsigned_bounds()
        for one in self.memory:
            if one.start <= low and high + size <= one.end and size == one.width:
                aligned = (low - one.start) % size == 0 and (addresses.n == 0 or addresses.step % size == 0)
                plain = one.low >= 0 and one.high < 1 << (8 * size - is_signed)
                if aligned and (plain or size == 4 or (is_signed and one.high < 1 << (8 * size - 1))):
                    return domain.between(one.low & MASK, one.high & MASK)
        return None

    @property
    def spoken_of(self) -> frozenset[int]:
        """The functions of whose arguments something is assumed, as keys."""
        return frozenset((*self.arguments, *self.strings))

    def covers(self, address: int) -> bool:
        """Whether a fact speaks of the byte at an address: then it does not start with its linked value."""
        return any(one.start <= address < one.end for one in self.memory)

    def entered(self, function: int, state: State) -> State | None:
        """The state on entry of a function, narrowed; None where no call of it keeps the facts."""
        wanted, strings = self.arguments.get(function, ()), self.strings.get(function, ())
        if not wanted and not strings:
            return state
        state = state.copy()
        for slot, length in strings:
            ending(state, slot, length)
        for slot, known in wanted:
            low, high = known.low, (known.low + known.span) & MASK
            if slot <= IN_REGISTERS:
                if not state.require(state.regs[slot - 1], low, high):
                    return None
                continue
            offset = 4 * (slot - IN_REGISTERS - 1)
            cell = state.memory.get(FRAME, {}).get(offset)
            if cell is None:
                state.cells(FRAME)[offset] = (4, state.fresh(known))
            elif cell[0] == 4 and not state.require(cell[1], low, high):
                return None
        return state


def resolve(binary: Binary, facts: Sequence[Fact]) -> Assumed:
    """The assumptions among the facts; a fact that cannot be placed is a problem."""
    arguments: dict[int, list[tuple[int, Range]]] = {}
    strings: dict[int, list[tuple[int, int]]] = {}
    memory: list[Stretch] = []
    problems: list[Problem] = []
    sentences: list[str] = []
    for fact in facts:
        if not isinstance(fact, AssumeFact):
            continue
        found = _argument(binary, fact) if isinstance(fact.place, Argument) else _memory(binary, fact, fact.place)
        match found:
            case str():
                problems.append(Problem(ProblemKind.FACT_NOWHERE, found, written=fact.written))
                continue
            case Stretch():
                memory.append(found)
            case (key, slot, _) if fact.ends:
                strings.setdefault(key, []).append((slot, fact.ends))
            case (key, slot, known):
                arguments.setdefault(key, []).append((slot, known))
        sentences.append(_sentence(fact))
    by_key = {key: tuple(found) for key, found in arguments.items()}
    in_strings = {key: tuple(found) for key, found in strings.items()}
    return Assumed(by_key, tuple(memory), tuple(problems), tuple(sentences), in_strings)


def _argument(binary: Binary, fact: AssumeFact) -> tuple[int, int, Range] | str:
    assert isinstance(fact.place, Argument)
    function = binary.function(fact.place.function)
    if isinstance(function, ElfProblem):
        return function.message
    if fact.ends and fact.place.slot > IN_REGISTERS:
        return f"argument {fact.place.slot} is on the stack: strings are known to end of arguments 1 to {IN_REGISTERS}"
    if fact.low is None or fact.high is None:
        return function.key, fact.place.slot, domain.TOP
    if fact.low < -(1 << 31) or fact.high > MASK:
        return f"{fact.low} to {fact.high} does not fit into 32 bits"
    return function.key, fact.place.slot, domain.between(fact.low & MASK, fact.high & MASK)


def _memory(binary: Binary, fact: AssumeFact, place: Place) -> Stretch | str:
    match place:
        case AtSymbol(symbol, offset):
            found = _object(binary, symbol)
            if isinstance(found, str):
                return found
            start, size = found.address + offset, found.size - offset
            name = f"`{symbol}`"
        case AtAddress(address):
            start, size, name = address, fact.width, f"the number at {address:#x}"
        case AtLine():
            return "a line of a source file is no place of data"
    if fact.low is None or fact.high is None:
        return Stretch(start, start + size, 0, 0, 0) if size > 0 else f"the size of {name} is not known"
    width = fact.width or size
    if width not in (1, 2, 4):
        return f"{name} has {size} bytes: say how large its elements are, as in `each 2B`"
    if fact.low < -(1 << (8 * width - 1)) or fact.high >= 1 << (8 * width):
        return f"{fact.low} to {fact.high} does not fit into {width} byte{'s' if width > 1 else ''}"
    return Stretch(start, start + max(size, width) // width * width, width, fact.low, fact.high)


def _object(binary: Binary, name: str) -> Symbol | str:
    found = [symbol for symbol in (*binary.objects, *binary.labels) if symbol.name == name]
    places = {symbol.address for symbol in found}
    if len(places) > 1:
        where = ", ".join(f"{address:#x}" for address in sorted(places))
        return f"`{name}` names several objects, at {where}: give the address instead"
    return found[0] if found else f"there is no object `{name}` in the binary"


def _sentence(fact: AssumeFact) -> str:
    match fact.place:
        case Argument(function, slot):
            what = f"argument {slot} of `{function}`"
        case AtSymbol(symbol, offset):
            what = f"`{symbol}`" + (f"+{offset:#x}" if offset else "")
        case AtAddress(address):
            what = f"the number at {address:#x}"
        case _:
            what = "a number"
    said = "is unknown" if fact.low is None else f"is within {fact.low} to {fact.high}"
    if fact.ends:
        said = f"points to {fact.ends} bytes, and a string that begins in them ends in them"
    elements = f", each {fact.width} bytes," if fact.width else ""
    return f"{what}{elements} {said}" + (f" ({fact.written})" if fact.written else "")

