"""The modes of a mission as part of mauve.check/1. Times in picoseconds."""

from __future__ import annotations

from mauve.verdict.modes import Failing, Leg, ModesResult, Reaction


def modes_document(result: ModesResult) -> dict[str, object]:
    """How many sets of tasks were checked, where a deadline is missed, the worst responses, and the reactions."""
    return {
        "mission": result.mission.name,
        "modes": result.modes,
        "mode_task_sets": result.mode_sets,
        "switches": result.switches,
        "switch_task_sets": result.switch_sets,
        "holds": result.holds,
        "failing": [_failing(one) for one in result.failing],
        "components": [
            {"name": one.task, "wcrt_ps": one.wcrt, "schedulable": one.schedulable} for one in result.worst
        ],
        "reactions": [_reaction(one) for one in result.reactions],
    }


def _failing(one: Failing) -> dict[str, object]:
    missed = [r.task for _, analysis in one.nodes if analysis for r in analysis.results if not r.schedulable]
    return {"events": list(one.events), "switch": one.switch, "instances": list(one.instances), "missed": missed}


def _reaction(one: Reaction) -> dict[str, object]:
    return {
        "event": one.event,
        "bound_ps": one.bound,
        "detector": _leg(one.detector),
        "controller": _leg(one.controller),
        "switched": _leg(one.switched),
    }


def _leg(leg: Leg | None) -> dict[str, object] | None:
    return None if leg is None else {"task": leg.task, "wait_ps": leg.wait, "response_ps": leg.response}
