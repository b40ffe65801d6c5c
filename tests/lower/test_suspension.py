"""Waits for operations of other tasks, settled with the responses of those tasks."""

from __future__ import annotations

from endtoend.checked import checked

from mauve.lower.activation import settle
from mauve.lower.platform import timing_platform
from mauve.records import changed
from mauve.timing.response import Method, Reason

TEXT = """mauve 1
board desk {
cpu "arm926ej-s" at 200MHz
}
component Server {
operation ask(x: f64): f64 = solve runs in owner
codel solve reads x returns f64 wcet 1ms
codel idle wcet 500us
behaviour { initial state On { method solve  run idle } }
}
component Client {
method ask(x: f64): f64
var v: f64
codel act writes v wcet 3ms
behaviour { initial state On { run act then v = ask(v) } }
}
architecture Robot {
instance server: Server { period 5ms priority 9 }
instance first: Client { period 40ms priority 5 }
instance second: Client { period 40ms priority 4 }
connect first.ask -> server.ask
connect second.ask -> server.ask
}
deployment bench of Robot {
node base on desk { }
}
"""
MS = 10**9


def test_the_owner_pays_for_all_that_may_wait_and_the_caller_waits_a_period_and_a_response() -> None:
    found, errors = checked(TEXT)
    assert found is not None, errors
    responses = {result.task: result.wcrt for result in found.analysis(Method.TRACE).results}
    assert responses["server"] == 2.5 * MS
    (placed,) = [one for one in found.settled[Method.TRACE].nodes[0].tasks if one.task.name == "first"]
    assert [(wait.operation, wait.time) for wait in placed.waits] == [("server.ask", 7.5 * MS)]
    # 3 of its own, 7.5 of waiting, and the 5 activations of the server in 23
    assert responses["first"] == (3 + 7.5 + 5 * 2.5) * MS


def test_without_the_owner_there_is_no_answer() -> None:
    found, _ = checked(TEXT)
    assert found is not None
    left = changed(found.node, tasks=tuple(one for one in found.node.tasks if one.task.name != "server"))
    (analysis,) = settle(found.deployment, [left], [timing_platform(left.node, {})], Method.TRACE).results
    assert analysis is not None
    assert [(result.wcrt, result.reason) for result in analysis.results] == [(None, Reason.WAITS)] * 2
