"""Missions to verdicts: net, alternatives graph, confluence and properties of each mission.

Where the graph is larger than its budget, each objective is analysed on a graph of its own (`local`), and what follows
for the whole is combined from these.
"""

from __future__ import annotations

from collections.abc import Sequence
from time import process_time

from mauve.lower.mission import plan, properties
from mauve.mission import formula as f
from mauve.mission.cascades import Unsafe, Unsound
from mauve.mission.confluence import confluence
from mauve.mission.contention import Contention, contentions
from mauve.mission.graph import AlternativesGraph, BudgetExceeded, Confluence, LocalGraph, MarkingsGraph
from mauve.mission.local import local_graphs, too_many
from mauve.mission.net import Net
from mauve.mission.plan import Mission as Plan
from mauve.mission.properties import ALWAYS, Analysis, analyse
from mauve.mission.stable import alternatives_graph
from mauve.mission.templates import build_net
from mauve.mission.verify import production_cycles
from mauve.model.mission_tree import Dependence
from mauve.model.missions import Claim, Ltl, Mission
from mauve.records import changed, record

STATES = 1_000_000
"""Stable states of one mission, where nobody says otherwise."""


@record
class MissionOptions:
    """How much may be looked at: stable states, and whether the graph of all markings is built, too."""

    states: int = STATES
    markings: bool = False


CHECKED = MissionOptions(states=250_000)
"""What `mauvec check` looks at, which has other work to do."""


@record
class Asked:
    """The verdict on something that the mission is checked for."""

    verdict: f.Verdict
    written: Claim | Ltl


@record
class LocalResult:
    """An objective on a graph of its own."""

    path: str
    graph: AlternativesGraph
    analysis: Analysis


@record
class MissionResult:
    """All that was found about a mission. `graph` and `analysis` are None where the states were too many; then
    `exceeded` says so and `local` has the objectives; or where the net is not sound, as the verdicts say. `verdicts`
    begins with those that every mission gets, then has what was asked besides; `cuts` are the minimal sets of devices
    without which the mission cannot succeed."""

    mission: Mission
    plan: Plan
    net: Net
    graph: AlternativesGraph | None
    exceeded: BudgetExceeded | None
    confluence: Confluence | None
    analysis: Analysis | None
    local: tuple[LocalResult, ...]
    verdicts: tuple[f.Verdict, ...]
    asked: tuple[Asked, ...]
    cuts: tuple[tuple[str, ...], ...]
    contentions: tuple[Contention, ...]
    markings: MarkingsGraph | BudgetExceeded | None
    seconds: float

    def verdict(self, name: str) -> f.Verdict:
        """The verdict of a name."""
        return next(verdict for verdict in self.verdicts if verdict.name == name)

    @property
    def holds(self) -> bool:
        """Whether all that was asked holds, the mission can succeed, and what else must hold of any is not refuted."""
        if not self.verdict("success_reachable").holds:
            return False
        always = (self.verdict("deterministic"), self.verdict("bounded"))
        if self.confluence is not None and (self.confluence.stuck or self.confluence.endless):
            return False
        return all(v.holds is not False for v in always) and all(one.verdict.holds for one in self.asked)

    @property
    def answer(self) -> str:
        """The verdict in words."""
        if self.holds:
            return "holds"
        refuted = any(one.holds is False for one in self.verdicts)
        return "does not hold" if refuted or not any(one.holds is None for one in self.verdicts) else "is not decided"


def check_mission(mission: Mission, options: MissionOptions) -> MissionResult:
    """A resolved mission to its verdicts."""
    begin = process_time()
    plan_ = plan(mission)
    net = build_net(plan_)
    asked = properties(mission)
    rivals = contentions(plan_)
    wanted = tuple(property_ for property_, _ in asked)
    markings: MarkingsGraph | BudgetExceeded | None = None
    if options.markings:
        from mauve.mission.markings import markings_graph

        markings = markings_graph(net)
    graph: AlternativesGraph | None = None
    exceeded: BudgetExceeded | None = None
    shown: Confluence | None = None
    analysis: Analysis | None = None
    local: tuple[LocalResult, ...] = ()
    try:
        found = _graph(net, plan_, options.states)
        if isinstance(found, BudgetExceeded):
            exceeded = found
            local, verdicts, cuts = _by_objectives(mission, plan_, wanted)
        else:
            graph, shown = found, confluence(found)
            analysis = analyse(graph, shown, wanted)
            verdicts, known = analysis.verdicts, None if shown.divergences else analysis.cuts
            cuts = _static_cuts(mission) if known is None else known
    except Unsound as error:
        verdicts, cuts = _unsound(error, plan_, wanted), _static_cuts(mission)
    order = tuple(dict.fromkeys((*ALWAYS, *wanted)))
    by_property = dict(zip(order, verdicts, strict=True))
    answers = tuple(Asked(by_property[property_], written) for property_, written in asked)
    seconds = process_time() - begin
    return MissionResult(
        mission, plan_, net, graph, exceeded, shown, analysis, local, verdicts, answers, cuts, rivals, markings, seconds
    )


def _graph(net: Net, plan_: Plan, budget: int) -> AlternativesGraph | BudgetExceeded:
    """The alternatives graph, unless the states of devices and retries alone are too many."""
    return too_many(plan_, budget) or alternatives_graph(net, budget)


def _unsound(error: Unsound, plan_: Plan, wanted: Sequence[f.Property]) -> tuple[f.Verdict, ...]:
    """The verdicts of a mission without a graph, since a cascade breaks the net: what it breaks, and nothing else."""
    unsafe = isinstance(error, Unsafe)
    broken = f.Bounded() if unsafe else f.Deterministic()
    what = "two requests meet in one place" if unsafe else "what follows the last event never comes to an end"
    cycles = production_cycles(plan_)
    why = f": {' needs '.join((*cycles[0], cycles[0][0]))}" if cycles else ""
    return tuple(
        f.Verdict(_name(one), False, error.run, what + why)
        if one == broken
        else f.Verdict(_name(one), None, (), f"not looked at: the mission is not {_name(broken)}")
        for one in dict.fromkeys((*ALWAYS, *wanted))
    )


def _static_cuts(mission: Mission) -> tuple[tuple[str, ...], ...]:
    """The cuts of the mission from what its activities depend on."""
    order = {device.name: index for index, device in enumerate(mission.hardware)}
    cuts = Dependence(mission.hardware, mission.activities).block(mission.root)
    sets = (tuple(sorted(cut, key=order.__getitem__)) for cut in cuts)
    return tuple(sorted(sets, key=lambda cut: (len(cut), [order[name] for name in cut])))


# ------------------------------------------------------------------------------------------------ local graphs
def _by_objectives(
    mission: Mission, plan_: Plan, wanted: Sequence[f.Property]
) -> tuple[tuple[LocalResult, ...], tuple[f.Verdict, ...], tuple[tuple[str, ...], ...]]:
    """The verdicts of a mission from those of its objectives, each with the resources that it depends on."""
    graphs = local_graphs(plan_, STATES)
    cuts = _static_cuts(mission)
    order = tuple(dict.fromkeys((*ALWAYS, *wanted)))
    if isinstance(graphs, BudgetExceeded):
        note = "a single objective has too many states"
        return (), tuple(f.Verdict(_name(one), None, (), note) for one in order), cuts
    local = tuple(_local(one, order) for one in graphs)
    return local, tuple(_combined(one, local) for one in order), cuts


def _local(one: LocalGraph, order: Sequence[f.Property]) -> LocalResult:
    share = tuple(property_ for property_ in order if not isinstance(property_, f.Ltl))
    devices = {name for _, name in one.graph.net.meanings.lost}
    wanted = tuple(
        changed(p, among=tuple(name for name in p.among if name in devices) or ("",))
        if isinstance(p, f.SuccessReachable) and p.among
        else p
        for p in share
    )
    return LocalResult(one.path, one.graph, _analysed(one.graph, wanted))


def _analysed(graph: AlternativesGraph, wanted: tuple[f.Property, ...]) -> Analysis:
    return analyse(graph, confluence(graph), wanted)


def _combined(wanted: f.Property, local: Sequence[LocalResult]) -> f.Verdict:
    """What the objectives say about the whole. A property of each is one of all: objectives begin with all at rest, and
    success of all is success. Where one fails, the mission may still get over it, so nothing is decided."""
    name = _name(wanted)
    if isinstance(wanted, f.Ltl):
        return f.Verdict(name, None, (), "a formula is decided on the graph of the whole mission")
    for one in local:
        verdict = next(v for v in one.analysis.verdicts if _kind(v.name) == _kind(name))
        if isinstance(wanted, (f.Bounded, f.Deterministic)) and verdict.holds is False:
            return f.Verdict(name, False, verdict.witness, f"in the objective {one.path}: {verdict.note}")
        if not verdict.holds:
            return f.Verdict(name, None, verdict.witness, f"not shown for the objective {one.path}")
    return f.Verdict(name, True, (), f"shown for each of {len(local)} objectives on a graph of its own")


def _kind(name: str) -> str:
    """The name of a verdict without the resources, which a local graph may not have."""
    return name.partition("_lost_of_")[0]


def _name(wanted: f.Property) -> str:
    match wanted:
        case f.Bounded():
            return "bounded"
        case f.Deterministic():
            return "deterministic"
        case f.Live():
            return "live"
        case f.Ltl(name, _):
            return name
        case f.SuccessReachable(None, _):
            return "success_reachable"
        case f.SuccessReachable(lost, among):
            return f"success_reachable_with_{lost}_lost" + (f"_of_{'_'.join(among)}" if among else "")
