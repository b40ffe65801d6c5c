"""Task sets with the answers of other tools, through the command line; documents against the published schemas."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import jsonschema
import pytest

from .conftest import Schedule

ROOT = Path(__file__).resolve().parents[2]
CASES = Path(__file__).parent / "cases"
TIMING = ROOT / "tests" / "timing" / "cases"


def load(path: Path) -> list[dict[str, Any]]:
    cases: list[dict[str, Any]] = json.loads(path.read_text(encoding="utf-8"))
    return cases


def schema(name: str) -> Any:
    return json.loads((ROOT / "docs" / "schema" / f"{name}-1.schema.json").read_text(encoding="utf-8"))


def taskset(case: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in case.items() if key not in ("expected", "blocking", "origin")}


PLAIN = [*load(TIMING / "tasksets.json"), *load(CASES / "sections.json")]
MACHINES = load(TIMING / "machines.json")


def test_every_set_is_answered_as_by_other_tools(schedule: Schedule) -> None:
    found = schedule([taskset(case) for case in PLAIN], "--format", "json")
    assert found.code == 1, "some of the textbook sets miss a deadline on purpose"
    jsonschema.validate([taskset(case) for case in PLAIN], schema("taskset"))
    jsonschema.validate(found.json, schema("schedule"))
    assert len(found.json) == len(PLAIN)
    for case, answer in zip(PLAIN, found.json, strict=True):
        assert answer["name"] == case["name"]
        assert {task["name"]: task["wcrt"] for task in answer["tasks"]} == case["expected"], case["name"]
        if "blocking" in case:
            assert {task["name"]: task["blocking"] for task in answer["tasks"]} == case["blocking"]
        assert answer["schedulable"] == all(task["schedulable"] for task in answer["tasks"])


@pytest.mark.parametrize("method", ["sporadic", "paper", "trace", "exact"])
def test_machines_by_each_method(schedule: Schedule, method: str) -> None:
    found = schedule([taskset(case) for case in MACHINES], "--format", "json", "--method", method)
    jsonschema.validate(found.json, schema("schedule"))
    for case, answer in zip(MACHINES, found.json, strict=True):
        low = next(task for task in answer["tasks"] if task["name"] == "low")
        assert low["wcrt"] == case["expected"][method]


def test_a_breakdown_adds_up_to_the_response(schedule: Schedule) -> None:
    answers = schedule([taskset(case) for case in [*PLAIN, *MACHINES]], "--format", "json").json
    for answer in answers:
        for task in answer["tasks"]:
            parts = task["breakdown"]
            due = parts["blocking"] + parts["own"]["cost"] + sum(line["cost"] for line in parts["interference"])
            assert due == parts["window"]
            assert task["wcrt"] == parts["jitter"] + due - (parts["job"] - 1) * task["period"]


BOOT = {
    "schema": "mauve.taskset/1",
    "tasks": [
        {
            "name": "A",
            "T": 10,
            "prio": 2,
            "psm": {
                "initial": "boot",
                "edges": [{"src": "boot", "dst": "run", "cost": 1}, {"src": "run", "dst": "run", "cost": 9}],
            },
        },
        {"name": "low", "T": 100, "prio": 1, "C": 5},
    ],
}
LATER = {
    "schema": "mauve.taskset/1",
    "tasks": [{"name": "hp", "T": 12, "prio": 2, "C": 5}, {"name": "m", "T": 8, "D": 12, "prio": 1, "frames": [6, 3]}],
}


def test_the_two_naive_readings_are_not_taken(schedule: Schedule) -> None:
    boot, later = (schedule(one, "--format", "json").json["tasks"][1] for one in (BOOT, LATER))
    assert (boot["wcrt"], later["wcrt"], later["breakdown"]["job"], later["schedulable"]) == (50, 14, 3, False)
    paper = schedule(LATER, "--format", "json", "--method", "paper")
    assert paper.json["tasks"][1]["wcrt"] == 11
    assert [one["code"] for one in paper.json["diagnostics"]] == ["MV603"] and "MV603" in paper.err


def test_a_machine_has_a_response_per_transition_and_state_and_a_witness_run(schedule: Schedule) -> None:
    answer = schedule(MACHINES[0] | {"expected": None}, "--format", "json").json
    machine, low = answer["tasks"]
    edges = {(edge["src"], edge["dst"]): edge["wcrt"] for edge in machine["transitions"]["edges"]}
    assert edges == {("s", "h"): 10, ("h", "s"): 1, ("s", "m"): 6, ("m", "n"): 9, ("n", "s"): 1}
    assert {one["state"]: one["wcrt"] for one in machine["transitions"]["states"]} == {"s": 10, "h": 1, "m": 9, "n": 1}
    line = low["breakdown"]["interference"][0]
    assert sum(step["cost"] for step in line["run"]) == line["cost"] == 15
    assert [(step["src"], step["dst"]) for step in line["run"]] == [("s", "m"), ("m", "n")]


def test_decimals_are_exact(schedule: Schedule) -> None:
    tasks = [{"name": "a", "T": 1, "prio": 2, "C": 0.1}, {"name": "b", "T": 3, "prio": 1, "C": 0.2}]
    found = schedule({"schema": "mauve.taskset/1", "unit": "ms", "tasks": tasks}, "--format", "json")
    assert [task["wcrt"] for task in found.json["tasks"]] == [0.1, 0.3]
    assert '"wcrt": 0.3,' in found.out, "not 0.30000000000000004"
    long = '{"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 1, "C": 0.123456789012345678}]}'
    assert '"wcrt": 0.123456789012345678,' in schedule(long, "--format", "json").out


def test_the_text_shows_rows_blockers_and_the_verdict(schedule: Schedule) -> None:
    case = next(case for case in PLAIN if case["name"] == "icpp-1")
    found = schedule(taskset(case))
    assert found.code == 0 and found.err == ""
    assert found.out == """\
icpp-1: preemptive fixed priorities

  task  period  priority  cost  blocking  by         load  WCRT  deadline  slack  verdict
  a         40         3     5         4  c in R1  12.5 %     9        40     31  holds
  b         60         2    10         6  c in R2  16.7 %    21        60     39  holds
  c        120         1    20                     16.7 %    35       120     85  holds
  load                                             45.8 %
  responses from the nominal arrival, by the trace method

all 3 deadlines hold, always
"""


def test_a_missed_deadline_comes_with_its_bill_at_its_task(schedule: Schedule) -> None:
    case = next(case for case in PLAIN if case["name"] == "classic-bw-setA")
    found = schedule(taskset(case))
    assert found.code == 1
    assert "error[MV601 deadline-missed]: `a` responds within 52" in found.err and "--> tasks.json:1:" in found.err
    assert "by 50, 52 of work is due:" in found.err and "20  b  2 x 10 (priority 2)" in found.err
    assert "1 of 3 deadlines missed" in found.out


def test_priorities_by_each_policy(schedule: Schedule) -> None:
    case = taskset(next(case for case in PLAIN if case["name"] == "classic-lehoczky90-ex2a"))
    for policy, holds in (("given", False), ("rm", False), ("dm", False), ("optimal", True)):
        found = schedule(case, "--format", "json", "--priorities", policy)
        assert found.json["schedulable"] is holds and found.code == (0 if holds else 1)
        assert found.json["priorities"] == policy
    assert [task["priority"] for task in found.json["tasks"]] == [1, 2]
    nothing = [{"name": "a", "T": 10, "C": 6}, {"name": "b", "T": 10, "C": 4.5}]
    stuck = schedule({"schema": "mauve.taskset/1", "tasks": nothing}, "--priorities", "optimal")
    assert "MV625" in stuck.err and stuck.code == 1


def test_missing_priorities_and_deadlines_are_given_and_said(schedule: Schedule) -> None:
    tasks = [{"name": "slow", "T": 20, "C": 2}, {"name": "fast", "T": 10, "C": 2, "prio": None}]
    found = schedule({"schema": "mauve.taskset/1", "tasks": tasks}, "--format", "json")
    assert [(task["priority"], task["deadline"]) for task in found.json["tasks"]] == [(1, 20), (2, 10)]
    assert [(one["code"], one["severity"]) for one in found.json["diagnostics"]] == [("MV420", "note")]


def test_sensitivity_says_what_may_change(schedule: Schedule) -> None:
    case = taskset(next(case for case in PLAIN if case["name"] == "classic-bw-setA"))
    found = schedule(case, "--format", "json", "--sensitivity")
    jsonschema.validate(found.json, schema("schedule"))
    answer = found.json["sensitivity"]
    assert (answer["speed"], answer["speed_exact"]) == (1.04, "26/25")
    assert {one["task"]: one["at_most"] for one in answer["costs"]} == {"a": 10, "b": 9, "c": 9}
    ranges = {one["task"]: one["ranges"] for one in answer["priorities"]}
    assert ranges["a"] == [] and ranges["c"] == []
    text = schedule(case, "--sensitivity").out
    assert "lowest speed of the processor: 1.04 of what it is" in text and "up to 10" in text


def test_context_switches_interrupts_and_stretches_without_preemption_count(schedule: Schedule) -> None:
    tasks = [
        {"name": "a", "T": 100, "prio": 2, "C": 20},
        {"name": "b", "T": 200, "prio": 1, "C": 30, "np": 4},
        {"name": "c", "T": 900, "prio": 0, "C": 8, "preemptive": False},
    ]
    whole = {"schema": "mauve.taskset/1", "context_switch": 3, "tasks": tasks}
    interrupts = [{"name": "uart", "T": 40, "C": 2}]
    found = schedule(whole | {"interrupts": interrupts}, "--format", "json").json
    a, b, c = found["tasks"]
    # a: the whole of c 8 + 6 of switches, own 26, one uart 2 = 42, then two: 44
    assert (a["wcrt"], a["blocking"], a["blocked_by"]["task"]) == (44, 14, "c")
    assert found["interrupts"] == [{"name": "uart", "T": 40, "C": 2}]
    assert b["blocking"] == 14 and c["wcrt"] is not None


def test_where_the_exact_method_does_not_reach_the_trace_method_answers_and_says_so(schedule: Schedule) -> None:
    tasks = [{"name": "a", "T": 10, "prio": 2, "C": 2, "J": 3}, {"name": "b", "T": 20, "prio": 1, "C": 4}]
    found = schedule({"schema": "mauve.taskset/1", "tasks": tasks}, "--format", "json", "--method", "exact")
    assert found.code == 0 and [task["method"] for task in found.json["tasks"]] == ["trace", "trace"]
    assert [(one["code"], one["severity"]) for one in found.json["diagnostics"]] == [("MV626", "note")]


def test_of_many_tasks_only_the_speed_is_varied(schedule: Schedule) -> None:
    tasks = [{"name": f"t{n}", "T": 1000 + n, "C": 5} for n in range(101)]
    found = schedule({"schema": "mauve.taskset/1", "unit": None, "tasks": tasks}, "--format", "json", "--sensitivity")
    assert "varied for up to 100 tasks" in found.err and found.code == 0
    answer = found.json["sensitivity"]
    assert (answer["costs"], answer["periods"], answer["priorities"]) == ([], [], []) and 0 < answer["speed"] < 1
    assert "lowest speed" in schedule({"schema": "mauve.taskset/1", "tasks": tasks}, "--sensitivity").out
