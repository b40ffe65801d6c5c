"""Contexts of functions: the states in which they are called, apart where that may tighten something, else joined.

A call string is followed, callee by callee, as long as limits allow and something comes of it (`Contexts.follow`); what
it leaves is entered in the join of the states of all such calls, callers first, so that each function is analysed once
more at most (`Contexts.joined`). A function that is called in a state of which nothing is known is taken as it is for
every call. So every call has a context that holds its state, whatever the limits.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from mauve.wcet.flow import effects, joining
from mauve.wcet.flow.analysed import Analysed, Name
from mauve.wcet.flow.effects import ARGUMENTS
from mauve.wcet.flow.linear import FRAME
from mauve.wcet.flow.state import State

if TYPE_CHECKING:
    from mauve.wcet.flow.functions import Functions

REGULAR = ("regular",)
"""Stands for the state in which a helper of floating-point arithmetic is entered without subnormal operands."""
MOST_CONTEXTS = 24
"""How many contexts of one function are asked for in the analysis of one other."""
MOST_VAIN = 3
"""After so many contexts of a function that bounded no further loop no more are tried."""
MOST_DEPTH = 12
"""How many calls deep contexts are followed before they are joined."""
DEEP = 2
"""From so many calls on, a context that leaves open all that was open without it is followed no further."""
MOST_CALLS = 48
"""How many contexts of a function that calls itself, directly or not, are followed into each other."""


Called = dict[int, tuple[int | Analysed, ...]]
"""By edge, what is called: contexts, or keys of functions in a context that several calls share."""


@dataclass(slots=True)
class Family:
    """The contexts asked for in the analysis of one function from an unknown state; `refused` counts those that a limit
    forbade; `lost` are functions on cycles of calls to whose end no contexts lead."""

    asked: dict[int, dict[Name, Analysed | None]] = field(default_factory=dict)
    refused: int = 0
    lost: set[int] = field(default_factory=set)

    def enter(self, context: Analysed) -> None:
        """Note that a context is in use, with all that it asked for itself."""
        waiting = [context]
        while waiting:
            here = waiting.pop()
            mine = self.asked.setdefault(here.name[0], {})
            if mine.get(here.name) is not here:
                mine[here.name] = here
                waiting += [inner for called in here.called.values() for inner in called if isinstance(inner, Analysed)]


class Contexts:
    """The contexts of a binary's functions under fixed control facts. A context that no limit curtailed is kept for
    all."""

    def __init__(self, functions: Functions) -> None:
        self._functions = functions
        self._known: dict[Name, Analysed] = {}
        self._spared: dict[int, Analysed | None] = {}

    def follow(self, function: Analysed, depth: int, family: Family) -> None:
        """Find the contexts of what a function calls, `depth` calls below the one that the family belongs to."""
        caller, sites = function.entered, function.sites
        if caller is None:
            return
        quick, key = self._functions.quick.get(function.name[0]), function.name[0]
        # No bound comes of this: contexts inside it would be asked for again for every function on the way here.
        vain = depth >= DEEP and quick is not None and quick.unbounded and function.unbounded >= quick.unbounded
        called: Called = {}
        left: dict[int, State | None] = {}
        for index, callees in function.called.items():
            found: list[int | Analysed] = []
            for callee in callees:
                state = None if isinstance(callee, Analysed) else sites.get((index, callee))
                context = callee
                if not isinstance(callee, Analysed):
                    if state is not None and not vain:
                        context = self._context(callee, state, depth, family, (key, caller))
                    if context is callee and index not in function.flow.infeasible:
                        left[callee] = _joined(left, callee, state)
                found.append(context)
            called[index] = tuple(found)
        function.called = self._regular(key, called)
        function.left = {callee: state for callee, state in left.items() if state is not None and tells(state)}

    def _context(
        self, key: int, state: State, depth: int, family: Family, caller: tuple[int, State]
    ) -> int | Analysed:
        """The context of a callee for an entry state, or its key where it is not worth one of its own."""
        state = self._as_far_as_read(key, state)
        name = (key, effects.fingerprint(state))
        mine = family.asked.setdefault(key, {})
        known = mine.get(name)
        sorts = self._functions.sorts(key) is not None
        if known is None and not sorts and not self._promising(key, state, depth, family, caller):
            return key
        if known is None:
            known = self._known.get(name)
        if known is None:
            refused = family.refused
            mine[name] = None
            known = self._functions.analyse(name, state, True)
            self.follow(known, depth + 1, family)
            known.words = effects.describe(state)
            if family.refused == refused:
                self._known[name] = known
            if key in family.lost:
                return key
        family.enter(known)
        return known

    def _as_far_as_read(self, key: int, state: State) -> State:
        """The entry state without the caller's frame, where the function does not look at it: it tells contexts apart
        that are the same."""
        quick = self._functions.quick.get(key)
        if FRAME not in state.memory or quick is None or quick.targets is None:
            return state
        if any(region == FRAME and high >= 0 for region, _, high in quick.places.values()):
            return state
        state = state.copy()
        state.memory.pop(FRAME)
        return state

    def _advances(self, key: int, state: State, caller: tuple[int, State]) -> bool:
        """Whether a call on a cycle of calls, with known arguments, comes nearer to its end as far as one can see: some
        argument is another number than the caller's was, or has fewer values left."""
        mine = [state.range_of(state.regs[r]) for r in ARGUMENTS]
        if caller[0] not in self._functions.cyclic:
            return any(values.size <= MOST_CALLS for values in mine)
        others = [caller[1].range_of(caller[1].regs[r]) for r in ARGUMENTS]
        return any(
            values.size <= MOST_CALLS and (values.size < other.size or (values.n == other.n == 0 and values != other))
            for values, other in zip(mine, others, strict=True)
        )

    def _promising(self, key: int, state: State, depth: int, family: Family, caller: tuple[int, State]) -> bool:
        """Whether one more context of a function is worth its time."""
        functions = self._functions
        if key in family.lost or not tells(state) or functions.is_leaving():
            return False
        if functions.takes_angle(key) and not functions.incomplete(key) and not _tells_angle(state):
            return False
        mine = family.asked.get(key, {})
        if key in self._functions.cyclic:
            if depth < MOST_CALLS and len(mine) < MOST_CALLS and self._advances(key, state, caller):
                return True
            family.refused += 1
            family.lost.add(key)
            return False
        quick = self._functions.quick[key]
        vain = len(mine) >= MOST_VAIN and all(_no_better(inside, quick) for inside in mine.values())
        if depth < MOST_DEPTH and len(mine) < MOST_CONTEXTS and not vain:
            return True
        family.refused += 1
        return False

    def _regular(self, key: int, called: Called) -> Called:
        """What a function calls, where its calls are known to pass no subnormal operands to a helper that takes long
        over them."""
        helpers = {callee for callees in called.values() for callee in callees if isinstance(callee, int)}
        spared = {callee: it for callee in helpers if (it := self._without_subnormals(callee)) is not None}
        if not spared:
            return called
        from mauve.wcet.flow.regular import regular_calls

        return called | {
            index: tuple(spared.get(c, c) if isinstance(c, int) else c for c in called[index])
            for index in regular_calls(self._functions.cfgs[key])
            if index in called
        }

    def _without_subnormals(self, key: int) -> Analysed | None:
        """A helper in the context of operands that are not subnormal; None where that makes no difference."""
        if key not in self._spared:
            from mauve.wcet.flow.regular import WORDS, without_subnormals

            self._spared[key] = None
            known = self._functions.routines.get(key)
            default = self._functions.default(key) if known else None
            flow = None if default is None or not known else without_subnormals(default.flow, known)
            if default is not None and flow is not None:
                self._spared[key] = replace(default, flow=flow, name=(key, REGULAR), words=WORDS)
        return self._spared[key]

    # ------------------------------------------------------------------------------------------------ joined
    def joined(self, tops: Iterable[Analysed], callers_first: Iterable[int]) -> dict[int, Analysed]:
        """What stands for the functions that the contexts of `tops` call by key: each in a context that holds all those
        calls. Functions on cycles of calls, and those that would gain nothing, are taken in any state."""
        join = _Join(self, Family())
        for top in tops:
            join.enter(top)
        for key in callers_first:
            if key in join.arriving:
                join.settle(key)
        while join.arriving:
            join.give_up(next(iter(join.arriving)))
        return join.found

    def entered_in(self, key: int, state: State, family: Family) -> Analysed:
        """A function in a state that several calls share."""
        name = (key, effects.fingerprint(state))
        known = self._known.get(name)
        if known is None:
            known = self._functions.analyse(name, state, True)
            self.follow(known, 0, family)
            words = effects.describe(state)
            known.words = f"{words} (several calls)" if words else "several calls"
        return known

    def any_state(self, key: int) -> Analysed | None:
        """A function as it is for every call."""
        return self._functions.default(key)

    def is_leaving(self) -> bool:
        """Whether no time is left for further contexts."""
        return self._functions.is_leaving()

    def gains(self, key: int) -> bool:
        """Whether something could come of knowing the states of a function's calls."""
        functions = self._functions
        return key not in functions.cyclic and key in functions.quick and functions.incomplete(key)


@dataclass(slots=True)
class _Join:
    """The way of `Contexts.joined`: what is `found`, and for the others the states `arriving` so far. A call that
    arrives after its function was settled makes that hold for any state."""

    contexts: Contexts
    family: Family
    found: dict[int, Analysed] = field(default_factory=dict)
    arriving: dict[int, State] = field(default_factory=dict)
    seen: set[Analysed] = field(default_factory=set)

    def enter(self, context: Analysed) -> None:
        """Follow the feasible calls of a context."""
        waiting = [context]
        while waiting:
            here = waiting.pop()
            if here in self.seen:
                continue
            self.seen.add(here)
            by_key: dict[int, None] = {}
            for index, callees in here.called.items():
                for callee in callees if index not in here.flow.infeasible else ():
                    if isinstance(callee, Analysed):
                        waiting.append(callee)
                    else:
                        by_key[callee] = None
            for key in by_key:
                waiting += self._arrive(key, here.left.get(key))

    def _arrive(self, key: int, state: State | None) -> list[Analysed]:
        """Take up calls of a function in a state; what they lead to where that is known now."""
        if key not in self.found and state is not None and self.contexts.gains(key):
            known = self.arriving.get(key)
            self.arriving[key] = state if known is None else joining.join(known, state)
            return []
        self.arriving.pop(key, None)
        default = self.contexts.any_state(key)
        if default is None or self.found.get(key) is default:
            return []
        self.found[key] = default
        return [default]

    def settle(self, key: int) -> None:
        """Analyse a function in the join of the states that have arrived."""
        state = self.arriving.pop(key)
        if tells(state) and not self.contexts.is_leaving():
            found = self.found[key] = self.contexts.entered_in(key, state, self.family)
            self.enter(found)
        else:
            self.give_up(key)

    def give_up(self, key: int) -> None:
        """Take a function as it is for every call."""
        for context in self._arrive(key, None):
            self.enter(context)


def tells(state: State) -> bool:
    """Whether a state tells its function anything."""
    return bool(effects.describe(state)) or any(state.memory.values())


def _tells_angle(state: State) -> bool:
    """Whether a state tells anything of the upper word of a double in r0 and r1."""
    return not state.range_of(state.regs[1]).is_top


def _joined(left: dict[int, State | None], key: int, state: State | None) -> State | None:
    """The states of several calls of a function, None where one of them is not known."""
    if key not in left or state is None:
        return state
    known = left[key]
    return None if known is None else joining.join(known, state)


def _no_better(inside: Analysed | None, default: Analysed) -> bool:
    """Whether a context left open what was open without it."""
    return inside is None or inside.targets is None or inside.unbounded >= default.unbounded
