"""What flow analysis says about a program: bounds of loops, infeasible edges, addresses of accesses, per function
and context."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mauve.wcet.binary.graph import Cfg
from mauve.wcet.binary.loops import LoopNest
from mauve.wcet.result import Origin, Problem

ContextKey = tuple[int, str]
"""A function (its address, bit 0 set for Thumb) and the name of a context ("" for the one that covers every call)."""


@dataclass(frozen=True, slots=True)
class LoopBound:
    """Executions of the loop's header per entry (`bound`), and per execution of the function in this context
    (`total`)."""

    bound: int
    origin: Origin
    method: str
    total: int | None = None


@dataclass(frozen=True, slots=True)
class AddressRange:
    """The bytes an access may touch: addresses from `low` to `high` inclusive (the last byte of the last access)."""

    low: int
    high: int


@dataclass(frozen=True, slots=True)
class Exclusive:
    """Edges of which at most one is taken in one execution of the function, or in one iteration of the loop with the
    index `loop`, however often it is taken there. `conditions` say for each what it takes for granted."""

    edges: tuple[int, ...]
    loop: int | None
    conditions: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class FunctionFlow:
    """A function in one context.

    `bounds` maps the index of a loop in `nest.loops` to its bound; a loop that is missing has none, and `problems`
    says why. `infeasible` holds indices of edges never taken. `accesses` maps (instruction address, index of the
    micro-operation) to the range of a load or store; one that is missing may touch any address. `calls` maps the
    index of an edge with callees to the contexts of those callees, in the order of `Edge.callees`. `stack` is the
    greatest depth of the function's own frame in bytes, callees not included; None when unknown. `edge_limits` maps
    the index of an edge to the most often one execution of the function in this context takes it, where that is known
    beyond what bounds and totals say. `exclusive` are groups of edges that are never taken together.
    """

    cfg: Cfg
    nest: LoopNest
    bounds: Mapping[int, LoopBound]
    infeasible: frozenset[int]
    accesses: Mapping[tuple[int, int], AddressRange]
    calls: Mapping[int, tuple[ContextKey, ...]]
    problems: tuple[Problem, ...] = ()
    stack: int | None = None
    edge_limits: Mapping[int, int] = field(default_factory=dict)
    exclusive: tuple[Exclusive, ...] = ()


@dataclass(frozen=True, slots=True)
class ProgramFlow:
    """Everything reachable from `entry`. `functions` lists callees before callers, but for those on a cycle of calls,
    which is a problem. `words` are the names of contexts that are shown where they are not those of their keys."""

    entry: ContextKey
    functions: Mapping[ContextKey, FunctionFlow]
    problems: tuple[Problem, ...] = ()
    notes: tuple[Problem, ...] = ()
    assumptions: tuple[str, ...] = ()
    words: Mapping[ContextKey, str] = field(default_factory=dict)
