"""`mauvec simulate`: every format, windows, choices, bad input; and no simulated figure is called a WCRT."""

from __future__ import annotations

import csv
import io
import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import jsonschema
import pytest

from .conftest import MISSED, MODEL, ROOT, UNTIMED, Command

Write = Callable[..., str]

FORMATS = ("text", "json", "svg", "perfetto", "csv", "segments-csv")

TWO_NODES = (
    MODEL.replace("  node base on desk {\n  }", "  node base on desk {\n    process p { thread a { driver } }\n  }\n"
                  "  node arm on desk {\n    process p { thread b { control } }\n  }")
)  # fmt: skip

LONG = (
    MODEL.replace("period 5ms", "period 4999us")
    .replace("period 20ms", "period 20011us")
    .replace("tick every 10ms", "tick every 9973us")
)


def document(command: Command, *arguments: str) -> dict[str, Any]:
    run = command("simulate", *arguments, "--format", "json")
    found: dict[str, Any] = json.loads(run.out)
    return found


@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize("text", [MODEL, MISSED, TWO_NODES], ids=["holds", "missed", "two nodes"])
def test_no_simulated_figure_is_called_a_wcrt(format_: str, text: str, mauvec: Command, model: Write) -> None:
    run = mauvec("simulate", model(text), "--format", format_, "--runs", "random", "--seed", "2")
    assert len(run.out) > 100
    assert "wcrt" not in (run.out + run.err).lower()
    assert "worst-case" not in (run.out + run.err).lower()


def test_the_text_tells_what_was_seen_beside_what_is_proven(mauvec: Command, model: Write) -> None:
    run = mauvec("simulate", model(MODEL))
    assert (run.code, run.err) == (0, "")
    assert "no bound" in run.out.splitlines()[0]
    driver = next(line.split() for line in run.out.splitlines() if line.split()[:1] == ["driver"])
    assert driver[:5] == ["driver", "2", "5ms", "4", "60us"]
    assert re.search(r"^  control +-+#+", run.out, re.MULTILINE)
    assert "0ms" in run.out and "20ms" in run.out


def test_the_document_follows_its_schema_and_agrees_with_check(mauvec: Command, model: Write) -> None:
    schema = json.loads((ROOT / "docs" / "schema" / "simulation-1.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    for text in (MODEL, MISSED, TWO_NODES):
        name = model(text)
        found = document(mauvec, name)
        jsonschema.validate(found, schema)
        assert found["schema"] == schema["title"]
        checked = json.loads(mauvec("check", name, "--format", "json").out)
        proven = {c["name"]: c["wcrt_ps"] for n in checked["deployments"][0]["nodes"] for c in n["components"]}
        tasks = [t for p in found["simulations"][0]["processors"] for t in p["tasks"] if t["kind"] == "task"]
        assert {task["name"]: task["proven_bound"] for task in tasks} == proven
        assert all(task["response"]["greatest"] <= proven[task["name"]] for task in tasks)


def test_a_missed_deadline_is_exit_code_1(mauvec: Command, model: Write) -> None:
    found = document(mauvec, model(MISSED))
    assert mauvec("simulate", "robot.mauve").code == 1
    assert found["simulations"][0]["deadlines_missed"] > 0
    expected = MISSED.replace("  node base on desk {\n", "  expect unschedulable\n  node base on desk {\n")
    assert mauvec("simulate", model(expected)).code == 0


def test_the_same_seed_gives_the_same_run_and_another_one_another(mauvec: Command, model: Write) -> None:
    name = model(MODEL)
    options = ("--runs", "random", "--offsets", "random", "--execution", "random", "--format", "csv")
    runs = [mauvec("simulate", name, *options, "--seed", seed).out for seed in ("5", "5", "6")]
    assert runs[0] == runs[1] != runs[2]


def test_a_window_shows_less_and_measures_the_same(mauvec: Command, model: Write) -> None:
    name = model(MODEL)
    whole = document(mauvec, name, "--for", "1s")["simulations"][0]["processors"][0]
    part = document(mauvec, name, "--for", "1s", "--from", "100ms", "--to", "0.12s")["simulations"][0]["processors"][0]
    assert part["tasks"] == whole["tasks"]
    assert part["window"] == {"from": 100 * 10**9, "to": 120 * 10**9}
    assert 0 < len(part["segments"]) < len(whole["segments"]) / 10
    assert part["segments"] == [s for s in whole["segments"] if s["to"] > 100 * 10**9 and s["from"] < 120 * 10**9]
    assert sum(s["to"] - s["from"] for s in whole["segments"]) == whole["busy"] == 10**12 - whole["idle"]


def test_the_window_lengthens_the_simulation(mauvec: Command, model: Write) -> None:
    found = document(mauvec, model(MODEL), "--from", "1s", "--to", "1.01s")["simulations"][0]["processors"][0]
    assert found["simulated"] == 1_010_000_000_000
    assert found["segments"]


def test_a_long_hyperperiod_is_cut_with_a_remark(mauvec: Command, model: Write) -> None:
    found = document(mauvec, model(LONG))["simulations"][0]
    assert "the hyperperiod is" in found["remark"]
    assert found["processors"][0]["simulated"] < found["hyperperiod"]
    cut = document(mauvec, "robot.mauve", "--hyperperiod", "--events", "1000")["simulations"][0]
    assert cut["processors"][0]["cut"] and "after 1000 events" in cut["remark"]
    assert "after 1000 events" in mauvec("simulate", "robot.mauve", "--hyperperiod", "--events", "1000").out


def test_the_chart_is_a_document_with_a_tooltip_per_job(mauvec: Command, model: Write) -> None:
    run = mauvec("simulate", model(MISSED), "--format", "svg", "-o", "robot.svg")
    assert (run.code, run.out) == (1, "")
    text = Path("robot.svg").read_text(encoding="utf-8")
    root = ElementTree.fromstring(text)
    titles = [element.text or "" for element in root.iter("{http://www.w3.org/2000/svg}title")]
    assert any(title.startswith("driver, job 2: ") and "response" in title for title in titles)
    assert any("missed its deadline" in title for title in titles)
    assert "prefers-color-scheme: dark" in text
    assert "robot.svg.part" not in " ".join(str(path) for path in Path().iterdir())


def test_the_trace_nests_and_names_processes_and_threads(mauvec: Command, model: Write) -> None:
    run = mauvec("simulate", model(TWO_NODES), "--format", "perfetto", "--runs", "random")
    events = json.loads(run.out)["traceEvents"]
    names = {(e["pid"], e["tid"]): e["args"]["name"] for e in events if e["name"] == "thread_name"}
    processes = {e["args"]["name"] for e in events if e["name"] == "process_name"}
    assert processes == {"base", "arm"}
    assert set(names.values()) == {"system tick", "a", "b"}
    open_: dict[tuple[int, int], list[float]] = {}
    for event in (e for e in events if e["ph"] != "M"):
        track = event["pid"], event["tid"]
        assert track in names and event["ts"] >= 0
        assert event["ph"] in "Xi"
        if event["ph"] == "X":
            stack = open_.setdefault(track, [])
            start, end = round(event["ts"] * 1000), round((event["ts"] + event["dur"]) * 1000)
            while stack and stack[-1] <= start:
                stack.pop()
            assert not stack or end <= stack[-1]
            stack.append(end)


def test_tables_of_jobs_and_segments(mauvec: Command, model: Write) -> None:
    name = model(MODEL)
    jobs = list(csv.DictReader(io.StringIO(mauvec("simulate", name, "--format", "csv").out)))
    segments = list(csv.DictReader(io.StringIO(mauvec("simulate", name, "--format", "segments-csv").out)))
    assert {job["task"] for job in jobs} == {"system tick", "driver", "control"}
    assert all(int(job["finish"]) - int(job["arrival"]) == int(job["response"]) for job in jobs)
    for job in jobs:
        own = [s for s in segments if (s["task"], s["job"]) == (job["task"], job["job"])]
        assert sum(int(s["to"]) - int(s["from"]) for s in own) == int(job["executed"])
    assert next(s["activity"] for s in segments if (s["task"], s["job"]) == ("control", "1")) == "switch"


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--for", "10"), "say the unit"),
        (("--for", "0ms"), "nothing to simulate"),
        (("--for", "0.1ps"), "is finer than"),
        (("--for", "1s", "--hyperperiod"), "contradict"),
        (("--from", "2ms", "--to", "1ms"), "later than"),
        (("--deployment", "bank"), "`bench`"),
    ],
)
def test_wrong_usage(arguments: tuple[str, ...], words: str, mauvec: Command, model: Write) -> None:
    run = mauvec("simulate", model(MODEL), *arguments)
    assert (run.code, run.out) == (2, "")
    assert words in run.err


@pytest.mark.parametrize("given", ["-1ms", "nan", "1/0s", "soon", "5parsec", "inf", "", "1e999999999s"])
def test_what_is_no_time_is_refused(given: str, mauvec: Command, model: Write) -> None:
    run = mauvec("simulate", model(MODEL), f"--for={given}")
    assert run.code == 2
    assert "is no time" in run.err


def test_a_codel_without_a_time_is_said_and_nothing_is_simulated(mauvec: Command, model: Write) -> None:
    run = mauvec("simulate", model(UNTIMED))
    assert run.code == 1
    assert "MV520" in run.err and run.out == ""
    assert document(mauvec, "robot.mauve")["simulations"] == []


def test_a_file_that_cannot_be_written_or_read_is_said(mauvec: Command, model: Write) -> None:
    run = mauvec("simulate", model(MODEL), "-o", "nowhere/robot.svg", "--format", "svg")
    assert run.code == 1 and "cannot write" in run.err
    assert mauvec("simulate", "absent.mauve").code == 1


def test_an_interrupt_ends_it_without_half_a_file(model: Write, environment: dict[str, str]) -> None:
    name = model(LONG)
    command = [sys.executable, "-m", "mauve", "simulate", name, "--for", "1000000s", "--events", "1000000000",
               "--from", "1s", "--to", "2s", "-o", "out.txt"]  # fmt: skip
    process = subprocess.Popen(command, env=environment, stderr=subprocess.PIPE, text=True)
    time.sleep(1.5)
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=20)
    assert process.returncode == 130
    assert "interrupted" in err
    assert not Path("out.txt").exists()


# ------------------------------------------------------------------------------------------------- plain task sets
SETS = [
    {
        "schema": "mauve.taskset/1",
        "unit": "ms",
        "tasks": [
            {"name": "a", "T": 4, "C": 1, "prio": 3, "cs": [["R", 1]]},
            {"name": "b", "T": 6, "frames": [2, 1], "prio": 2},
            {"name": "c", "T": 12, "C": 3, "prio": 1, "cs": [["R", 2]], "J": 1},
        ],
    },
    {
        "schema": "mauve.taskset/1",
        "scheduler": "non-preemptive",
        "unit": "",
        "tasks": [
            {"name": "m", "T": 8.5, "psm": {"initial": "s", "edges": [{"src": "s", "dst": "s", "cost": 2}]}, "prio": 1},
            {"name": "n", "T": 5, "C": 1.5, "prio": 2},
        ],
    },
]


def test_plain_task_sets_are_simulated_in_their_own_units(mauvec: Command, model: Write) -> None:
    name = model(json.dumps(SETS), "sets.json")
    found = document(mauvec, name)["simulations"]
    assert [(one["unit"], one["hyperperiod"]) for one in found] == [("ms", 12), ("/2", 170)]
    seen = {t["name"]: t["response"]["greatest"] for t in found[0]["processors"][0]["tasks"]}
    bounds = {t["name"]: t["proven_bound"] for one in found for t in one["processors"][0]["tasks"]}
    assert seen == {"a": 2, "b": 3, "c": 9}
    assert all(seen[name] <= bounds[name] for name in seen)
    text = mauvec("simulate", name, "--for", "24", "--to", "12").out
    assert "0ms to 24ms" in text and "wcrt" not in text.lower()
    assert mauvec("simulate", name, "--for", "24ms").code == 2
    assert mauvec("simulate", name, "--deployment", "d").code == 2
    assert "<svg" in mauvec("simulate", name, "--format", "svg").out


@pytest.mark.parametrize("text", ["{", "[]", "[{}]", '{"schema": "mauve.taskset/1", "tasks": []}'])
def test_bad_task_sets_are_said(text: str, mauvec: Command, model: Write) -> None:
    run = mauvec("simulate", model(text, "sets.json"))
    assert run.code == 1
    assert run.err and run.out == ""
