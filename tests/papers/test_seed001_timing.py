"""Section III.C of the MAUVE paper: figures 4 and 5."""

from __future__ import annotations

from mauve.timing.psm import Psm, PsmTransition, make_psm, shape
from mauve.timing.traces import approximation_of_runs, trace, witness_run, workload_curve


def figure_4() -> Psm:
    """The machine of figure 4, read off the text's runs abbc, bbca and ccaa."""
    arrows = [("a", 2, "a"), ("a", 7, "b"), ("b", 1, "b"), ("b", 10, "c"), ("c", 5, "c"), ("c", 8, "a")]
    return make_psm("figure 4", "a", [PsmTransition(source, target, cost) for source, cost, target in arrows])


def test_figure_5_approximates_three_runs() -> None:
    assert approximation_of_runs([(7, 1, 10), (1, 10, 8), (5, 8, 2)]) == (7, 6, 6)


def test_figure_4_has_the_three_properties_of_a_generated_psm() -> None:
    psm = figure_4()
    assert shape(psm).strongly_connected
    assert all(any(t.source == t.target == state for t in psm.transitions) for state in psm.states)
    assert len({(t.source, t.target) for t in psm.transitions}) == len(psm.transitions)


def test_the_whole_machine_of_figure_4_has_a_dearer_trace_than_its_three_runs() -> None:
    assert trace(workload_curve(figure_4(), 3)) == (10, 8, 7)
    assert [t.cost for t in witness_run(figure_4(), 2)] == [10, 8]
    assert sum(t.cost for t in witness_run(figure_4(), 3)) == 25
