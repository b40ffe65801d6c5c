"""Spelling help finds slips and stays silent about strangers."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from mauve.diagnostics.suggest import closest, distance

NAMES = ("position", "attitude", "state", "StateFusion", "heading_tolerance", "Rotating", "Reaching", "ms", "us", "min")


@pytest.mark.parametrize(
    ("word", "expected"),
    [
        ("altitude", ("attitude",)),
        ("StateFussion", ("StateFusion",)),
        ("stateFusion", ("StateFusion",)),
        ("STATE", ("state",)),
        ("positoin", ("position",)),
        ("headingTolerance", ("heading_tolerance",)),
        ("heading", ("heading_tolerance",)),
        ("msec", ("ms",)),
        ("Stat", ("state",)),
        ("zebra", ()),
        ("", ()),
        ("x", ()),
    ],
)
def test_a_slip_finds_its_name(word: str, expected: tuple[str, ...]) -> None:
    assert closest(word, NAMES) == expected


def test_the_nearest_comes_first_and_there_are_few() -> None:
    assert closest("read", ["reads", "ready", "red", "real", "road", "read"], limit=2) == ("reads", "ready")


def test_a_very_long_word_costs_nothing() -> None:
    assert closest("x" * 1_000_000, ["x" * 900_000, "xx"]) == ()


@given(st.text(max_size=12), st.text(max_size=12))
def test_distance_is_symmetric_and_zero_for_the_same(left: str, right: str) -> None:
    assert distance(left, right, 20) == distance(right, left, 20)
    assert (distance(left, right, 20) == 0) == (left == right)
    exact = distance(left, right, 20)
    assert exact is not None
    assert distance(left, right, 2) == (exact if exact <= 2 else None)
