"""The controller in C and its Python twin decide as the net does, event by event."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from random import Random
from typing import Any

import pytest

from mauve.mission.cascades import cascade, masks
from mauve.mission.controller import (
    Cascades,
    Controller,
    Rules,
    longest_cascade,
    longest_of_parts,
    net_controller,
    rule_controller,
)
from mauve.mission.controller_c import c_files
from mauve.mission.controller_python import python_twin
from mauve.mission.graph import AlternativesGraph, BudgetExceeded, StateView, view
from mauve.mission.local import local_graphs
from mauve.mission.net import Level, Net, marking
from mauve.mission.plan import Mission
from mauve.mission.stable import alternatives_graph
from mauve.mission.templates import build_net

from .coral import coral
from .random_missions import random_mission

RESET = 255
STRICT = ("-std=c11", "-Wall", "-Wextra", "-Werror", "-pedantic", "-O1")

DRIVER = r"""
#include <stdio.h>
#include "NAME.h"
static unsigned calls;
static void count(void *context, unsigned alternative) { (void)context; calls += alternative + 1; }
int main(void)
{
    NAME_state state, before;
    NAME_reset(&state);
    for (int event; (event = getchar()) != EOF;) {
        before = state;
        if (event == 255) NAME_reset(&state);
        int taken = event == 255 || NAME_step(&state, (unsigned)event);
        NAME_report(&before, &state, count, count, 0);
        unsigned seen[] = {taken, NAME_succeeded(&state), NAME_has_failed(&state), calls % 256};
        for (unsigned i = 0; i < 4; i++) putchar((int)seen[i]);
        for (unsigned i = 0; i != BIG_OBJECTIVES; i++) putchar(NAME_pursued(&state, i));
        for (unsigned i = 0; i != BIG_ALTERNATIVES; i++) putchar(NAME_running(&state, i));
        for (unsigned i = 0; i != BIG_FAILURES; i++) putchar(NAME_failed(&state, i));
        for (unsigned i = 0; i != BIG_RESOURCES; i++) putchar(NAME_out_of_service(&state, i));
    }
    return 0;
}
"""


def host_compiler() -> list[str]:
    for name in ("cc", "gcc", "clang"):
        if shutil.which(name):
            return [name]
    return [sys.executable, "-m", "ziglang", "cc"] if find_spec("ziglang") else []


def graph_of(net: Net) -> AlternativesGraph:
    graph = alternatives_graph(net)
    assert isinstance(graph, AlternativesGraph)
    return graph


def both(mission: Mission) -> list[tuple[Net, Controller]]:
    net = build_net(mission)
    return [(net, rule_controller(graph_of(net))), (net, net_controller(net))]


class Reference:
    """The mission as its net has it. What came of an event in a marking is kept, for long runs."""

    def __init__(self, net: Net) -> None:
        self.net, self.table = net, masks(net)
        self.steps: dict[tuple[int, int], int | None] = {}
        self.views: dict[int, StateView] = {}
        self.state = marking(net.initial)
        self.starts = [
            [at for at, one in enumerate(net.transitions) if one.level is Level.EVENT and one.event == event.name]
            for event in net.events
        ]

    def enabled(self, event: int) -> list[int]:
        return [at for at in self.starts[event] if not self.table.before[at] & ~self.state]

    def reset(self) -> None:
        self.state = marking(self.net.initial)

    def step(self, event: int) -> bool:
        key = (self.state, event)
        if key not in self.steps:
            ways = self.enabled(event) if event < len(self.starts) else []
            self.steps[key] = cascade(self.table, self.state, ways[0]).result if ways else None
        after = self.steps[key]
        self.state = self.state if after is None else after
        return after is not None

    def view(self) -> StateView:
        if self.state not in self.views:
            self.views[self.state] = view(self.net, self.state)
        return self.views[self.state]


def random_events(net: Net, count: int, seed: int) -> list[int]:
    """Events of which most are possible; a mission that has ended starts again, and some are beyond the last."""
    random, reference, events, possible = Random(seed), Reference(net), list[int](), dict[int, list[int]]()
    for _ in range(count):
        event = random.randrange(len(net.events) + 1)
        if random.random() < 0.7:
            if reference.state not in possible:
                possible[reference.state] = [at for at in range(len(net.events)) if reference.enabled(at)]
            event = random.choice(possible[reference.state] or [event])
        if reference.view().outcome and random.random() < 0.5:
            event = RESET
            reference.reset()
        reference.step(event)
        events.append(event)
    return events


def module(controller: Controller) -> dict[str, Any]:
    scope: dict[str, Any] = {}
    exec(compile(python_twin(controller), "twin", "exec"), scope)
    return scope


def packed(controller: Controller, state: int) -> int:
    return sum((state >> place & 1) << bit for bit, place in enumerate(controller.places))


def seen_bytes(controller: Controller, taken: bool, calls: int, shown: StateView) -> bytes:
    flags = [taken, shown.outcome == "success", shown.outcome == "failure", calls % 256]
    flags += [one.names[0] in shown.objectives for one in controller.objectives]
    flags += [one.names in shown.running for one in controller.alternatives]
    flags += [one.names[0] in shown.failed for one in controller.failed]
    flags += [one.names[0] in shown.lost for one in controller.resources]
    return bytes(flags)


def follow(net: Net, controller: Controller, events: list[int]) -> bytes:
    """Runs net and twin side by side; what the program in C must write."""
    twins = module(controller)
    reference, twin, calls, expected = Reference(net), twins["Controller"](), 0, []
    running = [one.names for one in controller.alternatives]
    for event in events:
        before = set(reference.view().running)
        if event == RESET:
            reference.reset()
            twin, taken = twins["Controller"](), True
        else:
            taken = reference.step(event)
            assert twin.step(event) == taken, event
        assert twin.state == packed(controller, reference.state)
        shown = reference.view()
        assert (tuple(twin.pursued()), tuple(twin.running()), twin.outcome()) == (
            shown.objectives, shown.running, shown.outcome,
        )  # fmt: skip
        assert (tuple(twin.failed()), tuple(twin.out_of_service())) == (shown.failed, shown.lost)
        calls += sum(running.index(one) + 1 for one in before ^ set(shown.running))
        expected.append(seen_bytes(controller, taken, calls, shown))
    return b"".join(expected)


def compiled(controller: Controller, folder: Path) -> Callable[[list[int]], bytes]:
    files = c_files(controller)
    (folder / f"{files.stem}.h").write_text(files.header, encoding="utf-8")
    (folder / f"{files.stem}.c").write_text(files.source, encoding="utf-8")
    driver = DRIVER.replace("NAME", files.stem).replace("BIG", files.stem.upper())
    (folder / "driver.c").write_text(driver, encoding="utf-8")
    command = [*host_compiler(), *STRICT, f"{files.stem}.c", "driver.c", "-o", "controller"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return lambda events: (
        subprocess.run([folder / "controller"], input=bytes(events), capture_output=True, check=True).stdout
    )


@pytest.mark.skipif(not host_compiler(), reason="NO C COMPILER: neither cc, gcc, clang nor ziglang")
@pytest.mark.parametrize("form", [0, 1], ids=["rules", "cascades"])
def test_c_twin_and_net_decide_alike(form: int, tmp_path: Path) -> None:
    net, controller = both(coral())[form]
    events = random_events(net, 100_000 if os.environ.get("MAUVE_LONG") else 500, seed=form)
    expected = follow(net, controller, events)
    assert compiled(controller, tmp_path)(events) == expected


def test_twins_of_both_forms_agree_on_a_larger_mission() -> None:
    net, rules = both(coral(sensors=2, shared=True))[0]
    events = random_events(net, 200, seed=5)
    one, other = follow(net, rules, events), follow(net, net_controller(net), events)
    assert one == other


def test_a_state_of_rules_has_only_what_varies() -> None:
    net, rules = both(coral())[0]
    assert rules.bits < len(net.places) / 2
    assert isinstance(rules.reaction, Rules)
    assert sum(map(len, rules.reaction.by_event)) >= 100
    assert 1 <= rules.reaction.most <= 40
    assert f"MOST_RULES = {rules.reaction.most}," in c_files(rules).source


def test_what_is_generated_asks_for_no_memory_and_calls_nothing_unknown() -> None:
    for _, controller in both(coral()):
        source = c_files(controller).source
        assert not any(word in source for word in ("malloc", "free(", "goto", "#include <stdlib"))
        step = source[source.index("bool coral_step") :].split("\n}\n")[0]
        assert "(*" not in step


def test_a_cascade_past_the_limit_is_refused_as_a_whole() -> None:
    net = build_net(coral())
    twin = module(net_controller(net, longest=3))["Controller"]()
    before, start = twin.state, [event.name for event in net.events].index("MISSION_EV_START")
    assert not twin.step(start) and twin.state == before
    assert module(net_controller(net))["Controller"]().step(start)


def test_odd_names_stay_apart() -> None:
    _, controller = both(coral())[0]
    odd = c_files(controller, "9 lives")
    assert "MISSION_9_LIVES_EVENTS" in odd.header and "#include \"9 lives.h\"" in odd.source
    assert "RUN_LOCALISATION_GPS" in python_twin(controller)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("arm-none-eabi-gcc") is None, reason="NO CROSS COMPILER: arm-none-eabi-gcc")
@pytest.mark.parametrize(("form", "cycles"), [(0, 2_000), (1, 20_000_000)], ids=["rules", "cascades"])
def test_the_time_of_a_step_is_bounded_without_flow_facts(form: int, cycles: int, tmp_path: Path) -> None:
    graph = graph_of(build_net(coral()))
    files = c_files(net_controller(graph.net, longest_cascade(graph)) if form else rule_controller(graph))
    (tmp_path / f"{files.stem}.h").write_text(files.header, encoding="utf-8")
    (tmp_path / f"{files.stem}.c").write_text(files.source, encoding="utf-8")
    flags = ["-mcpu=arm926ej-s", *STRICT[:-1], "-O2", "-ffreestanding", "-nostartfiles", "-Wl,-e,coral_step"]
    build = ["arm-none-eabi-gcc", *flags, f"{files.stem}.c", "-lgcc", "-o", "controller.elf"]
    subprocess.run(build, cwd=tmp_path, check=True)
    command = [sys.executable, "-m", "mauve", "wcet", str(tmp_path / "controller.elf"), "coral_step"]
    command += ["--board", "generic-arm926ej-s", "--format", "json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    bound = json.loads(done.stdout)["functions"][0]["wcet_cycles"]
    assert bound is not None and 100 < bound < cycles


def test_twins_of_random_missions_decide_as_their_nets() -> None:
    for seed in range(8):
        net, rules = both(random_mission(seed))[0]
        events = random_events(net, 60, seed)
        assert follow(net, rules, events) == follow(net, net_controller(net), events), seed


@pytest.mark.parametrize("seed", [3, 43, 116])
def test_no_cascade_is_longer_than_its_parts_allow(seed: int) -> None:
    mission = random_mission(seed)
    net = build_net(mission)
    parts = local_graphs(mission)
    assert not isinstance(parts, BudgetExceeded)
    bound = longest_of_parts(net, [one.graph for one in parts])
    assert longest_cascade(graph_of(net)) <= bound
    assert isinstance(reaction := net_controller(net).reaction, Cascades)
    assert longest_cascade(graph_of(net)) <= reaction.longest
