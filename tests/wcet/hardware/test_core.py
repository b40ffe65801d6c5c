"""Core data files: all of them load, every entry has a source, and mistakes in them are found."""

from __future__ import annotations

import pytest

from mauve.wcet.hardware.core import CoreFileError, Linear, core_names, load_core, parse_core, parse_linear

HEAD = """
name = "toy"
title = "Toy"
model = "pipeline"
aliases = []
states = ["arm"]
multiplier = 0
sources = ["a manual"]
[compositional]
holds = true
reason = "a reason"
[timing]
condition_failed = { cycles = 1, source = "s", confidence = "high" }
"""


def test_cores_and_aliases() -> None:
    names = core_names()
    assert {"arm7tdmi", "arm9tdmi", "arm9ejs", "arm920t", "arm926ej-s"} <= set(names)
    assert {"cortex-m0", "cortex-m0plus", "cortex-m3", "cortex-m4"} <= set(names)
    for name in names:
        core = load_core(name)
        assert core is not None
        assert core.sources and core.reason
        assert all(entry.source for entry in core.timing.values())
    assert load_core("ARM926EJ-S") == load_core("arm9ejs")
    assert load_core("arm920t") == load_core("arm9tdmi")
    assert load_core("z80") is None


def test_inherited_entries() -> None:
    m3, m4 = load_core("cortex-m3"), load_core("cortex-m4")
    assert m3 is not None and m4 is not None
    assert m4.timing["div"] == m3.timing["div"]
    assert m4.timing["long_mul"].cycles.at(0, 0) < m3.timing["long_mul"].cycles.at(0, 0)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        (2, Linear(2)),
        ("n-1", Linear(-1, 1)),
        ("m + 1", Linear(1, 0, 1)),
        ("2n+4", Linear(4, 2)),
        ("m", Linear(0, 0, 1)),
    ],
)
def test_cycle_expressions(text: str | int, expected: Linear) -> None:
    assert parse_linear(text) == expected


@pytest.mark.parametrize("text", ["x", "n n", "n*", "1.5", "n--1"])
def test_other_expressions_are_refused(text: str) -> None:
    with pytest.raises(CoreFileError):
        parse_linear(text)


@pytest.mark.parametrize(
    ("line", "complaint"),
    [
        ('halt = { cycles = 1, source = "s", confidence = "high" }', "no class of instructions"),
        ('alu = { cycles = 1, confidence = "high" }', "needs a source"),
        ('alu = { cycles = 1, source = "s", confidence = "sure" }', "needs a source"),
        ('alu = { fetch_s = 1, source = "s", confidence = "high" }', "means nothing in the pipeline model"),
        ('alu = { source = "s", confidence = "high" }', "takes no time"),
        ('alu = { cycles = 1, delay = -1, source = "s", confidence = "high" }', "no number of cycles"),
    ],
)
def test_mistakes_in_core_files(line: str, complaint: str) -> None:
    with pytest.raises(CoreFileError, match=complaint):
        parse_core(HEAD + line)


def test_a_branch_hides_every_result_delay() -> None:
    with pytest.raises(CoreFileError, match="shorter than a result delay"):
        parse_core(
            HEAD
            + 'load = { cycles = 1, delay = 4, source = "s", confidence = "high" }\n'
            + 'branch = { cycles = 3, source = "s", confidence = "high" }\n'
        )
