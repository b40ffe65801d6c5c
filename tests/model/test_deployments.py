"""Deployments: what they inherit, which thread executes which region, what they may not ask for."""

from __future__ import annotations

import pytest
from written import BOARD, codes, model_of, resolved

from mauve.model.model import AssumedRange, CodePlace, ControlFact, LoopFact, RegionId
from mauve.model.threads import placement
from mauve.units import MS, US

ROBOT = f"""
component Worker {{
  codel work
  behaviour {{
    region outer {{
      initial state On {{
        run work every 10ms
        region inner {{
          initial state In {{
            run work
          }}
        }}
      }}
    }}
    region other {{
      initial state On {{
        run work every 20ms
      }}
    }}
  }}
}}
architecture R {{
  instance a: Worker {{ priority 2 }}
  instance b: Worker {{ priority 1 }}
}}
{BOARD}
"""


def _placed(threads: str) -> dict[str, str]:
    model = model_of(ROBOT + f"deployment d of R {{\nnode n on desk {{\nprocess p {{\n{threads}\n}}\n}}\n}}")
    return {str(region): thread.name for region, thread in placement(model.deployments[0]).items()}


def test_a_region_goes_with_what_is_around_it_unless_it_is_placed() -> None:
    assert _placed("thread one { a }\nthread two { b.outer }\nthread three { b.outer.inner  b.other }") == {
        "a.outer": "one", "a.outer.inner": "one", "a.other": "one",
        "b.outer": "two", "b.outer.inner": "three", "b.other": "three",
    }  # fmt: skip


def test_a_part_may_be_taken_out_of_an_instance() -> None:
    assert _placed("thread one { a  b }\nthread two { b.other }")["b.other"] == "two"


@pytest.mark.parametrize(
    ("threads", "expected"),
    [
        ("thread one { a  b }", []),
        ("thread one { a }", ["MV403"]),
        ("thread one { a.outer  b }", ["MV403"]),
        ("thread one { a  b }\nthread two { b }", ["MV402"]),
        ("thread one { a  a  b }", ["MV402"]),
        ("thread one { a  b.nothing }", ["MV100"]),
        ("thread one { a  c }", ["MV106"]),
        ("thread one { a }\nthread one { b }", ["MV103"]),
        ("thread one sporadic 3ms { a  b }", ["MV407"]),
        ("thread one period 0ms { a  b }", ["MV401"]),
        ("lock inheritance\nthread one { a  b }", ["MV407"]),
        ("schedule round_robin\nthread one { a  b }", ["MV407"]),
        ("schedule rate_monotonic non_preemptive\nthread one { a  b }", ["MV407"]),
    ],
)
def test_each_mistake_is_reported_once(threads: str, expected: list[str]) -> None:
    _, report = resolved(ROBOT + f"deployment d of R {{\nnode n on desk {{\nprocess p {{\n{threads}\n}}\n}}\n}}")
    assert codes(report) == expected


INHERITED = (
    ROBOT
    + """
abstract deployment base of R {
  node n on desk {
    assume Worker.work wcet 1ms
    process p {
      exchange ports 2ms
      thread one { a }
      thread two { b }
    }
  }
}
deployment better extends base {
  expect unschedulable
  node n on desk {
    assume Worker.work wcet 2ms
    interrupt uart every 1ms wcet 3us
  }
  process n.p {
    lock immediate_ceiling
    exchange ports 1ms
    thread two { b.outer }
    thread three { b.other }
  }
}
deployment best extends better {
}
"""
)


def test_an_extending_deployment_replaces_threads_and_adds_the_rest() -> None:
    base, better, best = model_of(INHERITED).deployments
    assert base.abstract and not better.abstract
    threads = {thread.name: [str(member) for member, _ in thread.members] for thread in better.nodes[0].threads}
    assert threads == {"one": ["a"], "two": ["b.outer"], "three": ["b.other"]}
    assert [a.wcet for a in better.nodes[0].assumptions] == [2 * MS, 1 * MS], "the nearest first"
    assert [cost for _, cost, _ in better.nodes[0].exchanges] == [2 * MS, 1 * MS], "the nearest last"
    assert all(thread.locked for thread in better.nodes[0].threads)
    assert [i.wcet for i in best.nodes[0].interrupts] == [3 * US]


def test_an_expectation_is_not_inherited() -> None:
    _, better, best = model_of(INHERITED).deployments
    assert better.expect_unschedulable is not None and best.expect_unschedulable is None


def test_region_names_print_as_paths() -> None:
    assert str(RegionId("a", ("outer", "inner"))) == "a.outer.inner" and str(RegionId("a", ())) == "a"


@pytest.mark.parametrize(
    ("items", "expected"),
    [
        ("assume Worker.wrk wcet 1ms", ["MV107"]),
        ("assume Worke.work wcet 1ms", ["MV101"]),
        ("assume Worker wcet 1ms", ["MV107"]),
        ("assume Worker.work wcet -1ms", ["MV401"]),
        ("interrupt uart every 0us wcet 1us", ["MV401"]),
        ("interrupt uart every 1us wcet -1us", ["MV401"]),
        ("interrupt uart every 1us", ["MV520"]),
        ("interrupt uart every 1us wcet 1ns\ninterrupt uart every 2us wcet 1ns", ["MV103"]),
        ('binary "a.elf" {\nWorker.work = "a"\nWorker.work = "b"\n}', ["MV103"]),
        ('binary "a.elf" {\nloop "a.c:" max 3\n}', ["MV516"]),
        ('binary "a.elf" {\nloop "a.c:3" max -3\n}', ["MV516"]),
        ('binary "a.elf" {\nloop "a.c:3" max ?\n}', ["MV516"]),
        ('binary "a.elf" {\nassume "n" from 2 to 1\n}', ["MV516"]),
        ('binary "a.elf" {\nassume "n" from 0.5 to 1\n}', ["MV516"]),
        ('binary "a.elf" {\nassume "n" each 3B any\n}', ["MV516"]),
        ('binary "a.elf" {\nassume "f" argument 0 any\n}', ["MV516"]),
        ('binary "a.elf" {\nassume 0x20 argument 1 any\n}', ["MV516"]),
        ('binary "a.elf" {\nassume "a.c:3" any\n}', ["MV516"]),
    ],
)
def test_items_of_nodes(items: str, expected: list[str]) -> None:
    _, report = resolved(ROBOT + f"deployment d of R {{\nnode n on desk {{\n{items}\n}}\n}}")
    assert codes(report) == expected


def test_paths_are_relative_to_the_model() -> None:
    text = ROBOT + 'deployment d of R {\nnode n on desk {\nbinary "../a.elf" {\nloop "a.c:3" max 3 total 9\n}\n}\n}'
    (binary,) = model_of(text).deployments[0].nodes[0].binaries
    (fact,) = binary.facts
    assert isinstance(fact, LoopFact)
    assert binary.path == "../a.elf" and (fact.place.line, fact.total) == (3, 9)


FACTS = """
binary "a.elf" {
  loop "a.c:9" max 4
  assume "n" from -1 to 0x10
  assume "table"+8 each 2B any
  assume "f" argument 5 from 0 to 3
  assume "parse" argument 1 ends within 80B
  targets "g"+0x14 to "one", 0x8000
  noreturn "panic"
}
binary "other.elf" {
  loop "b.c:1" max 4
}
"""


def test_facts_outside_of_deployments_join_those_of_the_same_binary() -> None:
    text = ROBOT + FACTS + 'deployment d of R {\nnode n on desk {\nbinary "./a.elf" {\nloop "a.c:3" max 3\n}\n}\n}'
    (binary,) = model_of(text.replace("./", "")).deployments[0].nodes[0].binaries
    own, loop, *ranges, targets, never = binary.facts
    assert isinstance(own, LoopFact) and isinstance(loop, LoopFact)
    assert [own.place.line, loop.place.line] == [3, 9]
    assert [(r.place, r.argument, r.width, r.low, r.high, r.ends) for r in ranges if isinstance(r, AssumedRange)] == [
        (CodePlace(None, None, "n", 0), None, None, -1, 16, None),
        (CodePlace(None, None, "table", 8), None, 2, None, None, None),
        (CodePlace(None, None, "f", 0), 5, None, 0, 3, None),
        (CodePlace(None, None, "parse", 0), 1, None, None, None, 80),
    ]
    assert isinstance(targets, ControlFact) and isinstance(never, ControlFact)
    assert targets.targets == (CodePlace(None, None, "one", 0), CodePlace(None, None, None, 0x8000))
    assert (never.place.symbol, never.targets) == ("panic", ())


def test_no_codel_is_bound_outside_of_a_deployment() -> None:
    _, report = resolved(ROBOT + 'binary "a.elf" {\nWorker.work = "w"\n}')
    assert "MV516" in codes(report)


def test_a_board_of_the_standard_library_is_named_by_a_string() -> None:
    model = model_of(ROBOT + 'deployment d of R {\nnode n on "generic-arm7tdmi" {\n}\n}')
    assert model.deployments[0].nodes[0].board.core == "arm7tdmi"
    _, report = resolved(ROBOT + 'deployment d of R {\nnode n on "generic-arm7" {\n}\n}')
    assert codes(report) == ["MV109"]


def test_a_board_of_the_file_may_be_named_by_a_string_too() -> None:
    board = 'board "my board" {\ncpu "cortex-m3" at 72MHz\n}\n'
    model = model_of(ROBOT + board + 'deployment d of R {\nnode n on "my board" {\n}\n}')
    assert model.deployments[0].nodes[0].board.core == "cortex-m3"


def test_who_names_no_board_is_told_the_standard_ones() -> None:
    _, report = resolved(ROBOT + 'deployment d of R {\nnode n on "arm926ej-s" {\n}\n}')
    (diagnostic,) = report
    assert diagnostic.help is not None and '`"generic-arm926ej-s"`' in diagnostic.help.text
