"""The alternatives graph: the stable states of a mission and the events between them (mission paper, section 7)."""

from __future__ import annotations

from array import array
from collections.abc import Iterator

from mauve.mission.net import Net
from mauve.records import record


@record
class Edge:
    """An event leads from one stable state to another; states are indices."""

    source: int
    event: str
    target: int


@record
class StateView:
    """What a person sees of a stable state.

    objectives: paths of the elementary ones that are pursued; running: (activity, alternative); lost: hardware out of
    service; outcome: "success", "failure" or "" while the mission goes on; failed: activities that an objective asked
    for and that have no alternative left (their objective waits for its failure to be reported).
    """

    objectives: tuple[str, ...]
    running: tuple[tuple[str, str], ...]
    lost: tuple[str, ...]
    outcome: str
    failed: tuple[str, ...] = ()

    @property
    def pursued(self) -> frozenset[str]:
        """The names of all objectives that are pursued: elementary ones, and the blocks around them."""
        return frozenset(part.partition("#")[0] for path in self.objectives for part in path.split("."))


def view(net: Net, marking: int) -> StateView:
    """What a person sees of a marking."""
    meanings = net.meanings
    return StateView(
        tuple(dict.fromkeys(path for place, path in meanings.objectives if marking >> place & 1)),
        tuple((activity, alternative) for place, activity, alternative in meanings.running if marking >> place & 1),
        tuple(name for place, name in meanings.lost if marking >> place & 1),
        next((name for place, name in meanings.outcomes if marking >> place & 1), ""),
        tuple(name for place, name in meanings.failed if marking >> place & 1),
    )


@record
class Rule:
    """What the controller does on an event: one cascade, from a stable marking to the next.

    Where `marking & tested == value`, the event `events[event]` of the net leads to `marking & ~cleared | filled`.
    In a stable marking that can be reached, one rule holds for each event that can happen, and none for any other.
    """

    event: int
    tested: int
    value: int
    cleared: int
    filled: int


@record
class AlternativesGraph:
    """Stable states by index, in breadth-first order of discovery; 0 is initial.

    markings: that of each state. The edges of state s are those at `first[s]` to `first[s + 1] - 1` in `events` (an
    index into `net.events`), `targets` (a state) and `rules_used` (an index into `rules`).
    """

    net: Net
    markings: tuple[int, ...]
    first: array[int]
    events: array[int]
    targets: array[int]
    rules_used: array[int]
    rules: tuple[Rule, ...]

    @property
    def initial(self) -> int:
        """The state before the start of the mission."""
        return 0

    def view(self, state: int) -> StateView:
        """What a person sees of a state."""
        return view(self.net, self.markings[state])

    def successors(self, state: int) -> Iterator[tuple[int, int]]:
        """The events possible in a state, as indices into `net.events`, and where they lead."""
        here = slice(self.first[state], self.first[state + 1])
        return zip(self.events[here], self.targets[here], strict=True)

    def edges(self) -> Iterator[Edge]:
        """All edges, one record at a time."""
        for state in range(len(self.markings)):
            for event, target in self.successors(state):
                yield Edge(state, self.net.events[event].name, target)


@record
class BudgetExceeded:
    """More than `budget` stable states; the resources by how many times each multiplies what was seen, greatest first.

    A factor is in thousandths: states seen for one that would remain if the resource could not be told apart.
    """

    budget: int
    factors: tuple[tuple[str, int], ...]


@record
class Fired:
    """A cascade that can end in two ways: an event in a stable state, two orders of transitions, two outcomes."""

    state: int
    event: str
    orders: tuple[tuple[str, ...], tuple[str, ...]]
    outcomes: tuple[StateView, StateView]
    markings: tuple[int, int]


@record
class Confluence:
    """How far it is shown that each event leads to one stable state, whatever the order of what follows it.

    complete: all orders of all cascades were followed; else those beyond the budget were run in `orders` random orders
    as well as the canonical one, once for each rule. markings: those visited inside cascades. unsafe: places that a
    transition would have filled twice. stuck: stable states in which an activity still waits for an answer, as indices.
    endless: events after which some order of transitions never ends.
    """

    complete: bool
    cascades: int
    markings: int
    orders: int
    divergences: tuple[Fired, ...]
    unsafe: tuple[str, ...]
    stuck: tuple[int, ...]
    endless: tuple[str, ...] = ()

    @property
    def holds(self) -> bool:
        """Whether nothing speaks against it; a proof where `complete`."""
        return not (self.divergences or self.unsafe or self.stuck or self.endless)


@record
class MarkingsGraph:
    """The size of the graph of all markings, transient ones too; `safe` where no place was ever filled twice."""

    states: int
    edges: int
    stable: int
    safe: bool


@record
class LocalGraph:
    """The graph of one block (an elementary objective, or a parallel block) with only the resources of its cone."""

    path: str
    graph: AlternativesGraph
