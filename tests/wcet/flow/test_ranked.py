"""Ranking arguments are found once for contexts that look the same, and again for others."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import pytest

from mauve.wcet.binary.cfg import build_cfg
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.loops import loop_nest
from mauve.wcet.flow.locations import Interval, Location, NoValues, whole
from mauve.wcet.flow.ranked import ContextRanking, Ranked
from mauve.wcet.flow.ranking import Ranking, bound_by_ranking

IMAGE = Path(__file__).resolve().parents[1] / "fixtures" / "arm7tdmi-arm-O2.elf"


@dataclass(frozen=True)
class Entered(NoValues):
    """Values of which only r1 on entry is known, up to a number."""

    most: int

    def on_entry(self, location: Location) -> Interval:
        return Interval(0, self.most) if location == 1 else whole(location)


@pytest.mark.parametrize("function", ["sum", "loop_variable_step", "clear_lowest_bit", "__udivsi3", "binary_search"])
def test_contexts_with_the_same_answers_share_the_search(function, monkeypatch):
    binary = load(IMAGE)
    assert isinstance(binary, Binary)
    cfg = build_cfg(binary, binary.function(function).key)
    nest, searched = loop_nest(cfg), []
    bound = Ranking.bound

    def counted(self, loop, values=None):
        searched.append(loop.id)
        return bound(self, loop, values)

    monkeypatch.setattr(Ranking, "bound", counted)
    together, found = Ranked(), {}
    for most in (40, 40, 7, 40, 7):
        context = ContextRanking(together, cfg, nest, NoValues(), {})
        for loop in nest.loops:
            found.setdefault((loop.id, most), set()).add(context.bound(loop, Entered(most)))
    assert len(nest.loops) <= len(searched) <= 2 * len(nest.loops)
    monkeypatch.undo()
    for (number, most), results in found.items():
        alone = bound_by_ranking(cfg, nest, nest.loops[number], Entered(most))
        assert results == {None if alone is None else (alone.bound, alone.method)}
