"""What sensitivity says, tried: a codel as long as it may be holds its deadlines, one a picosecond longer does not."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from mauve.diagnostics.diagnostic import Report
from mauve.pipeline import Options, check
from mauve.timing.priorities import Policy
from mauve.verdict.result import DeploymentResult

PARTS = """mauve 1
board desk {
  cpu "arm926ej-s" at 200MHz
  os small { context_switch 10us }
}
component Server {
  operation compute(x: f64): f64 = solve runs in owner
  codel solve reads x returns f64 wcet 300us
  codel idle wcet 100us
  behaviour { initial state On { method solve  run idle } }
}
component Client {
  method ask(x: f64): f64
  method put(x: f64)
  var goal: f64
  var answer: f64
  codel prepare writes goal wcet 2000us
  codel use reads answer wcet 3000us
  behaviour { initial state On { run prepare then %s then use  -> Rest } state Rest { run use then put(answer) -> On } }
}
passive component Store {
  operation put(x: f64) = keep runs in caller
  codel keep reads x wcet 700us
}
component Slow {
  method put(x: f64)
  var kept: f64
  codel work wcet 5000us
  behaviour { initial state On { run work then put(kept) } }
}
architecture Robot {
  instance server: Server { period 4ms  priority 9 }
  instance client: Client { period 20ms  priority 5 }
  instance slow: Slow { period 30ms  priority 1 }
  instance store: Store
  connect client.put -> store.put
  connect slow.put -> store.put
  connect client.ask -> server.compute
}
deployment bench of Robot { node base on desk { process main { lock immediate_ceiling } } }
"""
WAITING = PARTS % "answer = ask(goal)"
FREE = PARTS % "put(goal)"


PLAIN = Options(cache=False)


def _checked(text: str, folder: Path, options: Options = PLAIN) -> DeploymentResult:
    path = folder / "robot.mauve"
    path.write_text(text, encoding="utf-8")
    report = Report()
    (found,) = check(str(path), options, report).deployments
    return found


@pytest.mark.parametrize("text", [FREE, WAITING], ids=["free", "waiting"])
def test_each_codel_may_take_what_is_said_and_no_more(text: str, tmp_path: Path) -> None:
    found = _checked(text, tmp_path, Options(cache=False, sensitivity=True))
    assert found.holds
    (node,) = found.sensitivity
    assert {one.name for one in node.codels} >= {"Slow.work", "Store.keep", "Client.use", "Server.idle"}
    for one in node.codels:
        name, most = one.name.split(".")[1], one.at_most
        assert most is not None
        for cost, holds in ((most, True), (most + 1, False)):
            longer = re.sub(rf"(codel {name} .*?wcet) \d+us", rf"\g<1> {cost}ps", text)
            assert _checked(longer, tmp_path).holds is holds, (one, cost)


def test_periods_and_frequency_are_withheld_where_tasks_wait(tmp_path: Path) -> None:
    (node,) = _checked(WAITING, tmp_path, Options(cache=False, sensitivity=True)).sensitivity
    assert node.hertz is None and node.periods == () and "" in node.withheld


def test_the_least_period_holds_and_a_shorter_one_does_not(tmp_path: Path) -> None:
    (node,) = _checked(FREE, tmp_path, Options(cache=False, sensitivity=True)).sensitivity
    least = {one.task: one.at_least for one in node.periods}["client"]
    assert least is not None
    for period, holds in ((least, True), (least - 1, False)):
        text = FREE.replace("period 20ms  priority 5", f"period {period}ps  priority 5  deadline 20ms")
        assert _checked(text, tmp_path).holds is holds


@pytest.mark.parametrize("policy", list(Policy))
def test_proposed_priorities_give_the_responses_told(policy: Policy, tmp_path: Path) -> None:
    (proposal,) = _checked(WAITING, tmp_path, Options(cache=False, priorities=policy)).proposals
    assert proposal.priorities is not None
    text = WAITING
    for name, priority in proposal.priorities.items():
        text = re.sub(rf"(instance {name}: .*priority) \d+", rf"\g<1> {priority}", text)
    found = _checked(text, tmp_path)
    analysis = found.nodes[0].analysis
    assert analysis is not None and found.schedulable is proposal.holds
    assert {one.task: one.wcrt for one in analysis.results} == dict(proposal.responses)
