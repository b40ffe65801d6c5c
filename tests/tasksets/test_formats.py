"""CSV, MAST text and Cheddar XML: read, written, and what has no counterpart told at its place."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from .conftest import Schedule

MAST = """\
Model (Model_Name => davis, Model_Date => 2024-01-01);  -- non-preemptive
Processing_Resource (Type => Regular_Processor, Name => cpu, Max_Interrupt_Priority => 32767, Speed_Factor => 1.00);
Scheduler (Type => Primary_Scheduler, Name => cpu_scheduler, Host => cpu,
   Policy => (Type => Fixed_Priority, Worst_Context_Switch => 0.00, Max_Priority => 32767, Min_Priority => 1));
Shared_Resource (Type => Immediate_Ceiling_Resource, Name => R1, Ceiling => 32767, Preassigned => NO);
Scheduling_Server (Type => Regular, Name => sa, Scheduler => cpu_scheduler,
   Server_Sched_Parameters => (Type => Fixed_Priority_Policy, The_Priority => 3, Preassigned => NO));
Scheduling_Server (Type => Regular, Name => sb, Scheduler => cpu_scheduler,
   Server_Sched_Parameters => (Type => Fixed_Priority_Policy, The_Priority => 2, Preassigned => NO));
Operation (Type => Simple, Name => lock, Worst_Case_Execution_Time => 1.5, Best_Case_Execution_Time => 0.00,
   Shared_Resources_List => (R1));
Operation (Type => Simple, Name => rest, Worst_Case_Execution_Time => 3.0, Avg_Case_Execution_Time => 1.000E+100);
Operation (Type => Composite, Name => both, Composite_Operation_List => (lock, rest));
Transaction (
   Type            => Regular,
   Name            => a,
   External_Events => ((Type => Periodic, Name => e1, Period => 10.000, Max_Jitter => 0.5, Phase => 0.000)),
   Internal_Events => ((Type => Regular, Name => o1, Timing_Requirements =>
      (Type => Hard_Global_Deadline, Deadline => 8.0, Referenced_Event => e1))),
   Event_Handlers  => ((Type => System_Timed_Activity, Input_Event => e1, Output_Event => o1,
      Activity_Operation => lock, Activity_Server => sa)));
Transaction (
   Type            => Regular,
   Name            => b,
   External_Events => ((Type => Sporadic, Name => e2, Min_Interarrival => 20.000)),
   Internal_Events => ((Type => Regular, Name => o2)),
   Event_Handlers  => ((Type => Activity, Input_Event => e2, Output_Event => o2,
      Activity_Operation => both, Activity_Server => sb)));
"""


def test_mast_text_is_read(schedule: Schedule) -> None:
    found = schedule(MAST, "--format", "json", name="model.txt")
    assert (found.code, found.err) == (0, "")
    a, b = found.json["tasks"]
    assert (a["name"], a["wcrt"], a["deadline"], a["blocking"], a["jitter"]) == ("a", 3.5, 8, 1.5, 0.5)
    assert a["blocked_by"] == {"task": "b", "resource": "R1", "length": 1.5}
    assert (b["name"], b["wcrt"], b["deadline"], b["cost"]) == ("b", 6, 20, 4.5)


@pytest.mark.parametrize(
    ("old", "new", "code", "words"),
    [
        ("Fixed_Priority_Policy, The_Priority => 2", "Polling_Policy, The_Priority => 2", "MV627", "Polling_Policy"),
        ("Type => Fixed_Priority,", "Type => EDF,", "MV627", "policy `Fixed_Priority`"),
        ("Type => Primary_Scheduler", "Type => Secondary_Scheduler", "MV627", "Secondary_Scheduler"),
        ("Immediate_Ceiling_Resource", "Priority_Inheritance_Resource", "MV627", "Priority_Inheritance"),
        ("Ceiling => 32767, Preassigned => NO", "Ceiling => 9, Preassigned => YES", "MV627", "preassigned ceiling"),
        ("Type => Sporadic", "Type => Bursty", "MV627", "Bursty"),
        ("Hard_Global_Deadline", "Soft_Global_Deadline", "MV627", "Soft_Global_Deadline"),
        ("Regular_Processor", "Packet_Based_Network", "MV627", "Packet_Based_Network"),
        ("Shared_Resources_List", "Shared_Resources_To_Lock", "MV627", "stays locked"),
        ("Type => Composite", "Type => Message_Transmission", "MV627", "Message_Transmission"),
        ("Activity_Operation => both", "Activity_Operation => none", "MV622", "no operation `none`"),
        ("Activity_Server => sb", "Activity_Server => none", "MV622", "no scheduling server `none`"),
        ("(lock, rest)", "(lock, both)", "MV622", "contains itself"),
        ("Host => cpu", "Host => none", "MV622", "no processing resource `none`"),
        ("Shared_Resources_List => (R1)", "Shared_Resources_List => (R2)", "MV622", "no shared resource `R2`"),
        ("Min_Interarrival => 20.000", "Min_Interarrival => 0.0", "MV623", "above 0"),
        ("Period => 10.000", "Period => -10.0", "MV623", "negative"),
        ("Deadline => 8.0", "Deadline => 0", "MV623", "above 0"),
        ("Worst_Case_Execution_Time => 3.0", "Worst_Case_Execution_Time => NaN", "MV623", "not a number"),
        ("Worst_Case_Execution_Time => 3.0,", "", "MV622", "`Worst_Case_Execution_Time => ...` is missing"),
        ("   Name            => b,", "   Name            => a,", "MV624", "two declarations"),
        ("Model (", "Driver (", "MV627", "`Driver` is not carried over"),
        ("((Type => Sporadic", "((Type => Sporadic, Name => e3), (Type => Sporadic", "MV627", "External_Events"),
        ("Name => rest,", "Name => rest", "MV621", "a comma is missing before"),
        ("Activity_Server => sb)));", "Activity_Server => sb))", "MV621", "never closed"),
        ("Transaction (", "= (", "MV621", "begins no MAST declaration"),
        ("Speed_Factor => 1.00);", "Speed_Factor => 0.0);", "MV623", "above 0"),
    ],
)  # fmt: skip
def test_what_mast_says_and_a_set_cannot_is_told_at_its_place(
    schedule: Schedule, old: str, new: str, code: str, words: str
) -> None:
    assert old in MAST
    found = schedule(MAST.replace(old, new), "--format", "json", name="model.mast")
    line = next((line for line in found.err.splitlines() if f"[{code}]" in line), found.err)
    assert found.code == 1 and words in line and line.startswith("model.mast:")
    assert all(part.isdigit() for part in line.split(":")[1:3])


def test_a_phase_is_left_out_with_a_warning(schedule: Schedule) -> None:
    found = schedule(MAST.replace("Phase => 0.000", "Phase => 2.5"), name="model.txt")
    assert found.code == 0 and "warning[MV627" in found.err


def test_a_faster_processor_and_its_context_switch(schedule: Schedule) -> None:
    text = MAST.replace("Speed_Factor => 1.00", "Speed_Factor => 2.0").replace("Switch => 0.00", "Switch => 0.1")
    a = schedule(text, "--format", "json", name="model.txt").json["tasks"][0]
    assert (a["cost"], a["blocking"], a["wcrt"]) == (0.95, 0.75, 0.5 + 0.95 + 0.75)


CHEDDAR = """\
<?xml version="1.0" encoding="utf-8"?>
<cheddar>
 <core_units>
  <core_unit id="id_1">
   <name>c1</name>
   <scheduling><scheduling_parameters>
     <scheduler_type>POSIX_1003_HIGHEST_PRIORITY_FIRST_PROTOCOL</scheduler_type>
     <preemptive_type>PREEMPTIVE</preemptive_type>
   </scheduling_parameters></scheduling>
   <speed>1</speed>
  </core_unit>
 </core_units>
 <processors>
  <mono_core_processor id="id_2"><name>cpu1</name><core ref="id_1"></core></mono_core_processor>
 </processors>
 <tasks>
  <periodic_task id="id_4">
   <name>T1</name><cpu_name>cpu1</cpu_name><capacity>7</capacity><deadline>29</deadline><start_time>0</start_time>
   <priority>1</priority><blocking_time>0</blocking_time><context_switch_overhead>0</context_switch_overhead>
   <period>29</period><jitter>0</jitter><every>0</every>
  </periodic_task>
  <periodic_task id="id_5">
   <name>T2</name><cpu_name>cpu1</cpu_name><capacity>1</capacity><deadline>5</deadline>
   <priority>3</priority><period>5</period><jitter>0</jitter>
  </periodic_task>
  <periodic_task id="id_6">
   <name>T3</name><cpu_name>cpu1</cpu_name><capacity>2</capacity><deadline>10</deadline>
   <priority>2</priority><period>10</period><jitter>0</jitter>
  </periodic_task>
 </tasks>
</cheddar>
"""

RESOURCE = """ <resources>
  <ipcp_resource id="id_7">
   <name>R1</name><protocol>IMMEDIATE_PRIORITY_CEILING_PROTOCOL</protocol>
   <critical_sections>
    <task_name>T1</task_name><critical_section><task_begin>2</task_begin><task_end>3</task_end></critical_section>
    <task_name>T2</task_name><critical_section><task_begin>1</task_begin><task_end>1</task_end></critical_section>
   </critical_sections>
  </ipcp_resource>
 </resources>
</cheddar>
"""


def test_cheddar_xml_is_read(schedule: Schedule) -> None:
    found = schedule(CHEDDAR, "--format", "json", name="model.xmlv3")
    assert (found.code, found.err) == (0, "")
    assert {task["name"]: task["wcrt"] for task in found.json["tasks"]} == {"T1": 14, "T2": 1, "T3": 3}
    upper = CHEDDAR.replace("cheddar>", "Cheddar>").replace("periodic_task", "Periodic_Task")
    assert schedule(upper, "--format", "json", name="model.xml").json["tasks"] == found.json["tasks"]
    with_resource = schedule(CHEDDAR.replace("</cheddar>\n", RESOURCE), "--format", "json", name="model.xml").json
    assert {task["name"]: task["blocking"] for task in with_resource["tasks"]} == {"T1": 0, "T2": 2, "T3": 2}


def test_cheddar_schedulers_decide_priorities_and_preemption(schedule: Schedule) -> None:
    swapped = CHEDDAR.replace("<priority>1<", "<priority>9<")
    for protocol in ("RATE_MONOTONIC_PROTOCOL", "DEADLINE_MONOTONIC_PROTOCOL"):
        text = swapped.replace("POSIX_1003_HIGHEST_PRIORITY_FIRST_PROTOCOL", protocol)
        tasks = schedule(text, "--format", "json", name="model.xml").json["tasks"]
        assert {task["name"]: task["wcrt"] for task in tasks} == {"T1": 14, "T2": 1, "T3": 3}
    whole = schedule(CHEDDAR.replace(">PREEMPTIVE<", ">NOT_PREEMPTIVE<"), "--format", "json", name="model.xml").json
    assert whole["scheduler"] == "non-preemptive"
    assert {task["name"]: task["blocking"] for task in whole["tasks"]} == {"T1": 0, "T2": 7, "T3": 7}


def test_each_processor_of_a_cheddar_model_has_a_set(schedule: Schedule) -> None:
    core = CHEDDAR[CHEDDAR.index("  <core_unit ") : CHEDDAR.index(" </core_units>")].replace("id_1", "id_9")
    cpu = '<mono_core_processor id="id_8"><name>cpu2</name><core ref="id_9"/></mono_core_processor>\n </processors>'
    text = CHEDDAR.replace(" </core_units>", core + " </core_units>").replace(" </processors>", cpu)
    text = text.replace("<name>T3</name><cpu_name>cpu1", "<name>T3</name><cpu_name>cpu2")
    answers = schedule(text, "--format", "json", name="model.xml").json
    assert [(one["name"], [task["wcrt"] for task in one["tasks"]]) for one in answers] == [
        ("cpu1", [9, 1]),
        ("cpu2", [2]),
    ]


@pytest.mark.parametrize(
    ("old", "new", "code", "words"),
    [
        ("POSIX_1003_HIGHEST_PRIORITY_FIRST_PROTOCOL", "EARLIEST_DEADLINE_FIRST", "MV627", "earliest_deadline"),
        ("mono_core_processor", "multi_cores_processor", "MV627", "several cores"),
        ("periodic_task", "aperiodic_task", "MV627", "aperiodic_task"),
        ("<every>0<", "<every>2<", "MV627", "`every`"),
        ("<period>5<", "<period>0<", "MV623", "no `period` above 0"),
        ("<capacity>7<", "<capacity>-7<", "MV623", "negative"),
        ("<capacity>7<", "<capacity>x<", "MV623", "`x` is no number"),
        ("<capacity>7</capacity>", "", "MV622", "has no capacity"),
        ("<cpu_name>cpu1</cpu_name><capacity>7", "<cpu_name>none</cpu_name><capacity>7", "MV622", "`none` that is not"),
        ("<name>T2</name>", "<name>T1</name>", "MV624", "`T1`"),
        ('ref="id_1"', 'ref="id_3"', "MV622", "no core unit"),
        ("</tasks>", "</tasks><messages><m/></messages>", "MV627", "`messages` are not carried over"),
        ("</tasks>", "", "MV621", "this is not XML"),
        ("<cheddar>", "<!DOCTYPE a [<!ENTITY b 'c'>]><cheddar>", "MV621", "no entities"),
        ("cheddar>", "model>", "MV621", "no Cheddar model"),
    ],
)  # fmt: skip
def test_what_cheddar_says_and_a_set_cannot_is_told_at_its_place(
    schedule: Schedule, old: str, new: str, code: str, words: str
) -> None:
    assert old in CHEDDAR
    found = schedule(CHEDDAR.replace(old, new), "--format", "json", name="model.xml")
    line = next((line for line in found.err.splitlines() if f"[{code}]" in line), found.err)
    assert found.code == 1 and words in line and line.startswith("model.xml:")
    assert all(part.isdigit() for part in line.split(":")[1:3])


def test_other_protocols_and_ceilings_by_hand_are_not_carried_over(schedule: Schedule) -> None:
    text = CHEDDAR.replace("</cheddar>\n", RESOURCE)
    inherited = text.replace("IMMEDIATE_PRIORITY_CEILING_PROTOCOL", "PRIORITY_INHERITANCE_PROTOCOL")
    by_hand = text.replace("</ipcp", "<priority_assignment>MANUAL_ASSIGNMENT</priority_assignment></ipcp")
    for one in (inherited, by_hand):
        assert "[MV627]" in schedule(one, "--format", "json", name="model.xml").err


def test_the_priority_ceiling_protocol_blocks_as_the_immediate_one(schedule: Schedule) -> None:
    text = CHEDDAR.replace("</cheddar>\n", RESOURCE)
    lazy = text.replace("IMMEDIATE_PRIORITY_CEILING_PROTOCOL", "PRIORITY_CEILING_PROTOCOL")
    known, found = (schedule(one, "--format", "json", name="model.xml") for one in (text, lazy))
    assert found.code == known.code == 0 and found.json["tasks"] == known.json["tasks"]
    assert any(task["blocking"] for task in found.json["tasks"])
    switched = lazy.replace("<context_switch_overhead>0<", "<context_switch_overhead>1<")
    assert switched != lazy and "switches more often" in schedule(switched, name="model.xml").err


def test_a_resource_without_a_protocol_bounds_nothing_where_tasks_share_it(schedule: Schedule) -> None:
    text = CHEDDAR.replace("</cheddar>\n", RESOURCE).replace("IMMEDIATE_PRIORITY_CEILING_PROTOCOL", "NO_PROTOCOL")
    found = schedule(text, "--format", "json", name="model.xml")
    assert found.code == 1 and "[MV627]" in found.err and "without a protocol" in found.err


def test_csv_is_read_with_columns_in_any_order(schedule: Schedule) -> None:
    text = "# a comment\nC,name,prio,T,J\n2, a ,3,10,\n\n4.5,\"b, too\",2,20,1\n"
    found = schedule(text, "--format", "json", name="tasks.csv")
    assert found.code == 0
    assert [(task["name"], task["wcrt"], task["jitter"]) for task in found.json["tasks"]] == [
        ("a", 2, 0),
        ("b, too", 7.5, 1),
    ]


names = st.sampled_from(["a", "b", "c", "d"])


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.data())
def test_what_is_written_as_mast_reads_back_the_same(schedule: Schedule, data: st.DataObject) -> None:
    tasks: list[dict[str, Any]] = []
    for name in data.draw(st.lists(names, min_size=1, max_size=4, unique=True)):
        cost = data.draw(st.integers(1, 60))
        sections = data.draw(st.lists(st.tuples(st.sampled_from(["R1", "R2"]), st.integers(1, 9)), max_size=2))
        total = sum(length for _, length in sections)
        task = {"name": name, "T": data.draw(st.integers(40, 400)) / 4, "C": (cost + total) / 10}
        task |= {"prio": data.draw(st.integers(-3, 40_000)), "J": data.draw(st.integers(0, 3))}
        task |= {"D": data.draw(st.integers(1, 300)), "cs": [[name, length / 10] for name, length in sections]}
        tasks.append(task)
    document: dict[str, Any] = {"schema": "mauve.taskset/1", "tasks": tasks, "context_switch": 0.25}
    document["scheduler"] = data.draw(st.sampled_from(["preemptive", "non-preemptive"]))
    before = schedule(document, "--format", "json").json
    assert schedule(document, "--export", "mast", "-o", "out.mast").code == 0
    after = schedule(Path("out.mast").read_text(), "--format", "json", name="again.mast").json
    fields = ("name", "wcrt", "deadline", "blocking", "jitter", "period", "cost")
    assert [[task[key] for key in fields] for task in before["tasks"]] == [
        [task[key] for key in fields] for task in after["tasks"]
    ]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"frames": [1, 2], "C": None}, "varying costs"),
        ({"B": 2}, "blocking given for `a`"),
        ({"np": 1}, "nothing preempts"),
        ({"name": "a b"}, "no name in MAST"),
        ({"cs": [["R", 2], ["S", 2]]}, "longer than its cost together"),
    ],
)
def test_what_mast_cannot_say_is_told(schedule: Schedule, change: dict[str, Any], words: str) -> None:
    document = {"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 10, "C": 2, **change}]}
    found = schedule(document, "--export", "mast")
    assert (found.code, found.out) == (1, "") and words in found.err and "[MV627]" in found.err


def test_lists_are_not_exported_and_a_place_that_cannot_be_written_is_told(schedule: Schedule) -> None:
    document = {"schema": "mauve.taskset/1", "tasks": [{"name": "a", "T": 10, "C": 2}]}
    assert "a list of them" in schedule([document, document], "--export", "mast").err
    assert "cannot write" in schedule(document, "--export", "mast", "-o", "none/out.mast").err
    assert schedule(document, "--export", "mast").out.startswith("Processing_Resource (")
    assert schedule([document, json.loads("{}")], "--export", "mast").code == 1
