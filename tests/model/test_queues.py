"""How many elements may wait in a queue (docs/decisions/0002)."""

from __future__ import annotations

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st
from written import codes, model_of, resolved

from mauve.model.model import Component, ComponentKind, Instance, Port, PortKind, Setting
from mauve.model.queues import most_arrivals
from mauve.model.types import BUILT_IN
from mauve.source import SourceFile, Span

NOWHERE = Span(SourceFile("", ""), 0, 0)


def _instance(
    period: int, deadline: int, jitter: int = 0, sporadic: bool = False, kind: PortKind = PortKind.IN
) -> Instance:
    port = Port("value", kind, BUILT_IN["f64"], NOWHERE, NOWHERE)
    component = Component("C", ComponentKind.ACTIVE, (port,), (), (), (), (), (), (), NOWHERE)
    return Instance("c", component, Setting(period), sporadic, Setting(deadline), Setting(1), 0, jitter, NOWHERE)


@pytest.mark.parametrize(
    ("producer", "consumer", "most"),
    [((1, 1), (10, 10), 11), ((10, 10), (10, 10), 2), ((10, 10), (1, 1), 2), ((5, 2), (10, 10), 3)],
)
def test_arrivals_between_two_copies(producer: tuple[int, int], consumer: tuple[int, int], most: int) -> None:
    assert most_arrivals("value", _instance(*producer), _instance(*consumer)) == most


@given(st.integers(1, 20), st.integers(1, 40), st.integers(0, 9), st.integers(1, 30), st.integers(0, 9), st.data())
def test_no_run_has_more_arrivals(t_p: int, d_p: int, j_p: int, t_c: int, j_c: int, data: st.DataObject) -> None:
    """Publications at any time between release and deadline, copies at any time of the release jitter."""
    most = most_arrivals("value", _instance(t_p, d_p, j_p), _instance(t_c, t_c, j_c))
    phase = data.draw(st.integers(0, t_p))
    published = [phase + k * t_p + data.draw(st.integers(0, d_p)) for k in range(12)]
    copies = [k * t_c + data.draw(st.integers(0, j_c)) for k in range(8)]
    for before, after in pairwise(copies):
        assert sum(before < at <= after for at in published) <= (most or 0)


def test_a_consumer_that_may_sleep_has_no_bound_unless_the_element_wakes_it() -> None:
    producer = _instance(10, 10)
    assert most_arrivals("value", producer, _instance(20, 20, sporadic=True)) is None
    assert most_arrivals("value", producer, _instance(20, 20, sporadic=True, kind=PortKind.EVENT)) == 2


TEXT = """
component Producer {
  out port value: f64
  codel make writes value
  behaviour {
    initial state On {
      run make
    }
  }
}
external component Sink {
  in port values: f64
}
architecture R {
  instance a: Producer { period 1ms }
  instance b: Producer { period 1ms }
  instance sink: Sink { period 10ms }
%s
}
"""


@pytest.mark.parametrize(
    ("connections", "expected"),
    [
        ("connect a.value -> sink.values", []),
        ("connect a.value -> sink.values\nconnect b.value -> sink.values", ["MV205"]),
        ("connect a.value -> sink.values buffered size 11\nconnect b.value -> sink.values", ["MV205"]),
        ("connect a.value -> sink.values buffered size 11\nconnect b.value -> sink.values buffered size 11", []),
        ("connect a.value -> sink.values buffered size 10", ["MV206"]),
        ("connect a.value -> sink.values buffered size 10 drop oldest", []),
        ("connect a.value -> sink.values buffered", ["MV213"]),
        ("connect a.value -> sink.values buffered size 0", ["MV209"]),
    ],
)
def test_fan_in_and_overflow(connections: str, expected: list[str]) -> None:
    _, report = resolved(TEXT % connections)
    assert [code for code in codes(report) if code != "MV406"] == expected


def test_a_queue_keeps_its_policy() -> None:
    model = model_of(TEXT % "connect a.value -> sink.values buffered size 10 drop newest")
    (connection,) = model.architectures[0].data
    assert connection.size == 10 and connection.overflow is not None
