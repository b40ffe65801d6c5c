"""What steers abstract executions of loops and decides nothing: where ranges stop growing first, and when stepping on
is in vain."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from mauve.wcet.binary.microop import CompareBranch, Instruction
from mauve.wcet.flow import anchors, closed_form, domain, flags, linear
from mauve.wcet.flow.domain import SIGN, TOP, Range
from mauve.wcet.flow.linear import Value
from mauve.wcet.flow.state import State

MOST_STOPS = 3
"""Attempts at a header in which ranges stop at any mark."""


@dataclass(slots=True)
class Marks:
    """Where ranges in a loop stop growing first: constants of the function, and the ends of what the loop compares
    with and does not change, made of symbols before `fresh`. `limits` are such values, `of_symbol` the ends that a
    symbol of the header is compared with."""

    fresh: int
    found: set[int]
    limits: dict[Value, None] = field(default_factory=dict)
    of_symbol: dict[int, set[int]] = field(default_factory=dict)

    def note(self, state: State) -> None:
        """Take up the compare that a branch depends on."""
        if state.origin is None:
            return
        _, a, b = state.origin
        for moving, fixed in ((a, b), (b, a)):
            if type(moving) is int or any(symbol >= self.fresh for symbol in linear.symbols(fixed)):
                continue
            if type(fixed) is tuple:
                self.limits[(0, *fixed[1:])] = None
            known = state.range_of(fixed)
            if known.span >= SIGN:
                continue
            assert type(moving) is tuple
            ends = {
                (end - offset + near) & domain.MASK
                for end in (known.low, known.low + known.span)
                for offset in (0, moving[0])
                for near in (-1, 0, 1)
            }
            self.found |= ends
            for symbol in self.of_symbol.keys() & anchors.reached(state, moving):
                self.of_symbol[symbol] |= ends

    def thresholds(self, attempt: int, last: int) -> Callable[[int], Sequence[int]]:
        """For a symbol of the header where its range stops next: at any mark in the first attempts, then at those that
        it is compared with, in the end (`last`) nowhere."""
        if attempt < MOST_STOPS:
            every = sorted(self.found)
            return lambda symbol: every
        if attempt < last:
            return lambda symbol: sorted({0, SIGN - 1, SIGN, domain.MASK} | self.of_symbol.get(symbol, set()))
        return lambda symbol: ()


class Exits:
    """What one iteration of a stepped loop knew at the branches that lead out of it (a heuristic: data that are as
    unknown as they were many iterations ago will not end the loop)."""

    def __init__(self, blocks: frozenset[int] = frozenset(), roughly: bool = False) -> None:
        self.blocks, self.roughly = blocks, roughly
        self.known: dict[int, frozenset[Range] | None] = {}

    def note(self, block: int, last: Instruction, states: list[State]) -> None:
        """Note the compared values at the end of a block; None where the branch is decided in some state."""
        if isinstance(last.flow, CompareBranch):
            values = frozenset(state.range_of(state.regs[last.flow.register]) for state in states)
            self.known[block] = None if any(known.n == 0 or 0 not in known for known in values) else self._seen(values)
            return
        # Where a conditional instruction with the same condition stands before it, each state alone is decided.
        possible = any(flags.may_hold(state.flags, last.condition) for state in states)
        certain = all(flags.must_hold(state.flags, last.condition) for state in states)
        found: set[Range] = set()
        for state in states:
            if certain or not possible or state.origin is None:
                self.known[block] = None
                return
            found.add(state.range_of(linear.sub(state.origin[1], state.origin[2])))
        self.known[block] = self._seen(frozenset(found))

    def _seen(self, values: frozenset[Range]) -> frozenset[Range]:
        """The ranges as they are compared: after many iterations those too wide to be used up are all the same."""
        return frozenset(TOP if self.roughly and known.span >= closed_form.MOST else known for known in values)

    def hopeless(self, before: Exits) -> bool:
        """Whether all branches out of the loop are as undecided as they were."""
        mine = [self.known.get(block) for block in self.blocks]
        same = self.roughly is before.roughly
        return same and None not in mine and bool(mine) and self.blocks == before.blocks and self.known == before.known


def stands_still(before: list[State], now: list[State]) -> bool:
    """Whether nothing that is known has changed between two visits of a header (a heuristic: stepping on would not
    end)."""
    return len(before) == len(now) and all(_same(a, b) for a, b in zip(before, now, strict=True))


def _same(a: State, b: State) -> bool:
    if any(_moved(a, b, x, y) for x, y in zip(a.regs[:15], b.regs[:15], strict=True)):
        return False
    for region in a.memory.keys() & b.memory.keys():
        mine, other = a.memory[region], b.memory[region]
        if mine is other:
            continue
        for offset, cell in mine.items():
            their = other.get(offset)
            if their is None or _moved(a, b, cell[1], their[1]):
                return False
    return True


def _moved(a: State, b: State, x: Value, y: Value) -> bool:
    """Whether a value has changed by more than being another unknown of the same range."""
    if x == y:
        return False
    return type(linear.sub(y, x)) is int or a.range_of(x) != b.range_of(y)
