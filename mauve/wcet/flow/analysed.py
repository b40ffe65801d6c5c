"""What the flow analysis of one function in one context gives, and what is kept of it for its callees' contexts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mauve.wcet.flow import effects
from mauve.wcet.flow.domain import Range
from mauve.wcet.flow.effects import UNKNOWN, Summary
from mauve.wcet.flow.function import Attempt
from mauve.wcet.flow.result import FunctionFlow
from mauve.wcet.flow.state import State
from mauve.wcet.result import Problem

Name = tuple[int, tuple[object, ...]]
"""A function by key, and the fingerprint of the state in which it is entered; empty for any state."""


@dataclass(slots=True, eq=False)
class Analysed:
    """One function in one context.

    `flow` is complete but for `calls`: they are in `called`, by edge, as contexts or as the keys of functions that are
    called in a context that several calls share. `left` are states that hold all calls by key of a function; one that
    is missing is called in any state. `words` describe the context. `targets` None: nothing but the graph is known.
    `places` are what accesses touch, kept where the state is unknown. `sites` and `entered` are what the search for
    contexts starts from: the states before the calls by (edge, callee), and the one in which the function is entered.
    """

    flow: FunctionFlow
    called: Mapping[int, tuple[int | Analysed, ...]]
    name: Name
    unbounded: frozenset[int] = frozenset()
    targets: Mapping[int, Range] | None = None
    notes: tuple[Problem, ...] = ()
    words: str = ""
    summary: Summary = UNKNOWN
    attempt: Attempt | None = None
    places: Mapping[tuple[int, int], effects.Place] = field(default_factory=dict)
    left: Mapping[int, State] = field(default_factory=dict)
    sites: Mapping[tuple[int, int], State] = field(default_factory=dict)
    entered: State | None = None
