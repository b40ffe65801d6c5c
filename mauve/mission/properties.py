"""All that is asked of a mission's behaviour, answered on its alternatives graph."""

from __future__ import annotations

from mauve.mission.cuts import ObjectiveCuts, Sets, mission_cuts, objective_cuts
from mauve.mission.formula import Bounded, Deterministic, Live, Ltl, Property, SuccessReachable, Verdict
from mauve.mission.graph import AlternativesGraph, Confluence, MarkingsGraph, StateView
from mauve.mission.liveness import check_live
from mauve.mission.ltl import check_ltl
from mauve.mission.never import NeverFiring, never_firing
from mauve.mission.noreturn import LostSuccess, lost_success
from mauve.mission.success import check_success
from mauve.mission.survey import Survey, survey, trace
from mauve.records import changed, record

__all__ = ["ALWAYS", "Analysis", "analyse", "check_bounded", "check_deterministic"]

ALWAYS: tuple[Property, ...] = (Bounded(), Deterministic(), Live(), SuccessReachable())
"""What is answered of every mission, asked or not."""

ALL_MARKINGS = 200_000
"""Markings, transient ones too, that are looked at where one order of each cascade says too little."""


@record
class Analysis:
    """verdicts: of `ALWAYS`, then of what else was asked, in that order.

    cuts: the minimal cuts of the mission, None if they are too many to look for; objectives: those of each elementary
    objective; lost: where success is lost; never: what cannot happen.
    """

    verdicts: tuple[Verdict, ...]
    cuts: Sets | None
    objectives: tuple[ObjectiveCuts, ...]
    lost: LostSuccess
    never: NeverFiring


def analyse(graph: AlternativesGraph, confluence: Confluence, wanted: tuple[Property, ...] = ()) -> Analysis:
    """The answers to all properties wanted, and what is reported of every mission."""
    seen = survey(graph)
    asked = tuple(dict.fromkeys((*ALWAYS, *wanted)))
    verdicts = tuple(_answer(seen, confluence, one) for one in asked)
    if confluence.divergences:
        verdicts = tuple(_of_one_order(graph, one, verdict) for one, verdict in zip(asked, verdicts, strict=True))
    return Analysis(verdicts, mission_cuts(seen), objective_cuts(seen), lost_success(seen), never_firing(seen))


def check_bounded(confluence: Confluence) -> Verdict:
    """`bounded`: no place ever gets a second token, not even inside a cascade."""
    if confluence.unsafe:
        return Verdict("bounded", False, (), f"would get a second token: {', '.join(confluence.unsafe)}")
    return Verdict("bounded", True) if confluence.complete else Verdict("bounded", None, (), _incomplete(confluence))


def check_deterministic(seen: Survey, confluence: Confluence) -> Verdict:
    """`deterministic`: each event in each state leads to one stable state, whatever the order of what follows it.

    The witness is a shortest run whose last event can end in two ways; the note tells the two.
    """
    if confluence.divergences:
        first = min(confluence.divergences, key=lambda one: one.state)
        one, other = (_described(outcome) for outcome in first.outcomes)
        return Verdict(
            "deterministic", False, (*trace(seen, first.state), first.event), f"ends in {one}, or in {other}"
        )
    if confluence.endless:
        note = f"what follows {confluence.endless[0]} need not come to an end"
        return Verdict("deterministic", False, (), note)
    if not confluence.complete:
        return Verdict("deterministic", None, (), _incomplete(confluence))
    return Verdict("deterministic", True)


def _answer(seen: Survey, confluence: Confluence, one: Property) -> Verdict:
    match one:
        case Bounded():
            return check_bounded(confluence)
        case Deterministic():
            return check_deterministic(seen, confluence)
        case Live():
            return _live(seen, confluence)
        case SuccessReachable():
            return check_success(seen, one)
        case Ltl():
            return check_ltl(seen.graph, one)


def _of_one_order(graph: AlternativesGraph, asked: Property, verdict: Verdict) -> Verdict:
    """What a graph made in one order still shows where others end elsewhere: the runs it has exist, no more.

    That no place gets a second token is then looked for among all markings, where these are not too many.
    """
    match asked, verdict.holds:
        case (Deterministic(), _) | (Bounded() | Ltl(), False) | (SuccessReachable(None), True):
            return verdict
        case Bounded(), _:
            from mauve.mission.markings import markings_graph

            full = markings_graph(graph.net, ALL_MARKINGS)
            if isinstance(full, MarkingsGraph):
                return changed(verdict, holds=full.safe, note="all markings were looked at")
        case _:
            pass
    return changed(verdict, holds=None, witness=(), note="not decided: the mission is not deterministic")


def _live(seen: Survey, confluence: Confluence) -> Verdict:
    """Liveness; an activity that waits for ever for an answer is dead, too, though the rest goes on."""
    if confluence.stuck:
        state = min(confluence.stuck)
        return Verdict("live", False, trace(seen, state), "an activity waits for an answer that does not come")
    return check_live(seen)


def _incomplete(confluence: Confluence) -> str:
    return f"no violation in {confluence.orders} orders of each cascade, but not all orders were followed"


def _described(seen: StateView) -> str:
    """A stable state in a few words."""
    said = [f"{activity}.{alternative}" for activity, alternative in seen.running]
    said += [f"{activity} failed" for activity in seen.failed]
    return seen.outcome or f"({', '.join([*seen.objectives, *said])})"
