"""`mauvec check` as a person and as a program see it: tables, formats, stages, exit codes."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import jsonschema
import pytest
from referencing import Registry, Resource

from .conftest import MISSED, MODEL, UNTIMED, WITH_BINARY, Command

SCHEMAS = Path(__file__).resolve().parents[2] / "docs" / "schema"
Write = Callable[..., str]

TABLES = """\
deployment bench of Robot on desk (arm926ej-s at 200 MHz)

  codel          WCET  origin
  Driver.open    40us  declared
  Driver.read   250us  declared
  Control.step    1ms  declared
  3 codels: 3 declared

  component      period  priority  deadline  trace e1, e2, ...   load     WCRT    slack  verdict
  driver            5ms        2*      5ms*  270us, 60us        3.3 %    275us  4.725ms  holds
  control          20ms         1      10ms  1.02ms             5.1 %  1.295ms  8.705ms  holds
  (system tick)    10ms                      5us                0.1 %
  load of base                                                  8.4 %
  response times by the trace method; each activation includes two context switches of 10us
  * by default: priorities are rate monotonic, a deadline is the period

bench: all 2 deadlines hold, always
"""


def test_the_tables(mauvec: Command, model: Write) -> None:
    run = mauvec("check", model(MODEL))
    assert (run.code, run.err) == (0, "")
    assert run.out == TABLES


def test_default_values_do_not_bury_the_result_and_stay_available(mauvec: Command, model: Write) -> None:
    file = model(MODEL)
    assert mauvec("check", file).err == ""
    short = mauvec("check", file, "--format", "short")
    assert short.out == TABLES
    assert short.err.splitlines() == [
        "robot.mauve:29:12: note: `driver` has no priority; it gets 2, rate monotonic [MV420]",
        "robot.mauve:29:12: note: `driver` has no deadline; it gets its period, 5ms [MV420]",
    ]
    document = json.loads(mauvec("check", file, "--format", "json").out)
    assert [diagnostic["code"] for diagnostic in document["diagnostics"]] == ["MV420"] * 2


def test_a_missed_deadline_is_an_error_with_its_bill(mauvec: Command, model: Write) -> None:
    run = mauvec("check", model(MISSED))
    assert run.code == 1
    assert "error[MV601 deadline-missed]" in run.err
    assert "of work is due" in run.err
    assert "bench: 1 of 2 deadlines missed" in run.out


def test_an_expected_miss_is_no_failure(mauvec: Command, model: Write) -> None:
    text = MISSED.replace("deployment bench of Robot {", "deployment bench of Robot {\n  expect unschedulable")
    run = mauvec("check", model(text))
    assert run.code == 0
    assert "note[MV601 deadline-missed]" in run.err
    assert run.out.endswith("bench: 1 of 2 deadlines missed, as expected\n")


def test_what_has_a_time_is_reported_although_a_codel_has_none(mauvec: Command, model: Write) -> None:
    """A response without the missing work is only what it is at least: no deadline holds yet."""
    file = model(UNTIMED)
    run = mauvec("check", file)
    assert run.code == 1
    assert "MV520" in run.err
    assert "  Driver.open    none  no bound" in run.out
    row = next(line for line in run.out.splitlines() if line.startswith("  control"))
    assert ">= 1.025ms" in row and row.endswith("open")
    assert "without a response, as a codel has no time: driver" in run.out
    assert run.out.endswith("bench: incomplete, no verdict\n")
    document = json.loads(mauvec("check", file, "--format", "json").out)
    (component,) = document["deployments"][0]["nodes"][0]["components"]
    assert document["deployments"][0]["schedulable"] is None
    assert (component["wcrt_ps"], component["schedulable"]) == (None, None)
    assert component["wcrt_at_least_ps"] == 1_025_000_000


def test_long_names_and_traces_fit_a_terminal(mauvec: Command, model: Write) -> None:
    long = "a_very_long_instance_name_that_somebody_generated_from_another_tool"
    run = mauvec("check", model(MODEL.replace("control:", f"{long}:")))
    assert f"  {long} " in run.out, "nothing is cut where the output is no terminal"


def test_several_deployments_end_with_a_summary(mauvec: Command, model: Write) -> None:
    second = "\ndeployment slow extends bench {\n  node base on desk {\n    assume Control.step wcet 30ms\n  }\n}\n"
    file = model(MODEL + second)
    run = mauvec("check", file)
    assert run.code == 1
    assert run.out.splitlines()[-1] == "2 deployments: 1 not as it should be: slow"
    one = mauvec("check", file, "--deployment", "bench")
    assert (one.code, one.out) == (0, TABLES)


def test_a_model_without_deployment_says_so(mauvec: Command, model: Write) -> None:
    run = mauvec("check", model(MODEL[: MODEL.index("deployment")]))
    assert run.code == 0
    assert "MV406" in run.err
    assert run.out == "robot.mauve: no deployment, so nothing to check\n"


def test_no_tables_for_a_model_in_error(mauvec: Command, model: Write) -> None:
    run = mauvec("check", model(MODEL.replace("run step", "run stepp")))
    assert (run.code, run.out) == (1, "")
    assert "error[MV107 unknown-codel]" in run.err
    assert run.err.count("MV420") == 0


# ------------------------------------------------------------------------------------------------ formats for programs
def validator() -> jsonschema.Draft202012Validator:
    documents = {path.name: json.loads(path.read_text(encoding="utf-8")) for path in SCHEMAS.glob("*.json")}
    registry = Registry().with_resources((name, Resource.from_contents(d)) for name, d in documents.items())
    schema = documents["check-1.schema.json"]
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema, registry=registry)


@pytest.mark.parametrize(
    "text",
    [MODEL, MISSED, UNTIMED, WITH_BINARY, MODEL.replace("run step", "run stepp"), "mauve 1\n"],
    ids=["holds", "missed", "untimed", "binary", "error", "empty"],
)
def test_json_follows_the_published_schema(text: str, mauvec: Command, model: Write) -> None:
    run = mauvec("check", model(text), "--format", "json")
    document = json.loads(run.out)
    validator().validate(document)
    assert run.err == ""
    assert document["holds"] is (run.code == 0)


def test_json_has_the_bill_of_each_response(mauvec: Command, model: Write) -> None:
    document = json.loads(mauvec("check", model(MODEL), "--format", "json").out)
    node = document["deployments"][0]["nodes"][0]
    for component in node["components"]:
        bill = component["bill"]
        parts = bill["blocking_ps"] + bill["own"]["cost_ps"] + sum(line["cost_ps"] for line in bill["interference"])
        assert parts == bill["due_ps"] == bill["window_ps"] == component["wcrt_ps"]
    assert [overhead["kind"] for overhead in node["overheads"]] == ["tick"]


def test_json_says_where_a_time_comes_from(mauvec: Command, model: Write) -> None:
    """The sum over 100 elements of figure 2 of the MAUVE paper: at -O0 the header runs 101 times."""
    document = json.loads(mauvec("check", model(WITH_BINARY), "--format", "json").out)
    step = next(c for c in document["deployments"][0]["codels"] if c["codel"] == "Control.step")
    assert (step["origin"], step["symbol"]) == ("derived", "sum")
    assert step["wcet_ps"] == step["wcet_cycles"] * 5000, "200 MHz"
    (loop,) = step["analysis"]["loops"]
    assert (loop["bound"], loop["origin"], loop["source"]) == (101, "analysis", "loops.c:9")
    assert step["analysis"]["assumptions"]


def test_the_table_says_where_a_time_comes_from(mauvec: Command, model: Write) -> None:
    out = mauvec("check", model(WITH_BINARY)).out
    row = next(line.split() for line in out.splitlines() if "Control.step" in line)
    assert row[0] == "Control.step" and row[-2:] == ["derived", "sum"]
    assert "3 codels: 1 derived, 2 declared" in out


def test_sarif_and_github_are_one_document_on_standard_output(mauvec: Command, model: Write) -> None:
    file = model(MISSED)
    sarif = mauvec("check", file, "--format", "sarif")
    results = json.loads(sarif.out)["runs"][0]["results"]
    assert (sarif.code, sarif.err) == (1, "")
    assert "MV601" in {result["ruleId"] for result in results}
    github = mauvec("check", file, "--format", "github")
    assert (github.code, github.err) == (1, "")
    assert any(line.startswith("::error file=robot.mauve,") for line in github.out.splitlines())


# ----------------------------------------------------------------------------------------------------------- methods
@pytest.mark.parametrize("method", ["trace", "exact", "paper", "sporadic"])
def test_the_method_is_used_and_named(method: str, mauvec: Command, model: Write) -> None:
    run = mauvec("check", model(MODEL), "--method", method)
    assert run.code == 0
    assert f"response times by the {method} method" in run.out
    assert ("always" in run.out) is (method != "paper"), "the printed method promises less"


# ------------------------------------------------------------------------------------------------------------ stages
PSM = """\
deployment bench
psm driver
  initial (start)
  (start) -> Closed    0ms  entry
  Closed  -> Open     40us  always  = Driver.open 40us
  Open    -> Closed  250us  always  = Driver.read 250us
psm control
  initial (start)
  (start) -> On  0ms  entry
  On      -> On  1ms  stays  = Control.step 1ms
"""
TRACES = """\
deployment bench
  driver: 270us, 60us
  control: 1.02ms
"""
TASKS = """\
deployment bench
  node base
    tick system tick priority 3 period 10ms deadline 10ms e1 5us
    task driver priority 2 period 5ms deadline 5ms e1 270us overhead 20us
    task control priority 1 period 20ms deadline 10ms e1 1.02ms overhead 20us
"""


@pytest.mark.parametrize(("stage", "text"), [("psm", PSM), ("traces", TRACES), ("tasks", TASKS)])
def test_stages_print(stage: str, text: str, mauvec: Command, model: Write) -> None:
    run = mauvec("check", model(MODEL), "--emit", stage)
    assert (run.code, run.err) == (0, "")
    assert run.out == text


def test_the_tree_and_the_model_print_without_an_analysis(mauvec: Command, model: Write) -> None:
    file = model(UNTIMED)
    tree, resolved = mauvec("check", file, "--emit", "ast"), mauvec("check", file, "--emit", "model")
    assert (tree.code, tree.err, resolved.code, resolved.err) == (0, "", 0, "")
    assert "Driver" in tree.out and "Driver" in resolved.out
    assert tree.out != resolved.out


def test_graphs_print(mauvec: Command, model: Write) -> None:
    run = mauvec("check", model(WITH_BINARY), "--emit", "cfg")
    assert run.code == 0
    assert "sum" in run.out.splitlines()[0]


def test_a_stage_that_was_not_reached_prints_nothing(mauvec: Command, model: Write) -> None:
    run = mauvec("check", model(MODEL.replace("run step", "run stepp")), "--emit", "tasks")
    assert (run.code, run.out) == (1, "")
    assert "MV107" in run.err


def test_a_standard_board_is_found_whether_or_not_its_module_is_imported(mauvec: Command, model: Write) -> None:
    plain = MODEL.replace("node base on desk", 'node base on "generic-arm926ej-s"')
    imported = plain.replace("package small\n", "package small\nimport std.boards\n")
    assert plain != MODEL and imported != plain
    first = mauvec("check", model(plain))
    assert first.code == 0 and "generic-arm926ej-s" in first.out
    assert mauvec("check", model(imported)) == first


def test_details_show_bills_and_responses_per_state(mauvec: Command, model: Callable[[str], str]) -> None:
    run = mauvec("check", model(MODEL), "--details")
    assert run.code == 0
    assert "responds within" in run.out and "of its own" in run.out
    assert "transition" in run.out and "stays" in run.out


def test_sensitivity_and_priorities_in_json(mauvec: Command, model: Callable[[str], str]) -> None:
    run = mauvec("check", model(MODEL), "--sensitivity", "--priorities", "optimal", "--format", "json")
    document = json.loads(run.out)
    validator().validate(document)
    (deployment,) = document["deployments"]
    (node,) = deployment["sensitivity"]
    assert all(one["at_most_ps"] >= one["now_ps"] and one["slack_ps"] >= 0 for one in node["codels"])
    assert node["frequency_hz_at_least"] < deployment["nodes"][0]["frequency_hz"]
    assert deployment["priorities"][0]["holds"]
