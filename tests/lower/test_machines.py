"""Component -> PSM (seed 001, III.C.2). Costs in microseconds."""

from __future__ import annotations

import pytest
from written import BOARD, MODELS, arcs, machines_of, model_of

from mauve.diagnostics.diagnostic import Report
from mauve.lower.machines import build_machines
from mauve.pipeline import read_model
from mauve.timing.psm import verify
from mauve.units import MS


def _robot(body: str, instances: str = "", members: str = "", deployment: str = "") -> str:
    """One component with codels of 1, 2, 4, .. microseconds, so that each sum tells its parts."""
    codels = "\n".join(f"codel c{1 << n} wcet {1 << n}us" for n in range(6))
    guards = "\n".join(f"codel g{64 << n} returns bool wcet {64 << n}us" for n in range(3))
    return f"""
component C {{
{codels}
{guards}
event E
{members}
behaviour {{
{body}
}}
}}
architecture R {{
instance x: C {{ period 10ms }}
{instances}
}}
{BOARD}
deployment d of R {{
node n on desk {{
{deployment}
}}
}}
"""


def _one(body: str, **rest: str) -> dict[tuple[str, str], int]:
    machines = machines_of(model_of(_robot(body, **rest)))["x"]
    assert machines is not None and all(not verify(machine.psm) for machine in machines)
    return arcs(machines[0])


STATE_A = "initial state A {\nentry c1\nrun c2\nexit c4\n%s\n}\n"
STATE_B = "state B {\nentry c8\nrun c16\n%s\n}"


def test_a_transition_pays_run_guards_exit_do_and_entry() -> None:
    found = _one(STATE_A % "-> B when g64 do c32" + STATE_B % "-> A")
    assert found == {
        ("(start)", "A"): 1,
        ("A", "B"): 2 + 64 + 4 + 32 + 8,
        ("A", "A"): 2 + 64,
        ("B", "A"): 16 + 1,
    }


def test_guards_are_paid_until_one_holds_and_all_of_them_by_the_loop() -> None:
    found = _one(STATE_A % "-> B when g64\n-> C when g128 and not g256" + STATE_B % "-> A" + "\nstate C {\n-> A\n}")
    assert found["A", "B"] == 2 + 64 + 4 + 8
    assert found["A", "C"] == 2 + 64 + 128 + 256 + 4
    assert found["A", "A"] == 2 + 64 + 128 + 256


@pytest.mark.parametrize(
    ("transition", "loops"),
    [
        ("-> B", False),
        ("-> B when g64", True),
        ("-> B on E", True),
        ("-> B after 1s", True),
        ("-> B when g64\n-> B", False),
    ],
)
def test_a_loop_exists_exactly_where_some_outcome_stays(transition: str, loops: bool) -> None:
    assert (("A", "A") in _one(STATE_A % transition + STATE_B % "-> A")) == loops


def test_transitions_between_one_pair_merge_by_maximum() -> None:
    found = _one(STATE_A % "-> B when g64 do c32\n-> B" + STATE_B % "-> A")
    assert found["A", "B"] == 2 + 64 + 4 + 32 + 8


def test_a_transition_to_itself_leaves_and_enters() -> None:
    found = _one(STATE_A % "-> A when g64\n-> B when g128" + STATE_B % "-> A")
    assert found["A", "A"] == max(2 + 64 + 4 + 1, 2 + 64 + 128)


def test_a_once_activity_is_paid_at_entry() -> None:
    found = _one(
        "initial state A {\nrun c1 once\n-> B when g64\n}\nstate B {\nrun c2 once, at least 10ms apart\n-> A\n}"
    )
    assert found == {("(start)", "A"): 1, ("A", "B"): 64 + 2, ("A", "A"): 64, ("B", "A"): 1}


def test_the_lifecycle_of_figure_7() -> None:
    report = Report()
    _, model = read_model(str(MODELS / "ttrk.mauve"), report)
    assert model is not None
    machines = machines_of(model)["ig500"]
    assert machines is not None
    assert arcs(machines[0]) == {
        ("(start)", "PreOp"): 0,
        ("PreOp", "Stopped"): 10, ("PreOp", "PreOp"): 0,
        ("Stopped", "Running"): 0, ("Stopped", "PreOp"): 10, ("Stopped", "Stopped"): 0,
        ("Running", "Stopped"): 500, ("Running", "Running"): 500,
    }  # fmt: skip


def test_an_operation_in_its_caller_costs_the_caller() -> None:
    report = Report()
    _, model = read_model(str(MODELS / "ttrk.mauve"), report)
    assert model is not None
    machines = machines_of(model)["command"]
    assert machines is not None
    found = arcs(machines[0])
    assert found["Rotating", "Rotating"] == 580 + 90 + 10
    assert found["Reaching", "Rotating"] == 580 + 90 + 10 + 10 + 10


NESTED = """
region outer {
initial state Off {
-> On when g64
}
state On {
run c1
region inner {
initial state A {
entry c2
run c4
exit c8
-> B when g128
}
state B {
run c16
-> A
}
}
%s
}
}
region other {
initial state Alone {
run c32
}
}
"""


def test_orthogonal_regions_are_machines_of_their_own_and_a_nested_one_has_an_inactive_state() -> None:
    machines = machines_of(model_of(_robot(NESTED % "-> Off when g64")))["x"]
    assert machines is not None
    assert [str(machine.region) for machine in machines] == ["x.outer", "x.outer.inner", "x.other"]
    assert arcs(machines[2]) == {("(start)", "Alone"): 0, ("Alone", "Alone"): 32}
    inner = arcs(machines[1])
    assert machines[1].psm.initial == "(inactive)"
    assert inner["(inactive)", "(inactive)"] == 0
    assert inner["(inactive)", "A"] == 2
    assert inner["A", "(inactive)"] == 4 + 128 + 8
    assert inner["A", "B"] == 4 + 128 + 8 and inner["A", "A"] == 4 + 128
    assert inner["B", "(inactive)"] == 16 and inner["B", "A"] == 16 + 2


def test_a_parent_that_leads_to_itself_enters_its_regions_again_in_one_activation() -> None:
    machines = machines_of(model_of(_robot(NESTED % "-> On when g64")))["x"]
    assert machines is not None
    inner = arcs(machines[1])
    assert inner["A", "A"] == 4 + 128 + 8 + 2
    assert inner["B", "A"] == 16 + 2


def test_a_nested_region_in_another_thread_may_miss_that_its_parent_was_left() -> None:
    threads = "process p {\nthread one { x }\nthread two { x.outer.inner }\n}"
    machines = machines_of(model_of(_robot(NESTED % "-> Off when g64", deployment=threads)))["x"]
    assert machines is not None
    assert arcs(machines[1])["A", "A"] == 4 + 128 + 8 + 2


def test_a_region_without_a_period_steps_with_what_surrounds_it() -> None:
    body = (NESTED % "-> Off when g64").replace("run c1\n", "run c1 every 20ms\n")
    machines = machines_of(model_of(_robot(body)))["x"]
    assert machines is not None
    assert [machine.period for machine in machines] == [20 * MS, 20 * MS, 10 * MS]


MESSAGES = """in port orders: f64
in port plain: f64
codel handle reads orders wcet 3us
codel look reads plain wcet 5us
codel any wcet 7us"""
SOURCE = """instance s: S { period %s }
connect s.o -> x.orders buffered size %d %s
connect s.o -> x.plain"""


@pytest.mark.parametrize(
    ("period", "size", "policy", "handler", "cost"),
    [
        ("5ms", 3, "", "handle", 3 * 3),
        ("5ms", 9, "", "handle", 3 * 3),
        ("1ms", 4, "drop oldest", "handle", 4 * 3),
        ("5ms", 3, "", "look", 5),
        ("5ms", 3, "", "any", (3 + 1) * 7),
    ],
)
def test_message_handlers_are_paid_once_per_message_that_may_wait(
    period: str, size: int, policy: str, handler: str, cost: int
) -> None:
    body = f"initial state A {{\nmessage {handler}\nrun c1\n}}"
    text = _robot(body, SOURCE % (period, size, policy), MESSAGES) + "external component S {\nout port o: f64\n}"
    machines = machines_of(model_of(text))["x"]
    assert machines is not None
    assert arcs(machines[0])["A", "A"] == cost + 1


def _waiting(body: str, period: str, deployment: str = "", instances: str = "") -> int:
    """The handlers of 3 us in the last loop of a machine."""
    text = _robot(body, SOURCE % (period, 20, "") + instances, MESSAGES, deployment)
    machines = machines_of(model_of(text + "external component S {\nout port o: f64\n}"))["x"]
    assert machines is not None
    return arcs(machines[-1])["A", "A"] // 3


def test_a_slow_region_finds_what_came_since_its_last_step() -> None:
    fast, slow = "run c1", "run c1 every 30ms"
    region = "region r {\ninitial state A {\nmessage handle\n%s\n}\n}\n"
    assert _waiting(region % fast, "5ms") == 3
    assert _waiting("region q {\ninitial state A {\nrun c1\n}\n}\n" + region % slow, "5ms") == 7


def test_the_jitter_and_deadline_of_a_thread_let_more_messages_wait() -> None:
    body = "initial state A {\nmessage handle\nrun c1\n}"
    threads = "process p {\nthread t %s {\nx\n}\n}"
    assert _waiting(body, "5ms", threads % "") == 3
    assert _waiting(body, "5ms", threads % "jitter 20ms") == 7


def test_a_codel_without_a_time_leaves_out_its_component_only() -> None:
    text = _robot(STATE_A % "", "instance y: D { period 10ms }")
    text += "component D {\ncodel unknown\nbehaviour {\ninitial state A {\nrun unknown\n}\n}\n}"
    model = model_of(text)
    built = machines_of(model)
    assert built["y"] is None and built["x"] is not None
    assert build_machines(model.deployments[0], {})["x"] is None
