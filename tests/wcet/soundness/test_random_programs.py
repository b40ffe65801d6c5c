"""Random programs never do what the analysis calls impossible: no edge outside the graphs or called infeasible, no loop
above its bound or its total, no access outside its range, no time above the bound, on two boards."""

from __future__ import annotations

import json
import os
from pathlib import Path

import pytest
from wcet.soundness.campaign import LEVELS, TARGETS, Outcome, examine, run_seed
from wcet.soundness.generate import Function, generate

IMAGES = Path(__file__).parent / "images"
LISTING = json.loads((IMAGES / "functions.json").read_text())
SEEDS = range(int(os.environ.get("SOUNDNESS_FIRST", "1")), int(os.environ.get("SOUNDNESS_LAST", "2")))
INPUTS = int(os.environ.get("SOUNDNESS_INPUTS", "20"))


def accept(outcome: Outcome) -> None:
    assert not outcome.wrong, "\n".join(outcome.wrong)
    assert outcome.runs > 0
    assert outcome.loops, "no loop ran"
    for cycles, longest, _, name in outcome.bounds:
        assert cycles is None or cycles >= longest, name
        assert cycles is not None or any(f" {name}:" in problem for problem in outcome.problems), f"{name}: no reason"


@pytest.mark.parametrize("name", LISTING)
def test_committed_images_stay_within_their_bounds(name: str) -> None:
    entry = LISTING[name]
    functions = tuple(Function(f["name"], tuple(f["parameters"])) for f in entry["functions"])
    outcome = examine(IMAGES / f"{name}.elf", functions, TARGETS[entry["target"]][0], seed=5, inputs=8)
    accept(outcome)
    assert sum(cycles is not None for cycles, *_ in outcome.bounds) >= 3


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("seed", SEEDS)
def test_random_programs_stay_within_their_bounds(seed: int, target: str) -> None:
    """SOUNDNESS_FIRST and SOUNDNESS_LAST choose other seeds, for a long run."""
    level = LEVELS[(seed + list(TARGETS).index(target)) % len(LEVELS)]
    accept(run_seed(seed, target, level, INPUTS))


def test_a_seed_gives_the_same_program() -> None:
    assert generate(11) == generate(11)
    assert generate(11).text != generate(12).text


@pytest.mark.slow
@pytest.mark.parametrize("target", TARGETS)
@pytest.mark.parametrize("seed", SEEDS)
def test_random_loops_stay_within_their_bounds(seed: int, target: str) -> None:
    """Many small functions of a loop or two each."""
    level = LEVELS[(seed + list(TARGETS).index(target)) % len(LEVELS)]
    accept(run_seed(seed, target, level, INPUTS, small=True))
