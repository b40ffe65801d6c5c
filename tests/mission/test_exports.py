"""What other tools read: written, read back by independent readers, and explored."""

from __future__ import annotations

import re

import pytest

from mauve.mission.lola import complete, lola
from mauve.mission.net import Level, Net, Transition
from mauve.mission.pnml import pnml
from mauve.mission.tina import tina

from .readers import Read, explore, read_lola, read_pnml, read_tina

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
