"""Local graphs: one per objective, with only the resources that it can need (what the mission paper leaves as future).

The graph of a whole mission multiplies the states of all its resources. Which alternatives an objective runs depends
only on the resources in its cone, since every objective starts with everything idle; so each is looked at alone, from
every combination of resources in and out of service. Objectives side by side are kept together where their cones
overlap, and apart where they do not.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from mauve.mission.cones import Wiring
from mauve.mission.flatten import Fork, Leaf, Link, Node, Series, flatten, leaves, short_names
from mauve.mission.graph import BudgetExceeded, LocalGraph
from mauve.mission.plan import Block, Child, Mission, Parallel, Sequence, Step
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
        if (exceeded := too_many_devices(local.mission, budget - spent)) is not None:
            return exceeded
        graph = alternatives_graph(build_net(local.mission, local.stems), budget - spent)
        if isinstance(graph, BudgetExceeded):
            return BudgetExceeded(budget, graph.factors)
        spent += len(graph.markings)
        graphs.append(LocalGraph(local.path, graph))
    return tuple(graphs)


def too_many_devices(mission: Mission, budget: int) -> BudgetExceeded | None:
    """What to say where the states of the devices alone, all of which are reached before the start, are too many."""
    devices = [device.name for device in mission.hardware if device.may_fail]
    if len(devices) < budget.bit_length() and 1 << len(devices) <= budget:
        return None
    return BudgetExceeded(budget, tuple((name, 2000) for name in devices))


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
