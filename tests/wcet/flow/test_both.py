"""Bounds of two analyses put together."""

from __future__ import annotations

from collections.abc import Mapping

from mauve.wcet.binary.loops import loop_nest
from mauve.wcet.binary.split import restricted
from mauve.wcet.flow.both import better
from mauve.wcet.flow.result import FunctionFlow, LoopBound, ProgramFlow
from mauve.wcet.result import Origin, Problem, ProblemKind
from tests.wcet.binary.test_loops import graph


def _program(flow: FunctionFlow) -> ProgramFlow:
    key = flow.cfg.key, ""
    return ProgramFlow(key, {key: flow})


def _flow(cfg: object, bounds: Mapping[int, int]) -> FunctionFlow:
    nest = loop_nest(cfg)  # type: ignore[arg-type]
    found = {loop: LoopBound(bound, Origin.ANALYSIS, "test") for loop, bound in bounds.items()}
    left = tuple(
        Problem(ProblemKind.LOOP, "no bound", cfg.blocks[loop.header].address, "f")  # type: ignore[attr-defined]
        for loop in nest.loops
        if loop.id not in bounds
    )
    return FunctionFlow(cfg, nest, found, frozenset(), {}, {}, left)  # type: ignore[arg-type]


def test_each_loop_has_the_smaller_bound() -> None:
    cfg = graph([[1], [2], [2, 1, 3], []])
    (merged,) = better(_program(_flow(cfg, {0: 9})), _program(_flow(cfg, {0: 4, 1: 7}))).functions.values()
    assert {loop: bound.bound for loop, bound in merged.bounds.items()} == {0: 4, 1: 7}
    assert not merged.problems


def test_a_header_that_two_graphs_share_may_be_that_of_different_loops() -> None:
    """The loop of 1 and 2, and 2 by itself. Without the edge from 2 to 1, the loop of 2 is left, as often as it runs by
    itself; with it and without the way in at 1, 2 is the header of both."""
    cfg = graph([[1, 2], [2], [2, 1, 3], []])
    both = restricted(cfg, {index for index, e in enumerate(cfg.edges) if (e.source, e.target) != (0, 1)})
    alone = restricted(cfg, {index for index, e in enumerate(cfg.edges) if (e.source, e.target) != (2, 1)})
    open_, known = _flow(both, {}), _flow(alone, {0: 3})
    headers = [flow.cfg.blocks[flow.nest.loops[0].header].address for flow in (open_, known)]
    assert headers[0] == headers[1] and len(open_.nest.loops[0].blocks) > len(known.nest.loops[0].blocks)
    (merged,) = better(_program(open_), _program(known)).functions.values()
    assert not merged.bounds and merged.problems
