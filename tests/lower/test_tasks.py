"""Deployment -> task sets: threads, blocking, sharing, events, interrupts."""

from __future__ import annotations

import pytest
from written import BOARD, codes, model_of, tasks_of, times

from mauve.diagnostics.diagnostic import Report
from mauve.lower.activation import settle
from mauve.lower.codels import Source, choose_times, plan_codels
from mauve.lower.placed import PlacedTask
from mauve.lower.platform import flow_facts, timing_platform, wcet_board
from mauve.model.model import CodelId
from mauve.records import changed
from mauve.timing.response import Method, Reason
from mauve.timing.task import Kind, Platform
from mauve.units import MS, US
from mauve.wcet.flow.facts import AtAddress, AtLine, AtSymbol, Counting, LoopFact
from mauve.wcet.result import WcetResult

PARTS = f"""
passive component Log {{
  var total: f64
  operation note(value: f64) = append
  codel append reads value, total writes total wcet 300us
}}
component Worker {{
  in port got: f64
  out port made: f64
  var shared: f64
  method note(value: f64)
  operation peek(value: f64) = look
  codel look reads shared wcet 50us
  codel make writes shared, made wcet 1ms
  codel use reads shared, got wcet 2ms
  behaviour {{
    region making {{
      initial state On {{
        run make then note(shared) every 10ms
      }}
    }}
    region using {{
      initial state On {{
        run use every 15ms
      }}
    }}
  }}
}}
component Simple {{
  in port got: f64
  out port made: f64
  method note(value: f64)
  codel make reads got writes made wcet 1ms
  behaviour {{
    initial state On {{
      run make then note(got)
    }}
  }}
}}
{BOARD}
"""


def _text(architecture: str, node: str = "") -> str:
    return PARTS + f"architecture R {{\n{architecture}\n}}\ndeployment d of R {{\nnode n on desk {{\n{node}\n}}\n}}\n"


def _tasks(architecture: str, node: str = "", report: Report | None = None) -> dict[str, PlacedTask]:
    (found,) = tasks_of(model_of(_text(architecture, node)), report)
    return {placed.task.name: placed for placed in found.tasks}


THREE = """instance low: Simple { period 30ms  priority 1 }
instance mid: Simple { period 20ms  priority 2 }
instance high: Simple { period 10ms  priority 3 }
instance log: Log
connect low.note -> log.note
connect mid.note -> log.note
connect high.note -> log.note
external low.got, mid.got, high.got"""


def _blocking(placed: PlacedTask) -> int:
    return placed.blocker.length if placed.blocker else 0


def test_a_section_of_a_less_urgent_task_blocks_once() -> None:
    found = _tasks(THREE)
    assert {name: _blocking(placed) for name, placed in found.items()} == {
        "low": 0,
        "mid": 300 * US,
        "high": 300 * US,
    }
    blocker = found["high"].blocker
    assert blocker is not None and (blocker.holder, blocker.what) == ("low", "`Log.append` of `log`")


def test_a_task_between_the_users_of_a_provider_is_blocked_too() -> None:
    found = _tasks(THREE.replace("connect mid.note -> log.note", "instance other: Log\nconnect mid.note -> other.note"))
    assert _blocking(found["mid"]) == 300 * US, "the ceiling of `log` is that of `high`"


def test_an_exchange_of_ports_costs_each_activation_and_blocks_who_shares_the_port() -> None:
    arch = """instance low: Simple { period 30ms  priority 1 }
instance mid: Log
instance high: Simple { period 10ms  priority 3 }
connect low.made -> high.got
connect low.note -> mid.note
connect high.note -> mid.note
external low.got"""
    found = _tasks(arch, "process p {\nexchange ports 400us\nexchange high.ports 100us\n}")
    assert found["low"].task.demand(1) == 1300 * US + 400 * US
    assert found["high"].task.demand(1) == 1300 * US + 100 * US
    assert _blocking(found["high"]) == 400 * US
    assert found["high"].blocker is not None and found["high"].blocker.what == "the exchange of `low.made`"


WORKER = """instance w: Worker { priority 1 }
instance log: Log
connect w.note -> log.note
external w.got"""


def test_an_instance_of_two_periods_is_one_task_of_their_gcd() -> None:
    (placed,) = _tasks(WORKER).values()
    assert (placed.task.period, placed.task.deadline) == (5 * MS, 5 * MS)
    assert [part.period for part in placed.task.work] == [10 * MS, 15 * MS]
    assert placed.task.demand(1) == 3300 * US
    assert placed.task.demand(2) == 3300 * US + 0, "neither region is due again within two jobs of 5ms"


def test_a_thread_of_two_periods_is_reported_with_its_cost() -> None:
    report = Report()
    (placed,) = _tasks(WORKER, "process p {\nthread t { w }\n}", report).values()
    assert placed.task.period == 5 * MS
    (warning,) = [d for d in report if d.code == "MV411"]
    assert warning.notes == ("5ms = gcd(10ms, 15ms); a job costs up to 3.3ms, 66 % of that",)


def test_a_written_period_must_divide_and_is_not_reported() -> None:
    report = Report()
    (placed,) = _tasks(WORKER, "process p {\nthread t period 1ms deadline 5ms priority 3 { w }\n}", report).values()
    assert (placed.task.period, placed.task.deadline, placed.task.priority) == (1 * MS, 5 * MS, 3)
    assert codes(report) == []
    report = Report()
    assert _tasks(WORKER, "process p {\nthread t period 4ms { w }\n}", report) == {}
    assert codes(report) == ["MV401"]


def test_threads_keep_the_jitter_and_the_deadlines_of_their_instances() -> None:
    arch = WORKER.replace("priority 1", "priority 1  deadline 4ms  jitter 2ms")
    (placed,) = _tasks(arch, "process p {\nthread t { w }\n}").values()
    assert (placed.task.deadline, placed.task.jitter) == (4 * MS, 2 * MS)


SPLIT = "process p {\n%s\nthread one { w.making }\nthread two { w.using }\n}"


def test_regions_in_two_threads_that_share_a_variable_race() -> None:
    report = Report()
    _tasks(WORKER, SPLIT % "", report)
    assert codes(report) == ["MV214"]


def test_a_lock_turns_the_race_into_blocking() -> None:
    report = Report()
    found = _tasks(WORKER, SPLIT % "lock immediate_ceiling", report)
    assert codes(report) == []
    assert _blocking(found["one"]) == 2 * MS and _blocking(found["two"]) == 0
    assert found["one"].blocker is not None and found["one"].blocker.what == "`Worker.use`, which uses `w.shared`"


def test_the_ports_of_an_instance_in_two_threads_are_exchanged_by_both_unless_one_is_named() -> None:
    exchange = "lock immediate_ceiling\nexchange ports 100us"
    found = _tasks(WORKER, SPLIT % exchange)
    assert [found[name].task.demand(1) for name in ("one", "two")] == [1400 * US, 2100 * US]
    found = _tasks(WORKER, (SPLIT % exchange).replace("{ w.making }", "{ w.making  w.ports }"))
    assert [found[name].task.demand(1) for name in ("one", "two")] == [1400 * US, 2000 * US]


def test_an_operation_that_touches_what_its_active_owner_uses_is_a_race() -> None:
    arch = """instance w: Worker { priority 1 }
instance s: Simple { period 10ms  priority 2 }
instance log: Log
connect w.note -> log.note
connect s.note -> w.peek
external w.got, s.got"""
    report = Report()
    _tasks(arch, "", report)
    (race,) = [d for d in report if d.code == "MV214"]
    assert "`w.shared`" in race.message and race.help is not None and "passive" in race.help.text


def test_one_task_alone_does_not_race() -> None:
    report = Report()
    _tasks(WORKER, "", report)
    assert codes(report) == []


CHAIN = f"""
component Source {{
  out port value: f64
  codel make writes value wcet %s
  behaviour {{
    initial state On {{
      run make
    }}
  }}
}}
component Woken {{
  event port value: f64
  out port result: f64
  codel use reads value writes result wcet 1ms
  behaviour {{
    initial state On {{
      run use
    }}
  }}
}}
external component Sensor {{
  out port value: f64
}}
{BOARD}
architecture R {{
%s
}}
deployment d of R {{
  node n on desk {{
  }}
}}
"""


def _settled(instances: str, wcet: str = "2ms") -> dict[str, tuple[int, int | None, Reason | None]]:
    model = model_of(CHAIN % (wcet, instances))
    nodes = tasks_of(model)
    settled = settle(model.deployments[0], nodes, [Platform()], Method.TRACE)
    (node,), (analysis,) = settled.nodes, settled.results
    assert analysis is not None
    return {p.task.name: (p.task.jitter, (r := analysis.result(p.task.name)).wcrt, r.reason) for p in node.tasks}


def test_a_woken_task_has_the_response_of_its_writer_as_jitter() -> None:
    found = _settled("""instance a: Source { period 10ms  priority 3 }
instance b: Woken { sporadic 10ms  priority 2  deadline 20ms }
instance c: Woken { sporadic 10ms  priority 1  deadline 40ms }
connect a.value -> b.value
connect b.result -> c.value""")
    assert found["a"] == (0, 2 * MS, None)
    assert found["b"][0] == 2 * MS and found["b"][1] == 2 * MS + 3 * MS
    assert found["c"][0] == 5 * MS and found["c"][1] == 5 * MS + 4 * MS


def test_its_own_jitter_adds_to_that_of_its_arrivals() -> None:
    found = _settled("""instance a: Source { period 10ms  priority 2 }
instance b: Woken { sporadic 10ms  priority 1  deadline 20ms  jitter 1ms }
connect a.value -> b.value""")
    assert found["b"][0] == 3 * MS


def test_a_writer_outside_the_model_has_its_declared_jitter() -> None:
    found = _settled("""instance a: Sensor { period 10ms  jitter 4ms }
instance b: Woken { sporadic 10ms  priority 1  deadline 20ms }
connect a.value -> b.value""")
    assert found["b"][:2] == (4 * MS, 5 * MS)


def test_several_writers_add_their_arrivals() -> None:
    found = _settled("""instance a: Source { period 10ms  priority 3 }
instance s: Sensor { period 20ms  jitter 4ms }
instance b: Woken { sporadic 6ms  priority 1  deadline 100ms }
connect a.value -> b.value buffered size 9
connect s.value -> b.value buffered size 9""")
    # s * sum(R / T + 1) = 6 * (2/10 + 1 + 4/20 + 1)
    assert found["b"][0] == 14_400 * US


def _with_writer_in_two_tasks(separation: str) -> dict[str, tuple[int, int | None, Reason | None]]:
    """The responses where two tasks execute parts of the instance that wakes b, each with a response of its own."""
    model = model_of(CHAIN % ("2ms", f"""instance a: Source {{ period 10ms  priority 3 }}
instance b: Woken {{ sporadic {separation}  priority 1  deadline 200ms }}
connect a.value -> b.value"""))
    (node,) = tasks_of(model)
    writer = next(placed for placed in node.tasks if placed.task.name == "a")
    second = changed(writer, task=changed(writer.task, name="a2", priority=2))
    split = changed(node, tasks=(second, *node.tasks))
    (analysis,) = settle(model.deployments[0], [split], [Platform()], Method.TRACE).results
    assert analysis is not None
    return {r.task: (analysis.task(r.task).jitter, r.wcrt, r.reason) for r in analysis.results}


def test_each_task_of_a_writer_wakes() -> None:
    found = _with_writer_in_two_tasks("5ms")
    assert (found["a"][1], found["a2"][1]) == (2 * MS, 4 * MS)
    # s * sum(R / T + 1) = 5 * (2/10 + 1 + 4/10 + 1)
    assert found["b"][0] == 13 * MS and found["b"][1] is not None


def test_tasks_that_wake_more_often_than_the_separation_leave_no_response() -> None:
    found = _with_writer_in_two_tasks("10ms")
    assert found["b"][1:] == (None, Reason.ARRIVALS)


def test_arrivals_of_a_writer_without_a_bound_leave_no_response() -> None:
    found = _settled("""instance a: Source { period 10ms  priority 3 }
instance b: Woken { sporadic 10ms  priority 2  deadline 20ms }
connect a.value -> b.value""", wcet="11ms")  # fmt: skip
    assert found["a"][2] is Reason.OVERLOAD and found["b"][1] is None


def test_a_woken_task_that_delays_its_writer_more_and_more_has_no_bound() -> None:
    """The load is below 1, but each rise of the writer's response lets more activations of the urgent task arrive; what
    waits for a response that rests on them has none either, however urgent it is."""
    found = _settled("""instance a: Source { period 10ms  priority 1  deadline 100ms }
instance b: Woken { sporadic 1800us  priority 2 }
instance z: Source { period 100ms  priority 0 }
instance c: Woken { sporadic 100ms  priority 9 }
instance top: Source { period 100ms  priority 10 }
connect a.value -> b.value
connect z.value -> c.value""")
    assert {name: found[name][1:] for name in "abcz"} == dict.fromkeys("abcz", (None, Reason.ARRIVALS))
    assert found["top"][1:] == (2 * MS, None)


def test_interrupts_and_the_tick_have_names_that_no_task_has() -> None:
    text = _text(
        "instance tick: Simple { period 10ms }\ninstance log: Log\nconnect tick.note -> log.note\nexternal tick.got"
    )
    text = text.replace("at 200MHz\n", "at 200MHz\nos bare {\ncontext_switch 1us\ntick every 1ms cost 5us\n}\n", 1)
    text = text.replace("node n on desk {", "node n on desk {\ninterrupt uart every 87us wcet 3us")
    model = model_of(text)
    platform = timing_platform(model.deployments[0].nodes[0], {"uart": 3 * US})
    assert [(i.name, i.period, i.cost, i.kind) for i in platform.interrupts] == [
        ("interrupt uart", 87 * US, 5 * US, Kind.INTERRUPT), ("system tick", 1 * MS, 5 * US, Kind.TICK),
    ]  # fmt: skip
    settled = settle(model.deployments[0], tasks_of(model), [platform], Method.TRACE)
    assert settled.results[0] is not None and settled.results[0].schedulable


def _result(name: str, time: int | None) -> WcetResult:
    return WcetResult(name, 0x8000, time, time)


@pytest.mark.parametrize(
    ("derived", "assumed", "declared", "time", "source", "reported"),
    [
        (7, 6, 5, 7, Source.DERIVED, ["MV521"]), (7, None, 5, 7, Source.DERIVED, []),
        (None, 6, 5, 6, Source.ASSUMED, []), (None, None, 5, 5, Source.DECLARED, []),
        (None, None, None, None, None, ["MV520"]),
    ],
)  # fmt: skip
def test_derived_before_assumed_before_declared(
    derived: int | None,
    assumed: int | None,
    declared: int | None,
    time: int | None,
    source: Source | None,
    reported: list[str],
) -> None:
    codel = f"codel make wcet {declared}us" if declared else "codel make"
    assume = f"assume A.make wcet {assumed}us" if assumed else ""
    text = f"component A {{\n{codel}\nbehaviour {{\ninitial state On {{\nrun make\n}}\n}}\n}}\n{BOARD}"
    text += "architecture R {\ninstance a: A { period 1ms }\n}\n"
    text += f'deployment d of R {{\nnode n on desk {{\nbinary "a.elf"\n{assume}\n}}\n}}'
    deployment = model_of(text).deployments[0]
    plans = plan_codels(deployment)
    assert [(str(plan.id), plan.symbol) for plan in plans] == [("A.make", "A_make")]
    binary = deployment.nodes[0].binaries[0]
    found = {CodelId("A", "make"): (_result("A_make", derived * US), binary)} if derived else {}
    report = Report()
    (codel_time,) = choose_times(plans, deployment, found, report)
    assert (codel_time.time, codel_time.source) == (time * US if time else None, source)
    assert codes(report) == reported


def test_others_covers_what_nothing_else_names() -> None:
    model = model_of(
        _text(
            "instance s: Simple { period 10ms }\ninstance log: Log\nconnect s.note -> log.note\nexternal s.got",
            "assume others wcet 9us",
        )
    )
    assert set(times(model.deployments[0]).values()) == {1 * MS, 300 * US}, "declared times go before `others`"


def test_facts_by_line_count_bodies_and_others_headers() -> None:
    written = 'binary "a.elf" {\nloop "a.c:3" max 3\nloop "f"+0x10 max 4\nloop 0x8000 total 5\n}'
    model = model_of(_text("instance log: Log", written))
    found = flow_facts(model.deployments[0].nodes[0].binaries[0].facts)
    loops = [fact for fact in found if isinstance(fact, LoopFact)]
    assert [(fact.place, fact.counting, fact.maximum, fact.total) for fact in loops] == [
        (AtLine("a.c", 3), Counting.BODY, 3, None),
        (AtSymbol("f", 0x10), Counting.HEADER, 4, None),
        (AtAddress(0x8000), Counting.HEADER, None, 5),
    ]


def test_waits_in_time_become_cycles_rounded_up() -> None:
    text = _text("instance log: Log").replace(
        "at 200MHz\n", "at 200MHz\nmemory a at 0x0 size 1KiB wait 11ns write wait 3cycles\n", 1
    )
    board = wcet_board(model_of(text).deployments[0].nodes[0].board)
    assert (board.memories[0].wait, board.memories[0].write_wait) == (3, 3)


def test_a_codel_takes_its_time_from_the_processor_that_executes_it() -> None:
    text = _text("instance a: Simple { period 10ms }\ninstance log: Log\nconnect a.note -> log.note\nexternal a.got")
    start = text.index("deployment d of R")
    node = 'node %s on desk {\nbinary "%s.elf" {\nSimple.make = "%s_make"\n}\n'
    node += "assume Log.append wcet %dus\nprocess p {\n%s\n}\n}\n"
    left, right = node % ("left", "l", "l", 1, ""), node % ("right", "r", "r", 2, "thread t { a }")
    deployment = model_of(text[:start] + f"deployment d of R {{\n{left}{right}}}").deployments[0]
    plans = {str(plan.id): plan for plan in plan_codels(deployment)}
    assert plans["Simple.make"].symbol == "r_make" and plans["Simple.make"].nodes == {"right"}
    assert times(deployment)[CodelId("Log", "append")] == 2 * US
