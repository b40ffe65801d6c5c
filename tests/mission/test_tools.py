"""Other tools count as many markings and firings in the exported nets as we do; skipped, and said so, where absent.

They know no priorities, so the nets are those with complements: 1-safe in any order.
"""

from __future__ import annotations

import re
import shutil
import subprocess
from importlib.util import find_spec
from pathlib import Path

import pytest

from mauve.mission.lola import complete, lola
from mauve.mission.net import Net
from mauve.mission.plan import Abort, Elementary, Hardware, Mission, Sequence, Step
from mauve.mission.pnml import pnml
from mauve.mission.templates import build_net, hardware_alone

from .coral import one
from .readers import explore, read_lola

SNAKES = find_spec("snakes") is not None and find_spec("imp") is not None  # it still imports `imp`
CASES = ["one sensor", "one objective"]


def net_of(case: str) -> Net:
    if case == "one sensor":
        return complete(hardware_alone(Hardware("gps")))
    root = Sequence("M", (Step(Elementary("Go", ("drive",)), Abort()),))
    return complete(build_net(Mission("M", root, (one("drive", ("wheel",)),), (), (Hardware("wheel"),))))


def counted(command: list[str], folder: Path) -> tuple[int, int]:
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60, check=False)
    found = re.search(r"(\d+) (?:states|markings)\D+(\d+) (?:transitions|edges)", done.stdout + done.stderr)
    assert found, done.stdout + done.stderr
    return int(found[1]), int(found[2])


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.skipif(not SNAKES, reason="SNAKES IS NOT INSTALLED: its counts are not compared")
def test_snakes_counts_the_same(case: str) -> None:
    import snakes.nets as snakes  # type: ignore[import-not-found,unused-ignore]

    net = net_of(case)
    theirs = snakes.PetriNet("net")
    for at, _ in enumerate(net.places):
        theirs.add_place(snakes.Place(f"p{at}", [snakes.dot] if at in net.initial else []))
    for number, transition in enumerate(net.transitions):
        theirs.add_transition(snakes.Transition(f"t{number}"))
        for place in transition.before:
            theirs.add_input(f"p{place}", f"t{number}", snakes.Value(snakes.dot))
        for place in transition.after:
            theirs.add_output(f"p{place}", f"t{number}", snakes.Value(snakes.dot))
    graph = snakes.StateGraph(theirs)
    graph.build()
    firings = sum(len(list(graph.successors(state))) for state in range(len(graph)))
    assert (len(graph), firings) == explore(read_lola(lola(net)))


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.skipif(shutil.which("lola") is None, reason="LOLA IS NOT INSTALLED: its counts are not compared")
def test_lola_counts_the_same(case: str, tmp_path: Path) -> None:
    text = lola(net_of(case))
    (tmp_path / "net.lola").write_text(text, encoding="utf-8")
    assert counted(["lola", "--check=full", "net.lola"], tmp_path) == explore(read_lola(text))


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
@pytest.mark.skipif(shutil.which("pnml2lts-seq") is None, reason="LTSMIN IS NOT INSTALLED: its counts are not compared")
def test_ltsmin_counts_the_same(case: str, tmp_path: Path) -> None:
    net = net_of(case)
    (tmp_path / "net.pnml").write_text(pnml(net), encoding="utf-8")
    assert counted(["pnml2lts-seq", "net.pnml"], tmp_path) == explore(read_lola(lola(net)))
