"""What the executions of functions in a run had in common: each is a context of the result.

Executions of a function that passed every edge equally often, and whose calls behaved alike, are one behaviour. A
function with many of them gets one behaviour that covers all (per depth of the recursion, where it is in one).
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, replace
from typing import Any

MOST = 24
"""Behaviours of a function that are told apart."""


@dataclass(slots=True)
class Behaviour:
    """`counts` are the most executions of each edge per execution of the function, `most` those of each loop's header
    per entry of the loop; `calls` the behaviours of what each edge called; `stack` bytes used, callees included.
    `endless` are loops without a bound, `loose` those whose edges have counts that say nothing."""

    function: Any
    level: int
    counts: list[int]
    most: list[int]
    calls: dict[int, set[int]]
    stack: int
    endless: frozenset[int]
    loose: frozenset[int]


class Behaviours:
    """All behaviours of a run by number."""

    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self.all: list[Behaviour] = []
        self._known: dict[int, dict[Any, int]] = {}
        self._members: dict[int, set[int]] = {}
        self._together: dict[tuple[int, int], int] = {}
        self._collapsed: set[int] = set()

    def note(self, function: Any, level: int, frame: Any, stack: int) -> int:
        """The number of the behaviour of an execution that has ended."""
        now = frame.now
        endless, loose = frozenset(frame.endless), frozenset(frame.loose)
        if function.group in self._collapsed:
            calls = {edge: set(callees) for edge, callees in now.calls.items()}
            return self._widen(Behaviour(function, level, now.counts, now.most, calls, stack, endless, loose))
        calls_made = tuple(now.calls.items()) if len(now.calls) < 2 else tuple(sorted(now.calls.items(), key=_edge))
        signature = (tuple(now.counts), tuple(now.most), calls_made, endless, loose)
        known = self._known.setdefault(function.key, {})
        number = known.get(signature)
        if number is not None:
            mine = self.all[number]
            mine.level, mine.stack = max(mine.level, level), max(mine.stack, stack)
            return number
        number = len(self.all)
        made = {edge: set(callees) for edge, callees in now.calls.items()}
        self.all.append(Behaviour(function, level, list(now.counts), list(now.most), made, stack, endless, loose))
        known[signature] = number
        self._members.setdefault(function.group, set()).add(function.key)
        if len(known) > self._most:
            self._collapsed.add(function.group)
        return number

    def _widen(self, found: Behaviour) -> int:
        """The number of the behaviour that covers all of a function's at one level of recursion."""
        number = self._together.get((found.function.key, found.level))
        if number is None:
            number = self._together[found.function.key, found.level] = len(self.all)
            calls = {edge: set(callees) for edge, callees in found.calls.items()}
            counts, most = list(found.counts), list(found.most)
            self.all.append(
                Behaviour(found.function, found.level, counts, most, calls, found.stack, found.endless, found.loose)
            )
            return number
        mine = self.all[number]
        mine.counts = list(map(max, mine.counts, found.counts))
        mine.most = list(map(max, mine.most, found.most))
        mine.stack = max(mine.stack, found.stack)
        mine.endless, mine.loose = mine.endless | found.endless, mine.loose | found.loose
        for edge, callees in found.calls.items():
            mine.calls.setdefault(edge, set()).update(callees)
        return number

    def taken(self, functions: Collection[int]) -> dict[int, set[int]]:
        """The edges that executions of functions (keys) passed."""
        found: dict[int, set[int]] = {key: set() for key in functions}
        for mine in self.all:
            if mine.function.key in found:
                found[mine.function.key].update(edge for edge, count in enumerate(mine.counts) if count)
        return found

    def together(self, numbers: list[int]) -> int:
        """The number of a behaviour that covers these of one function."""
        if len(numbers) == 1:
            return numbers[0]
        # A level of its own keeps it apart from what calls of the function have in common.
        return max(self._widen(replace(self.all[number], level=0)) for number in numbers)

    def settle(self, entry: int) -> tuple[int, list[int]] | None:
        """The entry's number and all behaviours that count, callees before callers; those of a function with too many
        are replaced by one that covers them. None where calls go round in circles all the same."""
        replaced: dict[int, int] = {}
        for group in self._collapsed:
            for key in self._members.get(group, ()):
                for number in self._known[key].values():
                    replaced[number] = self._widen(self.all[number])
        for mine in self.all:
            for edge, callees in mine.calls.items():
                mine.calls[edge] = {replaced.get(callee, callee) for callee in callees}
        start = replaced.get(entry, entry)
        order: list[int] = []
        state: dict[int, bool] = {}
        stack = [(start, False)]
        while stack:
            number, finished = stack.pop()
            if finished:
                order.append(number)
                state[number] = True
            elif number not in state:
                state[number] = False
                stack.append((number, True))
                for callees in self.all[number].calls.values():
                    for callee in callees:
                        if state.get(callee) is False:
                            return None
                        stack.append((callee, False))
        return start, order


def _edge(item: tuple[int, Any]) -> int:
    return item[0]
