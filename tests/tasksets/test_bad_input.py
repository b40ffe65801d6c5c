"""What is wrong with a file is told at its place, never a traceback, never a loop without end."""

from __future__ import annotations

import json
import time
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from .conftest import Schedule


def one(**task: Any) -> dict[str, Any]:
    return {"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 10, "C": 2, **task}]}


def psm(**fields: Any) -> dict[str, Any]:
    machine = {"initial": "s", "edges": [{"src": "s", "dst": "s", "cost": 1}], **fields}
    return {"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 10, "psm": machine}]}


BAD: list[tuple[str, object, str, str]] = [
    ("a period of zero", one(T=0), "MV623", "the period of `a` is not above 0"),
    ("a negative period", one(T=-5), "MV623", "not above 0"),
    ("a deadline of zero", one(D=0), "MV623", "the deadline of `a` is not above 0"),
    ("a negative cost", one(C=-1), "MV623", "the cost of `a` is negative"),
    ("a negative jitter", one(J=-1), "MV623", "negative"),
    ("a negative section", one(cs=[["R", -1]]), "MV623", "negative"),
    ("a section beyond its job", one(cs=[["R", 3]]), "MV623", "longer than its dearest job"),
    ("a section of no resource", one(cs=[[3, "R"]]), "MV622", "a section is a resource and a length"),
    ("sections of another kind", one(cs={"R": 1}), "MV622", "`cs` is a list"),
    ("a text for a number", one(T="10"), "MV622", "the period of `a` is a number, not a text"),
    ("a truth for a number", one(C=True), "MV622", "is a number, not true"),
    ("a number out of range", one(T=10**30), "MV623", "out of range"),
    ("a priority out of range", one(prio=2**40), "MV623", "a priority is a whole number from"),
    ("half a priority", one(prio=1.5), "MV623", "a priority is a whole number"),
    ("no name", {"schema": "mauve.taskset/1", "tasks": [{"T": 10, "C": 1}]}, "MV622", "a task has no `name`"),
    ("no period", {"schema": "mauve.taskset/1", "tasks": [{"name": "a", "C": 1}]}, "MV622", "there is no `T`"),
    ("no cost", {"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 1}]}, "MV622", "has no cost"),
    ("two costs", one(frames=[1], curve=[1]), "MV622", "gives its cost twice"),
    ("two costs that differ", one(frames=[1]), "MV623", "`C` is not the dearest job"),
    ("no frame", {"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 1, "frames": []}]}, "MV622", "one cost"),
    ("a curve that falls", {"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 1, "curve": [3, 2]}]}, "MV623",
     "falls"),
    ("a machine without transitions", psm(edges=[]), "MV623", "has no transition"),
    ("a machine that cannot begin", psm(initial="t"), "MV623", "no transition from its initial state `t`"),
    ("a machine without a beginning", psm(initial=None), "MV622", "has no `initial` state"),
    ("a transition without an end", psm(edges=[{"src": "s", "cost": 1}]), "MV622", "two names of states"),
    ("a transition without a cost", psm(edges=[{"src": "s", "dst": "s"}]), "MV622", "there is no `cost`"),
    ("a machine of another kind", {"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 1, "psm": 3}]}, "MV622",
     "is an object"),
    ("two tasks of one name", {"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 9, "C": 1}] * 2}, "MV624",
     "two tasks of the name `a`"),
    ("another schema", {"schema": "mauve.check/1", "tasks": []}, "MV622", "its schema is not"),
    ("another scheduler", one() | {"scheduler": "edf"}, "MV622", "no such scheduler"),
    ("no tasks", {"schema": "mauve.taskset/1", "tasks": []}, "MV622", "no task in the set"),
    ("tasks of another kind", {"schema": "mauve.taskset/1", "tasks": {"a": 1}}, "MV622", "it is a list of tasks"),
    ("a task of another kind", {"schema": "mauve.taskset/1", "tasks": [3]}, "MV622", "a task is an object"),
    ("an empty list", [], "MV622", "no task set in the list"),
    ("a number for a document", "3", "MV622", "a task set is an object, not a number"),
    ("null", "null", "MV621", "null"),
    ("no JSON", '{"schema": "mauve.taskset/1", "tasks": [', "MV621", "this is not JSON"),
    ("an empty file", "", "MV621", "this is not JSON"),
    ("NaN", '{"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": NaN, "C": 1}]}', "MV623", "`NaN` is not"),
    ("infinity", '{"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 5, "C": -Infinity}]}', "MV623", "is not"),
    ("a huge exponent", '{"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 1e9999, "C": 1}]}', "MV623",
     "range"),
    ("a key that is there twice", '{"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 5, "T": 6, "C": 1}]}',
     "MV622", "`T` is given twice"),
    ("very deep nesting", "[" * 100_000, "MV621", "nested too deeply"),
    ("a very long number", '{"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": ' + "9" * 9999 + ', "C": 1}]}',
     "MV623", "too many digits"),
]  # fmt: skip


@pytest.mark.parametrize(("content", "code", "words"), [case[1:] for case in BAD], ids=[case[0] for case in BAD])
def test_it_is_told_at_its_place(schedule: Schedule, content: object, code: str, words: str) -> None:
    found = schedule(content, "--format", "json")
    assert found.code == 1
    line = next(line for line in found.err.splitlines() if f"[{code}]" in line)
    assert line.startswith("tasks.json:1:") and words in line
    document = found.json[0] if isinstance(found.json, list) else found.json
    assert document["schedulable"] is None and document["tasks"] == []
    assert code in [one["code"] for one in document["diagnostics"]]


def test_places_are_those_of_the_value(schedule: Schedule) -> None:
    tasks = '{"name": "a", "T": 5, "C": 1},\n  {"name": "b", "T": -6, "C": 1}'
    text = f'{{"schema": "mauve.taskset/1",\n "tasks": [\n  {tasks}]}}'
    assert "tasks.json:4:22: error: the period of `b` is not above 0 [MV623]" in schedule(text, "--format", "json").err


def test_a_slip_in_the_name_of_a_field_is_a_warning(schedule: Schedule) -> None:
    found = schedule(one(prioo=3))
    assert found.code == 0 and "a task has no `prioo`" in found.err and "did you mean `prio`?" in found.err


def test_one_bad_set_leaves_the_others_answered(schedule: Schedule) -> None:
    found = schedule([one(), one(T=0), one(C=3)], "--format", "json")
    assert found.code == 1
    assert [answer["schedulable"] for answer in found.json] == [True, None, True]
    assert [len(answer["diagnostics"]) for answer in found.json] == [1, 1, 1]
    assert schedule([one(), one(T=0)]).out.count("task set") == 2


@pytest.mark.parametrize(
    ("text", "code", "place"),
    [
        ("name,T,D,C\na,0,5,1\n", "MV623", "2:3"),
        ("name,T,D,C\na,x,5,1\n", "MV623", "2:3"),
        ("name,T,C\na,10\n", "MV622", "2:1"),
        ("name,T\na,10\n", "MV622", "1:1"),
        ("name,T,C,X\na,10,1,1\n", "MV622", "1:10"),
        ("name,T,C\na,10,1,7\n", "MV621", "2:8"),
        ("name,T,C\n", "MV622", "1:1"),
        ("", "MV621", "1:1"),
        ("name,T,C,prio\na,10,1,high\n", "MV623", "2:8"),
        ("name,T,C\na,10,1\na,20,1\n", "MV624", "3:1"),
    ],
)
def test_csv_is_told_at_its_cell(schedule: Schedule, text: str, code: str, place: str) -> None:
    found = schedule(text, "--format", "json", name="tasks.csv")
    assert found.code == 1
    assert any(line.startswith(f"tasks.csv:{place}: error:") and f"[{code}]" in line for line in found.err.splitlines())


def test_files_that_cannot_be_read(schedule: Schedule, tmp_path: Any, capsys: Any) -> None:
    from mauve.cli import main

    (tmp_path / "latin.json").write_bytes(b'{"name": "\xe9"}')
    for name, words in (("none.json", "no such file"), ("latin.json", "not UTF-8"), (str(tmp_path), "directory")):
        assert main(["schedule", name]) == 1
        error = capsys.readouterr().err
        assert "MV620" in error and words in error


def test_an_overload_names_who_causes_it_and_answers_the_others(schedule: Schedule) -> None:
    tasks = [{"name": "a", "T": 10, "prio": 2, "C": 6}, {"name": "b", "T": 10, "prio": 1, "C": 5}]
    found = schedule({"schema": "mauve.taskset/1", "tasks": tasks}, "--format", "json")
    a, b = found.json["tasks"]
    assert (a["wcrt"], b["wcrt"], b["responsible"]) == (6, None, ["a", "b"])
    assert "MV602" in found.err and found.code == 1


def test_a_full_load_is_answered_or_refused_with_the_reason(schedule: Schedule) -> None:
    tasks = [{"name": "a", "T": 10**12 - 1, "prio": 2, "C": 5 * 10**11}, {"name": "b", "T": 10**12, "prio": 1, "C": 1}]
    tasks[1]["C"] = (10**12 - 1 - 5 * 10**11) * 10**12 // (10**12 - 1)
    start = time.process_time()
    found = schedule({"schema": "mauve.taskset/1", "tasks": tasks}, "--format", "json")
    assert found.code in (0, 1) and time.process_time() - start < 5
    whole = [{"name": "a", "T": 4, "prio": 2, "C": 2}, {"name": "b", "T": 8, "prio": 1, "C": 4, "D": 20, "B": 3}]
    assert schedule({"schema": "mauve.taskset/1", "tasks": whole}, "--format", "json").json["tasks"][1]["wcrt"] == 15


def test_enormous_hyperperiods_and_deadlines_are_bounded(schedule: Schedule) -> None:
    primes = (999_999_999_989, 999_999_999_961, 999_999_999_959)
    tasks = [{"name": f"t{i}", "T": p, "C": p // 3 - 1, "D": 10**18, "prio": i} for i, p in enumerate(primes)]
    start = time.process_time()
    found = schedule({"schema": "mauve.taskset/1", "unit": "ns", "tasks": tasks}, "--format", "json")
    assert time.process_time() - start < 10
    assert [task["name"] for task in found.json["tasks"]] == ["t0", "t1", "t2"]


def test_too_many_tasks_are_refused_at_once(schedule: Schedule) -> None:
    tasks = [{"name": f"t{i}", "T": 1000 + i, "C": 1} for i in range(12_000)]
    start = time.process_time()
    found = schedule({"schema": "mauve.taskset/1", "tasks": tasks}, "--format", "json")
    assert found.code == 1 and "MV623" in found.err and "at most 10000" in found.err
    assert time.process_time() - start < 15


@settings(max_examples=25, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.recursive(
    st.none() | st.booleans() | st.integers(-5, 99) | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3)
    | st.dictionaries(st.sampled_from(["schema", "tasks", "name", "T", "C", "psm", "edges", "cs", "frames"]), inner),
    max_leaves=12,
))
def test_no_document_breaks_the_reader(schedule: Schedule, document: Any) -> None:
    task = {"name": "a", "T": 10, "C": 1}
    for content in (document, {"schema": "mauve.taskset/1", "tasks": [{**task, "x": 1}, document]}):
        found = schedule(json.dumps(content), "--format", "json")
        assert found.code in (0, 1) and "internal error" not in found.err
