"""Random missions written in the language come back as the plans they were, and are judged without a surprise."""

from __future__ import annotations

import pytest
from mission.random_missions import random_mission
from missions.written import text_of

from mauve.diagnostics.diagnostic import Report, Severity
from mauve.lower.mission import plan
from mauve.mission.flatten import flatten, leaves
from mauve.mission.plan import Elementary, Mission, Recover, Sequence, Step
from mauve.model.missions import Mission as Resolved
from mauve.model.resolve import resolve
from mauve.records import changed
from mauve.source import SourceFile
from mauve.syntax.parse import parse
from mauve.verdict.missions import MissionOptions, check_mission


def resolved(text: str) -> Resolved:
    report = Report()
    module = parse(SourceFile("m.mauve", text), report)
    assert not report.has_errors, [d.message for d in report]
    model = resolve((module,), (), report)
    assert [d.message for d in report if d.severity is Severity.ERROR and not d.code.startswith("MV7")] == []
    assert model.missions is not None
    (mission,) = model.missions.missions
    return mission


def with_named_recoveries(mission: Mission) -> Mission:
    """The plan as the language has it: the block of a recovery is called `recovery`, the root as the mission, and an
    objective names each activity once."""
    return changed(mission, root=changed(_sequence(mission.root), name=mission.name))


def _sequence(block: Sequence) -> Sequence:
    return changed(block, steps=tuple(_step(step) for step in block.steps))


def _step(step: Step) -> Step:
    block, reaction = step.block, step.on_failure
    if isinstance(block, Sequence):
        block = _sequence(block)
    elif isinstance(block, Elementary):
        block = changed(block, activities=tuple(dict.fromkeys(block.activities)))
    else:
        block = changed(block, children=tuple(changed(c, step=_step(c.step)) for c in block.children))
    if isinstance(reaction, Recover):
        reaction = changed(reaction, block=changed(_sequence(reaction.block), name="recovery"))
    return changed(step, block=block, on_failure=reaction)


SEEDS = [
    seed for seed in range(100) if all(leaf.objective.activities for leaf in leaves(flatten(random_mission(seed))))
]
"""In the language, every objective does something."""


@pytest.mark.parametrize("seed", SEEDS)
def test_a_random_mission_comes_back_from_its_text(seed: int) -> None:
    mission = random_mission(seed)
    assert plan(resolved(text_of(mission))) == with_named_recoveries(mission)


@pytest.mark.parametrize("seed", SEEDS[::4])
def test_a_random_mission_is_sound_and_its_cuts_agree_with_what_it_depends_on(seed: int) -> None:
    """Objective by objective, the cuts of the graph are those of the dependencies, which no state is built for."""
    from mauve.model.mission_tree import NEVER, Dependence, elementary

    mission = resolved(text_of(random_mission(seed)))
    result = check_mission(mission, MissionOptions(states=50_000))
    assert result.graph is not None and result.analysis is not None
    assert result.verdict("bounded").holds and result.verdict("deterministic").holds and result.verdict("live").holds
    dependence = Dependence(mission.hardware, mission.activities)
    expected = {one.name: {frozenset(cut) for cut in dependence.block(one)} for one in elementary(mission.root)}
    reached = {path for view in map(result.graph.view, range(len(result.graph.markings))) for path in view.objectives}
    for one in result.analysis.objectives:
        name = one.path.rpartition(".")[2].partition("#")[0]
        if one.path in reached and set(NEVER) != expected[name]:
            assert {frozenset(cut) for cut in one.cuts} == expected[name], one.path
