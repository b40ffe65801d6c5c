"""What a plan and a net must satisfy, and the net as text."""

from __future__ import annotations

import pytest

from mauve.mission.net import Level, Transition
from mauve.mission.plan import Child, Hardware, Mission, Parallel, Step
from mauve.mission.printing import net_text
from mauve.mission.templates import build_net, hardware_alone
from mauve.mission.verify import faults, verify
from mauve.records import changed
from tests.mission.build import does, mission, ways


@pytest.mark.parametrize(
    ("plan", "fault"),
    [
        (mission(does("o", "a"), activities=(ways("a", ("h", "")),)), "a consumes h, which is not declared"),
        (mission(does("o", "b"), activities=()), "o does b, which is no activity"),
        (mission(does("o", "a"), activities=(ways("a"),)), "a has no alternative"),
        (
            mission(does("o", "a"), activities=(ways("a", ("s", "")),), software="s"),
            "s is consumed and produced by no activity",
        ),
        (
            mission(does("o", "a"), activities=(ways("a", ("", "s")), ways("b", ("", "s"))), software="s"),
            "s is produced by a and b",
        ),
        (
            mission(does("o", "a"), activities=(ways("a", ("", "h")),), hardware="h"),
            "a produces h, which is no software resource",
        ),
        (
            mission(
                does("o", "a"), activities=(ways("a", ("t", "s"), ("", "s")), ways("b", ("s", "t"))), software="s t"
            ),
            "a needs b needs a",
        ),
        (
            mission(Parallel("p", (Child(Step(does("o")), mandatory=False),)), activities=()),
            "p has no mandatory objective",
        ),
        (mission(does("o"), activities=(), hardware="h h"), "h is declared 2 times"),
    ],
)
def test_a_plan_without_a_sound_net_is_told_why(plan: Mission, fault: str) -> None:
    assert faults(plan) == (fault,)


def test_a_net_that_loses_a_token_is_found() -> None:
    net = build_net(mission(does("o", "a"), activities=(ways("a", ("h", "")),), hardware="h"))
    assert not verify(net)
    for number, one in enumerate(net.transitions):
        broken = changed(one, after=one.after[1:])
        spoilt = changed(net, transitions=(*net.transitions[:number], broken, *net.transitions[number + 1 :]))
        if set(one.after[:1]) <= {place for unit in net.units for place in unit} and one.after:
            assert verify(spoilt)


def test_events_belong_to_level_0_and_names_are_unique() -> None:
    net = hardware_alone(Hardware("R"))
    first = net.transitions[0]
    extra = Transition("odd", first.before, first.after, Level.RESOURCE, first.event)
    assert verify(changed(net, transitions=(*net.transitions, extra)))
    assert verify(changed(net, transitions=(*net.transitions, first)))
    assert verify(changed(net, places=(*net.places, net.places[0])))


def test_a_net_is_printed_by_parts_and_levels() -> None:
    assert net_text(hardware_alone(Hardware("R"))) == (
        "net R: 10 places, 10 transitions\n"
        "\n"
        "places\n"
        "  R          free*  busy  OOS  available*  failingF  failingB  take  answer  release  error\n"
        "\n"
        "level 4: resources and activities\n"
        "  R.take!: R.take + R.free -> R.answer + R.busy\n"
        "  R.release!: R.release + R.busy -> R.free + R.available\n"
        "  R.fail_free: R.failingF + R.available -> R.OOS\n"
        "  R.fail_busy: R.failingB -> R.OOS + R.error\n"
        "  R.ERROROK: R.answer + R.error -> -\n"
        "\n"
        "level 0: events\n"
        "  R.TAKE: R.available -> R.take  [R_EV_TAKE]\n"
        "  R.RELEASE: R.answer -> R.release  [R_EV_RELEASE]\n"
        "  R.oos_free: R.free -> R.failingF  [R_EV_OOS]\n"
        "  R.oos_busy: R.busy -> R.failingB  [R_EV_OOS]\n"
        "  R.rd: R.OOS -> R.free + R.available  [R_EV_RD]\n"
    )
