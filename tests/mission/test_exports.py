"""What other tools read: written, read back by independent readers, and explored."""

from __future__ import annotations

import json
import os
import re
from pathlib import Path

import jsonschema
import pytest

from mauve.mission.dot import graph_dot, net_dot
from mauve.mission.flatten import flatten, leaves
from mauve.mission.graph import AlternativesGraph, MarkingsGraph
from mauve.mission.graph_json import graph_document
from mauve.mission.lola import complete, lola
from mauve.mission.markings import markings_graph
from mauve.mission.net import Level, Net, Transition
from mauve.mission.plan import Sequence, Step
from mauve.mission.pnml import pnml
from mauve.mission.stable import alternatives_graph
from mauve.mission.templates import build_net
from mauve.mission.tina import tina
from mauve.records import changed

from .coral import MOTIONS, coral
from .readers import Read, explore, read_lola, read_pnml, read_tina

ROOT = Path(__file__).parents[2]

PLACES = ("R.available", "R.free", "R.take", "R.answer", "R.busy", "R.failing free", "R.failing busy", "R.release",
          "R.error", "R.out")  # fmt: skip


def arrow(name: str, before: str, after: str, level: Level = Level.RESOURCE, event: str = "") -> Transition:
    def numbers(places: str) -> tuple[int, ...]:
        return tuple(PLACES.index("R." + place) for place in places.split(", ") if place)

    return Transition(name, numbers(before), numbers(after), level, event)


SENSOR = Net(
    "one sensor & {its} environment",
    PLACES,
    (
        arrow("TAKE", "available", "take", Level.EVENT, "R_EV_TAKE"),
        arrow("out 1", "free", "failing free", Level.EVENT, "R_EV_OOS"),
        arrow("out 2", "busy", "failing busy", Level.EVENT, "R_EV_OOS"),
        arrow("back", "out", "free, available", Level.EVENT, "R_EV_RD"),
        arrow("RELEASE", "answer", "release", Level.EVENT, "R_EV_RELEASE"),
        arrow("take!", "take, free", "answer, busy"),
        arrow("take?", "take, free", "answer, busy"),
        arrow("release!", "release, busy", "free, available"),
        arrow("fail free", "failing free, available", "out"),
        arrow("fail busy", "failing busy", "out, error"),
        arrow("ERROROK", "answer, error", ""),
    ),
    (0, 1),
)
"""A hardware resource as in figure 10 of the mission paper; one of its transitions stands there twice."""


def plain(net: Net) -> Read:
    def names(places: tuple[int, ...]) -> frozenset[str]:
        return frozenset(net.places[at] for at in places)

    return names(net.initial), {one.name: (names(one.before), names(one.after), one.level) for one in net.transitions}


PRIORITIES = explore(plain(SENSOR))


def test_pnml_read_back_has_the_same_markings() -> None:
    assert explore(read_pnml(pnml(SENSOR))) == PRIORITIES
    assert "one sensor &amp; {its} environment" in pnml(SENSOR)
    assert "<event>R_EV_OOS</event>" in pnml(SENSOR)


def test_tina_read_back_has_the_same_markings() -> None:
    text = tina(SENSOR)
    assert explore(read_tina(text)) == PRIORITIES
    assert "tr {out 1} : R_EV_OOS [0,w[ {R.free} -> {R.failing free}" in text.splitlines()
    assert r"net {one sensor & \{its\} environment}" in text


def without_priorities(net: Read) -> Read:
    return net[0], {name: (before, after, 0) for name, (before, after, _) in net[1].items()}


def test_lola_has_the_net_without_priorities() -> None:
    net = complete(SENSOR)
    counts = explore(read_lola(lola(net)))
    assert counts == explore(without_priorities(read_pnml(pnml(net))))
    assert counts[0] > PRIORITIES[0] == 8


def test_lola_names_stay_apart() -> None:
    text = lola(SENSOR)
    assert len(re.findall(r"^TRANSITION take_(_2)?$", text, re.MULTILINE)) == 2
    assert read_lola(text)[1].keys() >= {"take_", "take__2"}


@pytest.mark.parametrize("write", [pnml, tina, lola])
def test_the_text_does_not_change_from_run_to_run(write: object) -> None:
    assert callable(write)
    assert write(SENSOR) == write(SENSOR)


def coral_net() -> Net:
    return build_net(coral())


def coral_graph() -> AlternativesGraph:
    graph = alternatives_graph(coral_net())
    assert isinstance(graph, AlternativesGraph)
    return graph


def small_net() -> Net:
    """The net of one objective of the coral mission: with as many kinds of parts, but few interleavings."""
    whole = coral()
    step = next(leaf for leaf in leaves(flatten(whole)) if leaf.objective.name == "Diving")
    kept = tuple(one for one in whole.activities if one.name not in MOTIONS or one.name == "diving")
    return build_net(changed(whole, root=Sequence("Small", (Step(step.objective),)), activities=kept))


def test_a_whole_mission_read_back_has_the_same_markings() -> None:
    net = coral_net() if os.environ.get("MAUVE_LONG") else small_net()
    full = markings_graph(net)
    assert isinstance(full, MarkingsGraph) and full.states > 500
    assert explore(read_pnml(pnml(net))) == explore(read_tina(tina(net))) == (full.states, full.edges)


DOT_STATEMENT = re.compile(
    r"""\s*(digraph\ \w+\ \{ | subgraph\ \w+\ \{ | \} |
    (?:\w+(?:\ ->\ \w+)?\ )?(?:\[)?(?:\w+=(?:"(?:[^"\\]|\\.)*"|[\w.]+)\ ?)*\]?;(?:\ edge\ \[arrowsize=0.6\];)? |
    \w+\ ->\ \w+;)\s*""",
    re.VERBOSE,
)


def drawn(text: str) -> tuple[set[str], set[tuple[str, str]]]:
    """Nodes and arrows of a DOT text, each of whose lines must be a statement."""
    lines = text.splitlines()
    assert not [line for line in lines if not DOT_STATEMENT.fullmatch(line)]
    assert text.count("{\n") == sum(line.strip() == "}" for line in lines)
    nodes = {found[1] for line in lines if (found := re.match(r"\s*([pts]\d+) \[", line))}
    arrows = {(found[1], found[2]) for line in lines if (found := re.match(r"\s*(\w+) -> (\w+)", line))}
    assert {end for arrow in arrows for end in arrow} <= nodes
    return nodes, arrows


def test_a_drawing_of_the_net_has_all_its_places_and_arcs() -> None:
    net = coral_net()
    nodes, arrows = drawn(net_dot(net))
    assert len(nodes) == len(net.places) + len(net.transitions)
    arcs = sum(len(set(one.before) | set(one.after)) for one in net.transitions)
    assert len(arrows) == arcs
    assert '"say \\"hi\\""' in net_dot(Net('say "hi"', ("a",), (), (0,)))


def test_a_drawing_of_the_graph_frames_objectives() -> None:
    graph = coral_graph()
    nodes, arrows = drawn(graph_dot(graph))
    assert len(nodes) == len(graph.markings)
    assert arrows == {(f"s{edge.source}", f"s{edge.target}") for edge in graph.edges()}
    text = graph_dot(graph, only_in_service=True)
    assert len(drawn(text)[0]) == sum(not graph.view(state).lost for state in range(len(graph.markings)))
    assert 'label="LocalizedObservation.ManualMoving"' in text and "Diving_EV_OK" in text


def test_the_graph_as_json_keeps_to_its_schema() -> None:
    graph = coral_graph()
    document = json.loads(json.dumps(graph_document(graph)))
    schema = json.loads((ROOT / "docs/schema/alternatives-1.schema.json").read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator(schema).validate(document)
    assert len(document["states"]) == len(graph.markings) and len(document["edges"]) == len(graph.events)
    start = next(edge for edge in document["edges"] if edge["event"] == "MISSION_EV_START" and edge["source"] == 0)
    state = document["states"][start["target"]]
    assert state["objectives"] == ["LocalizedObservation.ManualMoving"]
    assert {"activity": "localisation", "alternative": "gps"} in state["running"]
