"""What an abstract execution of a function may do, what it saw, and how it ends early."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Protocol

from mauve.wcet.binary.graph import Edge
from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.joining import Header
from mauve.wcet.flow.state import State


@dataclass(slots=True)
class Record:
    """What a sound pass over the whole function saw. `visits` and `totals` count executions of loop headers (per
    entry, per execution of the function); `accesses` and `writes` are places (region, first byte, last byte), region
    None anywhere; `saved` the callee-saved registers put on the stack; `leaks`: of which addresses
    (State.mask) something may have been stored outside the frame; `calls` the state before each call that asked for
    it by (edge, callee); `targets` the values of indirect branches by instruction address."""

    visits: dict[int, int | None] = field(default_factory=dict)
    methods: dict[int, str] = field(default_factory=dict)
    totals: dict[int, int | None] = field(default_factory=dict)
    taken: set[int] = field(default_factory=set)
    accesses: dict[tuple[int, int], tuple[int | None, int, int]] = field(default_factory=dict)
    writes: set[tuple[int | None, int, int]] = field(default_factory=set)
    saved: set[int] = field(default_factory=set)
    leaks: int = 0
    calls: dict[tuple[int, int], State] = field(default_factory=dict)
    targets: dict[int, Range] = field(default_factory=dict)
    headers: dict[int, Header] = field(default_factory=dict)
    depth: int | None = 0
    returned: list[State] = field(default_factory=list)


class Calls(Protocol):
    """What happens between a call and its return."""

    def apply(self, state: State, index: int, edge: Edge, record: Record | None) -> State | None:
        """The state after the call on edge `index`, or None when no callee returns. May change `state`; adds the
        callee's writes to the record."""


@dataclass(frozen=True, slots=True)
class Policy:
    """`stepped`: loops to execute iteration by iteration; `width`: states kept apart where paths meet; `steps`:
    instructions to execute before giving up stepping; `passes`: to find a header that holds all iterations; `most`:
    instructions to execute in summarised loops before giving up altogether."""

    stepped: frozenset[int]
    width: int = 1
    steps: int = 12_000
    passes: int = 12
    most: int = 400_000


class Exhausted(Exception):
    """A stepped loop has used up its share of the budget, or (`hopeless`) would do so whatever its share."""

    def __init__(self, region: int, hopeless: bool = False) -> None:
        self.region, self.hopeless = region, hopeless


class GaveUp(Exception):
    """The analysis of a function takes more steps than it may."""
