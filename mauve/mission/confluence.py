"""Whether each event leads to one stable state, whatever the order of what follows it: followed, not claimed.

All orders of the transitions of a cascade are followed, in parts where it falls into some (`orders`), as a whole where
it is not confluent. What they do depends only on the places they look at, so that cascades which look the same to all
their orders are followed once, as in `stable`. Where the markings inside cascades go beyond a budget, each rule that
was not met before runs in a few random orders instead.
"""

from __future__ import annotations

from random import Random

from mauve.mission.cascades import LONGEST, Masks, armed, bits, masks
from mauve.mission.graph import AlternativesGraph, Confluence, Fired, view
from mauve.mission.net import Level
from mauve.mission.orders import Orders, OverBudget, Unusual, has_cycle
from mauve.records import record

BUDGET = 1_000_000
"""Markings inside cascades, where nobody says otherwise."""

ORDERS = 3
"""Random orders of each cascade beyond the budget."""

SHOWN = 20
"""Divergences that are kept; one mistake in a mission makes many."""


@record
class _Spread:
    """All that a cascade can do: its ends, where there are several with one order for each; the places that decided;
    how many markings there are."""

    ends: dict[int, tuple[int, ...]]
    depends: int
    markings: int
    unsafe: int
    endless: bool


def confluence(graph: AlternativesGraph, budget: int = BUDGET, orders: int = ORDERS, seed: int = 1) -> Confluence:
    """Follows all orders of all cascades of a graph, up to `budget` transient markings; then `orders` random ones."""
    net = graph.net
    table = masks(net)
    parts = Orders(table)
    number = {event.name: index for index, event in enumerate(net.events)}
    starts: list[list[int]] = [[] for _ in net.events]
    for index, one in enumerate(net.transitions):
        if one.level is Level.EVENT and one.event:
            starts[number[one.event]].append(index)
    memo: list[dict[int, set[int]]] = [{} for _ in net.events]
    tried: set[int] = set()
    spent = cascades = unsafe = 0
    complete = True
    endless: set[str] = set()
    divergences: list[Fired] = []
    random = Random(seed)
    for state, marking in enumerate(graph.markings):
        for edge in range(graph.first[state], graph.first[state + 1]):
            event, rule = graph.events[edge], graph.rules_used[edge]
            known = memo[event]
            for mask, values in known.items():
                if marking & mask in values:
                    break
            else:
                if not complete and rule in tried:
                    continue
                cascades += 1
                tried.add(rule)
                try:
                    spread = _spread(parts, marking, starts[event], budget - spent if complete else 0)
                    known.setdefault(spread.depends, set()).add(marking & spread.depends)
                except OverBudget:
                    complete = False
                    spread = _random_orders(table, marking, starts[event], orders, random)
                spent += spread.markings
                unsafe |= spread.unsafe
                endless |= {net.events[event].name} if spread.endless else set()
                if len(spread.ends) > 1 and len(divergences) < SHOWN:
                    divergences.append(_fired(graph, state, event, spread))
    return Confluence(
        complete,
        cascades,
        spent,
        0 if complete else orders,
        tuple(divergences),
        tuple(name for place, name in enumerate(net.places) if unsafe >> place & 1),
        stuck(graph),
        tuple(sorted(endless)),
    )


def stuck(graph: AlternativesGraph) -> tuple[int, ...]:
    """The stable states in which a part of the mission waits for what never comes."""
    transient = sum(1 << place for place in graph.net.transient)
    return tuple(state for state, marking in enumerate(graph.markings) if marking & transient)


def _fired(graph: AlternativesGraph, state: int, event: int, spread: _Spread) -> Fired:
    net = graph.net
    (first, order), (second, other) = list(spread.ends.items())[:2]
    return Fired(
        state,
        net.events[event].name,
        (tuple(net.transitions[one].name for one in order), tuple(net.transitions[one].name for one in other)),
        (view(net, first), view(net, second)),
        (first, second),
    )


def _enabled(table: Masks, state: int, candidates: int, depends: int) -> tuple[int, int, int]:
    """Of these candidates those enabled, those of the highest level among them, and what was looked at in addition.

    Levels below the first with an enabled transition are left as candidates, unseen.
    """
    before = table.before
    for of_level in table.by_level[:0:-1]:
        here = candidates & of_level
        if not here:
            continue
        firing = 0
        while here:
            low = here & -here
            here ^= low
            needed = before[low.bit_length() - 1]
            missing = needed & ~state
            if not missing:
                firing |= low
                depends |= needed
            else:
                candidates ^= low
                if not missing & depends:
                    depends |= missing & -missing
        if firing:
            return candidates, firing, depends
    return 0, 0, depends


def _spread(parts: Orders, state: int, events: list[int], budget: int) -> _Spread:
    """All that a cascade can do, in parts or as a whole. Raises OverBudget."""
    before, followed = parts.table.before, parts.followed
    looks = 0
    enabled = []
    for event in events:
        missing = before[event] & ~state
        if missing:
            looks |= missing & -missing
        else:
            enabled.append(event)
    if len(enabled) == 1:
        try:
            end, looked = parts.cascade(state, enabled[0], budget)
            return _Spread({end: ()}, looks | looked, parts.followed - followed, 0, endless=False)
        except Unusual:
            budget -= parts.followed - followed
    return _all_orders(parts.table, state, events, budget)


def _all_orders(table: Masks, state: int, events: list[int], budget: int) -> _Spread:
    """Every order in which the cascades of an event's enabled transitions can run, as a whole. Raises OverBudget."""
    taken, filled, wakes, by_level = table.taken, table.filled, table.wakes, table.by_level[:0:-1]
    before, disarmed, armed_by = table.before, table.disarmed, table.armed
    depends = unsafe = 0
    steady = armed(table, state)
    depths: dict[int, int] = {}
    queue: list[tuple[int, int, int]] = []
    ends: list[int] = []
    uneven = False
    for event in events:
        missing = before[event] & ~state
        if missing:
            depends |= missing & -missing
            continue
        depends |= before[event] | filled[event]
        unsafe |= state & filled[event]
        after = state & ~taken[event] | filled[event]
        if after not in depths:
            depths[after] = 0
            queue.append((after, wakes[event], steady & ~disarmed[event] | armed_by[event]))
    for marking, candidates, live in queue:
        if len(depths) > budget:
            raise OverBudget
        rest = candidates & live
        firing = 0
        # As in `_enabled`, which is not called: most of the time goes by here.
        for of_level in by_level:
            here = rest & of_level
            while here:
                low = here & -here
                here ^= low
                needed = before[low.bit_length() - 1]
                missing = needed & ~marking
                if not missing:
                    firing |= low
                    depends |= needed
                else:
                    rest ^= low
                    if not missing & depends:
                        depends |= missing & -missing
            if firing:
                break
        if not firing:
            ends.append(marking)
            continue
        depth = depths[marking] + 1
        while firing:
            low = firing & -firing
            firing ^= low
            index = low.bit_length() - 1
            new = filled[index]
            unsafe |= marking & new
            depends |= new
            after = marking & ~taken[index] | new
            known = depths.get(after)
            if known is None:
                depths[after] = depth
                queue.append((after, rest | wakes[index], live & ~disarmed[index] | armed_by[index]))
            elif known != depth:
                uneven = True
    orders: dict[int, tuple[int, ...]] = dict.fromkeys(ends, ())
    # Where all ways to a marking are equally long, none leads back to it.
    endless = not ends
    if uneven or len(ends) > 1:
        reached, follow = _explored(table, state, events)
        orders = {end: _order(reached, end) for end in ends}
        endless = endless or has_cycle(follow)
    return _Spread(orders, depends | table.transient, len(depths), unsafe, endless)


def _explored(table: Masks, state: int, events: list[int]) -> tuple[dict[int, tuple[int, int]], dict[int, list[int]]]:
    """The markings of a cascade, each with one before it and the transition between, and each with all that follow."""
    steady = armed(table, state)
    reached: dict[int, tuple[int, int]] = {}
    follow: dict[int, list[int]] = {}
    queue: list[tuple[int, int, int]] = []
    for event in events:
        after = state & ~table.taken[event] | table.filled[event]
        if not table.before[event] & ~state and after not in reached:
            reached[after] = (-1, event)
            queue.append((after, table.wakes[event], steady & ~table.disarmed[event] | table.armed[event]))
    for marking, candidates, live in queue:
        rest, firing, _ = _enabled(table, marking, candidates & live, -1)
        following = follow[marking] = []
        for index in bits(firing):
            after = marking & ~table.taken[index] | table.filled[index]
            following.append(after)
            if after not in reached:
                reached[after] = (marking, index)
                queue.append((after, rest | table.wakes[index], live & ~table.disarmed[index] | table.armed[index]))
    return reached, follow


def _order(reached: dict[int, tuple[int, int]], end: int) -> tuple[int, ...]:
    order: list[int] = []
    marking = end
    while marking != -1:
        marking, index = reached[marking]
        order.append(index)
    return tuple(reversed(order))


def _random_orders(table: Masks, state: int, events: list[int], orders: int, random: Random) -> _Spread:
    """A few random orders of a cascade; they prove nothing, but find most mistakes."""
    ends: dict[int, tuple[int, ...]] = {}
    unsafe = markings = 0
    steady = armed(table, state)
    enabled = [event for event in events if not table.before[event] & ~state]
    for number in range(orders + 1):
        event = random.choice(enabled) if number else enabled[0]
        unsafe |= state & table.filled[event]
        marking, candidates = state & ~table.taken[event] | table.filled[event], table.wakes[event]
        live = steady & ~table.disarmed[event] | table.armed[event]
        order = [event]
        while True:
            candidates, firing, _ = _enabled(table, marking, candidates & live, -1)
            if not firing:
                break
            index = random.choice(list(bits(firing))) if number else (firing & -firing).bit_length() - 1
            unsafe |= marking & table.filled[index]
            marking = marking & ~table.taken[index] | table.filled[index]
            live = live & ~table.disarmed[index] | table.armed[index]
            order.append(index)
            if len(order) > LONGEST:
                return _Spread(ends, 0, markings + len(order), unsafe, endless=True)
            candidates |= table.wakes[index]
        markings += len(order)
        ends.setdefault(marking, tuple(order))
    return _Spread(ends, 0, markings, unsafe, endless=False)
