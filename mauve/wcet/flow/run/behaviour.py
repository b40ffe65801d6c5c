"""What the executions of functions in a run had in common: each is a context of the result.

Executions of a function that passed every edge equally often, and whose calls behaved alike, are one behaviour. A
function with many of them gets one behaviour that covers all (per depth of the recursion, where it is in one).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

MOST = 24
"""Behaviours of a function that are told apart."""


@dataclass(slots=True)
class Behaviour:
    """`counts` are the most executions of each edge per execution of the function, `most` those of each loop's header
    per entry of the loop; `calls` the behaviours of what each edge called; `stack` bytes used, callees included."""

    function: Any
    level: int
    counts: list[int]
    most: list[int]
    calls: dict[int, set[int]]
    stack: int


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
        if function.group in self._collapsed:
            return self._widen(function, level, frame.counts, frame.most, frame.calls, stack)
        calls = tuple(frame.calls.items()) if len(frame.calls) < 2 else tuple(sorted(frame.calls.items()))
        signature = (tuple(frame.counts), tuple(frame.most), calls)
        known = self._known.setdefault(function.key, {})
        number = known.get(signature)
        if number is not None:
            mine = self.all[number]
            mine.level, mine.stack = max(mine.level, level), max(mine.stack, stack)
            return number
        number = len(self.all)
        made = {edge: set(callees) for edge, callees in frame.calls.items()}
        self.all.append(Behaviour(function, level, list(frame.counts), list(frame.most), made, stack))
        known[signature] = number
        self._members.setdefault(function.group, set()).add(function.key)
        if len(known) > self._most:
            self._collapsed.add(function.group)
        return number

    def _widen(self, function: Any, level: int, counts: Any, most: Any, calls: Any, stack: int) -> int:
        number = self._together.get((function.key, level))
        if number is None:
            number = self._together[function.key, level] = len(self.all)
            made = {edge: set(callees) for edge, callees in calls.items()}
            self.all.append(Behaviour(function, level, list(counts), list(most), made, stack))
            return number
        mine = self.all[number]
        mine.counts = list(map(max, mine.counts, counts))
        mine.most = list(map(max, mine.most, most))
        mine.stack = max(mine.stack, stack)
        for edge, callees in calls.items():
            mine.calls.setdefault(edge, set()).update(callees)
        return number

    def settle(self, entry: int) -> tuple[int, list[int]] | None:
        """The entry's number and all behaviours that count, callees before callers; those of a function with too many
        are replaced by one that covers them. None where calls go round in circles all the same."""
        replaced: dict[int, int] = {}
        for group in self._collapsed:
            for key in self._members.get(group, ()):
                for number in self._known[key].values():
                    mine = self.all[number]
                    wide = self._widen(mine.function, mine.level, mine.counts, mine.most, mine.calls, mine.stack)
                    replaced[number] = wide
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
