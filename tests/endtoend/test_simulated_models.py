"""`simulate` of random robots stays below what `check` proves of them: sections, exchanges, messages, calls that wait.

MAUVE_SYSTEMS and MAUVE_FIRST_SEED choose how many robots are tried, and which.
"""

from __future__ import annotations

import os
from random import Random

import pytest
from endtoend.checked import Checked, checked
from endtoend.random_models import Options, random_model

from mauve.lower.simulated import simulated_processors
from mauve.model.model import CodelId
from mauve.timing.response import Method
from mauve.timing.simulation.engine import simulate
from mauve.timing.simulation.outcome import Activity, Outcome
from mauve.timing.simulation.system import Arrivals, Execution, Jitter, Offsets, Order, Processor, Runs, Settings

SYSTEMS = int(os.environ.get("MAUVE_SYSTEMS", "24"))
FIRST = int(os.environ.get("MAUVE_FIRST_SEED", "0"))


def processor(found: Checked) -> Processor:
    node, analysis = found.settled[Method.TRACE].nodes[0], found.analysis(Method.TRACE)
    times = {CodelId(*key): time for key, time in found.times.items()}
    (made,) = simulated_processors(found.deployment, [(node, analysis.tasks)], times)
    return made


def choices(seed: int, length: int) -> Settings:
    rng = Random(seed)
    return Settings(
        length, seed, rng.choice(list(Offsets)), rng.choice(list(Runs)), rng.choice(list(Jitter)),
        rng.choice(list(Arrivals)), rng.choice(list(Execution)), rng.choice(list(Order)), events=4000,
    )  # fmt: skip


@pytest.mark.parametrize("options", [Options(), Options(calls=1.0, load=0.4)], ids=["any", "waiting"])
def test_no_simulated_response_of_a_model_exceeds_its_bound(options: Options) -> None:
    seen: list[Outcome] = []
    for seed in range(FIRST, FIRST + SYSTEMS // 4):
        found, errors = checked(random_model(seed, options))
        assert found is not None, errors
        made = processor(found)
        bounds = {result.task: result.wcrt for result in found.analysis(Method.TRACE).results}
        length = 12 * max(one.task.period for one in made.tasks)
        for settings in (Settings(length, events=4000), choices(seed, length), choices(seed + 1000, length)):
            outcome = simulate(made, settings)
            seen.append(outcome)
            for one in outcome.tasks:
                bound = bounds.get(one.task)
                assert bound is None or one.greatest is None or one.greatest <= bound, (seed, settings, one)
    kinds = {segment.activity for outcome in seen for segment in outcome.segments}
    assert {Activity.WORK, Activity.SECTION} <= kinds
    assert any(outcome.waits for outcome in seen) or not options.calls
