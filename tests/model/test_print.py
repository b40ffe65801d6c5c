"""`--emit model`, and the systems of the papers."""

from __future__ import annotations

import time
from pathlib import Path

import pytest
from written import MODELS, model_of

from mauve.diagnostics.diagnostic import Report
from mauve.model.print import format_model
from mauve.pipeline import Options, check, read_model

TEXT = """
enum Mode { IDLE, ACTIVE }
passive component Link {
  operation send(value: f64): bool = send_frame runs in caller
  var count: u32
  codel send_frame reads value, count writes count returns bool wcet 3us symbol "link_send"
}
component Pilot {
  event port goal: f64
  out port thrust: f64
  property mode: Mode = IDLE
  var sent: bool
  event Done
  method send(value: f64): bool
  codel steer reads goal, mode writes thrust wcet 1ms
  codel near reads goal returns bool
  init codel open
  behaviour {
    region main {
      initial state Driving {
        entry steer
        run steer then sent = send(goal) every 10ms
        -> Stopped on Done when near and not near after 1s do steer emit Done
      }
      final state Stopped {
        run steer once, at least 20ms apart
        region inner {
          initial state In {
          }
        }
      }
    }
  }
}
external component Base {
  out port goal: f64
  in port thrust: f64
}
architecture Robot {
  instance base: Base { sporadic 20ms }
  instance p: Pilot { sporadic 20ms  jitter 1ms }
  instance link: Link
  connect base.goal -> p.goal buffered size 4 drop oldest initial 0.0
  connect p.thrust -> base.thrust
  connect p.send -> link.send
}
board desk {
  cpu "arm926ej-s" at 200MHz
  icache 16KiB 4-way line 32B
  memory ram at 0x0 size 1MiB wait 2cycles write wait 30ns
  os bare {
    context_switch 1us
    tick every 1ms cost 2us
  }
}
deployment main of Robot {
  expect unschedulable
  node n on desk {
    binary "a.elf" {
      Pilot.near = "pilot_near"
      loop "pilot.c:3" max 4
      facts "a.ff"
    }
    assume others wcet 1ms
    interrupt uart every 87us symbol "uart_isr"
    process p {
      exchange ports 5us
      thread control { p }
    }
  }
}
"""

GOLDEN = """\
passive component Link
  var count: u32
  operation send(value: f64): bool = send_frame runs in caller
  codel send_frame reads value, count writes count returns bool wcet 3us symbol "link_send"
active component Pilot
  event port goal: f64
  out port thrust: f64
  property mode: Mode
  var sent: bool
  event Done
  method send(value: f64): bool
  codel steer reads goal, mode writes thrust wcet 1ms
  codel near reads goal returns bool
  init codel open
  region main initial Driving
    state Driving
      entry steer
      run steer then sent = send(goal) every 10ms
      -> Stopped on Done when near, near after 1s do steer emit Done
    final state Stopped
      run steer once at least 20ms apart
      region inner initial In
        state In
external component Base
  out port goal: f64
  in port thrust: f64
architecture Robot
  instance base: Base sporadic 20ms
  instance p: Pilot sporadic 20ms deadline 10ms (default: the period) priority 1 (default: rate monotonic) jitter 1ms
  instance link: Link
  connect base.goal -> p.goal buffered size 4 drop oldest
  connect p.thrust -> base.thrust
  connect p.send -> link.send
board desk cpu "arm926ej-s" at 200000000Hz
  memory ram at 0x00000000 size 0x100000 wait 2cycles write wait 30ns
  icache 16KiB 4-way line 32B
  context_switch 1us
  tick every 1ms cost 2us
deployment main of Robot expect unschedulable
  node n on desk
    binary "a.elf"
      Pilot.near = "pilot_near"
      loop "pilot.c:3" max 4
      facts "a.ff"
    assume others wcet 1ms
    interrupt uart every 87us symbol "uart_isr"
    thread control { p }
    exchange ports 5us"""


def test_the_model_as_text() -> None:
    text = format_model(model_of(TEXT))
    start = text.index("passive component Link")
    assert text[start:] == GOLDEN


@pytest.mark.parametrize("name", ["ttrk", "auv"])
def test_the_systems_of_the_papers_resolve(name: str) -> None:
    report = Report()
    _, model = read_model(str(MODELS / f"{name}.mauve"), report)
    assert model is not None and not report.has_errors
    assert all(str(instance.name) in format_model(model) for instance in model.architectures[0].instances)


def test_the_first_deployment_of_the_underwater_vehicle_misses_and_the_others_hold() -> None:
    """Table III of the C-Forge paper: one thread per component is not schedulable, one per period is."""
    report = Report()
    result = check(str(MODELS / "auv.mauve"), Options(cache=False), report)
    assert {d.deployment.name: d.holds for d in result.deployments} == {
        "per_component": False, "split_spooler": True, "by_period": True,
    }  # fmt: skip
    assert {d.code for d in report} == {"MV420", "MV411", "MV601"}


def test_the_tracked_robot_holds_on_the_bench() -> None:
    report = Report()
    result = check(str(MODELS / "ttrk.mauve"), Options(cache=False), report)
    assert result.passes(report) and [d.code for d in report] == []


@pytest.mark.slow
def test_five_thousand_instances_resolve_in_the_budget(tmp_path: Path) -> None:
    lines = [
        "mauve 1",
        "component C {",
        "in port i: f64",
        "out port o: f64",
        "codel go reads i writes o",
        "behaviour {",
    ]
    lines += ["initial state On {", "run go", "}", "}", "}", "architecture R {"]
    lines += [f"instance i{n}: C {{ period {n % 50 + 1}ms }}" for n in range(5000)]
    lines += [f"connect i{n}.o -> i{(n + 1) % 5000}.i" for n in range(5000)]
    path = tmp_path / "many.mauve"
    path.write_text("\n".join([*lines, "}"]) + "\n")
    start = time.process_time()
    _, model = read_model(str(path), Report())
    assert model is not None and len(model.architectures[0].data) == 5000
    assert time.process_time() - start < 10, "the budget of 5 s, on a machine at half the speed"
