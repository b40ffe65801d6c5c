"""No simulation of a random robot ever exceeds what `check` reports of it.

MAUVE_SYSTEMS and MAUVE_FIRST_SEED choose how many robots are tried, and which.
"""

from __future__ import annotations

import os
import re
from random import Random

import pytest
from endtoend.checked import Checked, checked, observed, violations
from endtoend.random_models import Options, random_model

from mauve.timing.response import Method

SYSTEMS = int(os.environ.get("MAUVE_SYSTEMS", "24"))
FIRST = int(os.environ.get("MAUVE_FIRST_SEED", "0"))
CHUNK = 6
FEW = range(FIRST, FIRST + 12)


def _checked(text: str) -> Checked:
    found, errors = checked(text)
    assert found is not None, errors
    return found


@pytest.mark.parametrize("first", range(FIRST, FIRST + SYSTEMS, CHUNK))
def test_no_simulation_exceeds_a_bound(first: int) -> None:
    for seed in range(first, first + CHUNK):
        found = _checked(random_model(seed))
        for run in range(2):
            assert violations(found, 1000 * seed + run, most=200) == [], f"random_model({seed}), run {run}"


def test_no_simulation_exceeds_a_bound_where_tasks_wait_for_others() -> None:
    """Operations that run in their owners: queued, served by the next activation, answered at its end."""
    bounded = 0
    for seed in range(FIRST, FIRST + SYSTEMS // 2):
        found = _checked(random_model(seed, Options(calls=1.0, load=0.4)))
        responses = _responses(found)
        bounded += sum(responses[one.task.name] < float("inf") for one in found.node.tasks if one.waits)
        for run in range(2):
            assert violations(found, 1000 * seed + run, most=150) == [], f"random_model({seed}, calls=1), run {run}"
    assert bounded > 2


def test_the_simulation_comes_close_to_the_bounds() -> None:
    """Else it would show nothing."""
    shares = []
    for seed in FEW:
        found = _checked(random_model(seed))
        runs = [observed(found, seed + run).responses for run in range(3)]
        for result in found.analysis(Method.TRACE).results:
            if result.wcrt and result.schedulable:
                shares.append(max(run.get(result.task, 0) for run in runs) / result.wcrt)
    assert max(shares) > 0.85 and sum(shares) / len(shares) > 0.4


def _responses(found: Checked, method: Method = Method.TRACE) -> dict[str, float]:
    """The responses by task, infinite where there is no bound."""
    return {r.task: float("inf") if r.wcrt is None else r.wcrt for r in found.analysis(method).results}


@pytest.mark.parametrize("seed", FEW)
def test_the_methods_are_ordered(seed: int) -> None:
    found = _checked(random_model(seed))
    exact, trace, sporadic = (_responses(found, m) for m in (Method.EXACT, Method.TRACE, Method.SPORADIC))
    assert all(exact[name] <= trace[name] <= sporadic[name] for name in trace)


@pytest.mark.parametrize("seed", FEW)
def test_no_response_falls_with_a_cost(seed: int) -> None:
    text = random_model(seed)
    before = _responses(_checked(text))
    random = Random(seed)
    longer = re.sub(r"wcet (\d+)us", lambda m: f"wcet {int(m[1]) + random.choice((0, 0, 1, 9))}us", text)
    switching = re.sub(r"context_switch (\d+)us", lambda m: f"context_switch {int(m[1]) + 7}us", text)
    for changed in (longer, switching):
        after = _responses(_checked(changed))
        assert all(after[name] >= before[name] for name in before)


@pytest.mark.parametrize("seed", FEW)
def test_names_and_the_order_of_declarations_change_nothing(seed: int) -> None:
    text = random_model(seed, Options(explicit=True))
    before = _responses(_checked(text))
    random = Random(seed)
    head, architecture, deployment = re.split(r"\n(?=architecture |deployment )", text)
    first, *components = re.split(r"\n(?=component )", head)
    random.shuffle(components)
    lines = architecture.split("\n")[1:-1]
    random.shuffle(lines)
    moved = "\n".join([first, *components, "architecture Robot {", *lines, "}", deployment])
    names = {**{f"i{n}": f"unit{9 - n}" for n in range(9)}, **{f"C{n}": f"Kind{9 - n}" for n in range(9)}}
    moved = re.sub(r"\b[iC]\d\b", lambda m: names[m[0]], moved)
    after = _responses(_checked(moved))
    assert after == {names.get(name, name): response for name, response in before.items()}
