"""Local graphs: one per objective, with only the resources that it can need (what the mission paper leaves as future).

The graph of a whole mission multiplies the states of all its resources. Which alternatives an objective runs depends
only on the resources in its cone, since every objective starts with everything idle; so each is looked at alone, from
every combination of resources in and out of service. Objectives side by side are kept together where their cones
overlap, and apart where they do not.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from math import prod
from typing import TypeAlias

from mauve.mission.activities import can_fail
from mauve.mission.cones import Wiring
from mauve.mission.flatten import Fork, Leaf, Link, Node, Series, flatten, leaves, short_names
from mauve.mission.graph import BudgetExceeded, LocalGraph
from mauve.mission.plan import Block, Child, Continue, Mission, Parallel, Recover, Retry, Sequence, Step
from mauve.mission.stable import BUDGET, alternatives_graph
from mauve.mission.templates import build_net
from mauve.records import changed, record


@record
class LocalMission:
    """A part of a mission as one of its own, with the paths it has in the whole.

    path: where the part stands; stems: what the events of each elementary objective are named after, as in the whole.
    """

    path: str
    mission: Mission
    stems: Mapping[str, str]


def local_missions(mission: Mission) -> tuple[LocalMission, ...]:
    """A small mission for each elementary objective at each place, and for each group that cannot be told apart.

    Before its start resources can be lost and recovered, so that it starts from every combination.
    """
    wiring = Wiring(mission)
    root = flatten(mission)
    stems = short_names(tuple(leaf.path for leaf in leaves(root)))
    return tuple(
        LocalMission(path, _cut(mission, wiring, path, block, names), stems)
        for path, block, names in _parts(wiring, root)
    )


def local_graphs(mission: Mission, budget: int = BUDGET) -> tuple[LocalGraph, ...] | BudgetExceeded:
    """The graph of each local mission; at most `budget` stable states in all."""
    graphs: list[LocalGraph] = []
    spent = 0
    for local in local_missions(mission):
        if (exceeded := too_many(local.mission, budget - spent)) is not None:
            return exceeded
        graph = alternatives_graph(build_net(local.mission, local.stems), budget - spent)
        if isinstance(graph, BudgetExceeded):
            return BudgetExceeded(budget, graph.factors)
        spent += len(graph.markings)
        graphs.append(LocalGraph(local.path, graph))
    return tuple(graphs)


def too_many(mission: Mission, budget: int) -> BudgetExceeded | None:
    """What to say where devices and retries alone have too many states; each names by how much it multiplies them.

    Whatever the mission does, each device that may fail is in service or not. An objective that is pursued can fail, so
    that each number of tries of each block around it is met with all numbers of those around that.
    """
    tried, _ = _tries(mission, flatten(mission))
    factors = tuple((device.name, 2) for device in mission.hardware if device.may_fail) + tried
    states = 1
    for _, factor in factors:
        states *= factor
        if states > budget:
            return BudgetExceeded(budget, tuple((name, 1000 * times) for name, times in factors))
    return None


Tried: TypeAlias = tuple[tuple[str, int], ...]


def _tries(mission: Mission, node: Node) -> tuple[Tried, bool]:
    """Blocks of a node and how often they are tried, all combinations of which are met; whether it surely can fail.

    Less than there are: of steps one after the other only those that are reached whatever the activities do.
    """
    match node:
        case Leaf():
            return (), True
        case Series(_, links):
            found: list[tuple[Tried, bool]] = []
            for link in links:
                found.append(_tries_of(mission, link))
                if not _can_go_on(mission, link):
                    break
            most = max((tried for tried, _ in found), key=_combinations, default=())
            return most, any(fails for _, fails in found)
        case Fork(_, children):
            each = [(_tries_of(mission, link), mandatory) for link, mandatory in children]
            return tuple(one for (tried, _), _ in each for one in tried), any(
                fails and must for (_, fails), must in each
            )


def _tries_of(mission: Mission, link: Link) -> tuple[Tried, bool]:
    inner, fails = _tries(mission, link.node)
    match link.step.on_failure:
        case Retry(times) if times > 0 and fails:
            return ((link.node.path, times + 1), *inner), True
        case Continue() | Recover():
            return inner, False
        case _:
            return inner, fails


def _can_go_on(mission: Mission, link: Link) -> bool:
    """Whether what follows a step is reached for certain: it cannot fail, or is an objective that can succeed."""
    if isinstance(link.step.on_failure, Continue):
        return True
    able = {one.name for one in mission.activities if not can_fail(one)}
    return isinstance(link.node, Leaf) and able.issuperset(link.node.objective.activities)


def _combinations(tried: Tried) -> int:
    return prod(times for _, times in tried)


def _parts(wiring: Wiring, node: Node) -> Iterator[tuple[str, Block, frozenset[str]]]:
    """Path, block and activities of each part."""
    match node:
        case Leaf(path, objective, _):
            yield path, objective, frozenset(wiring.closure(objective.activities))
        case Series(_, links):
            for link in links:
                yield from _parts(wiring, link.node)
                if link.recovery is not None:
                    yield from _parts(wiring, link.recovery)
        case Fork(path, children):
            for group in _groups(wiring, children):
                if len(group) == 1:
                    link = group[0][0]
                    yield from _parts(wiring, link.node)
                    if link.recovery is not None:
                        yield from _parts(wiring, link.recovery)
                else:
                    inner = tuple(Child(_renamed(link), mandatory) for link, mandatory in group)
                    names = frozenset(one for link, _ in group for one in _activities(wiring, link))
                    yield path, Parallel("", inner), names


def _renamed(link: Link) -> Step:
    """The step under the name that it has in the whole: there it can be the second of its name."""
    return changed(link.step, block=changed(link.step.block, name=link.node.path.rpartition(".")[2]))


def _activities(wiring: Wiring, link: Link) -> frozenset[str]:
    nodes: list[Node] = [link.node] if link.recovery is None else [link.node, link.recovery]
    names = (name for node in nodes for leaf in leaves(node) for name in leaf.objective.activities)
    return frozenset(wiring.closure(names))


def _groups(wiring: Wiring, children: Iterable[tuple[Link, bool]]) -> list[list[tuple[Link, bool]]]:
    """The children of a parallel block, together where they can need a common activity or resource."""
    groups: list[tuple[frozenset[str], list[tuple[Link, bool]]]] = []
    for child in children:
        activities = _activities(wiring, child[0])
        cone, members = activities | wiring.resources(activities), [child]
        apart = []
        for other, present in groups:
            if other & cone:
                cone, members = cone | other, present + members
            else:
                apart.append((other, present))
        groups = [*apart, (cone, members)]
    return [members for _, members in groups]


def _cut(mission: Mission, wiring: Wiring, path: str, block: Block, names: frozenset[str]) -> Mission:
    """The mission of one block with what it can need; nested as in the whole, so that paths agree."""
    taken = wiring.resources(names)
    activities = tuple(one for one in mission.activities if one.name in names)
    made = {one for activity in activities for one in activity.produces}
    outer, _, last = path.rpartition(".")
    inner: Step = Step(changed(block, name=last))
    for part in reversed(outer.split(".") if outer else []):
        inner = Step(Sequence(part, (inner,)))
    return Mission(
        path,
        Sequence(mission.root.name, (inner,)),
        activities,
        tuple(one for one in mission.software if one.name in taken | made),
        tuple(one for one in mission.hardware if one.name in taken),
    )
