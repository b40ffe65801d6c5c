"""E(l) is the greatest total cost of l consecutive transitions from any reachable state."""

from __future__ import annotations

import random
import time
from fractions import Fraction
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.timing.psm import Psm, PsmTransition, make_psm, max_cycle_mean, reachable_edges
from mauve.timing.traces import (
    ConstantCurve,
    FramesCurve,
    PsmCurve,
    TableCurve,
    approximation_of_runs,
    trace,
    witness_run,
    workload_curve,
)

from .test_psm import psm_of, psms


def enumerate_runs(psm: Psm, length: int) -> int:
    """The greatest total cost of up to `length` consecutive transitions, by walking every run."""
    _, edges = reachable_edges(psm)

    def longest(state: int, left: int) -> int:
        if left == 0:
            return 0
        return max((cost + longest(target, left - 1) for cost, target in edges[state]), default=0)

    return max(longest(state, length) for state in range(len(edges)))


@settings(max_examples=100, deadline=None)
@given(psms(max_states=4), st.integers(0, 6))
def test_the_curve_equals_the_enumeration_of_all_runs(psm: Psm, length: int) -> None:
    assert workload_curve(psm, length)[length] == enumerate_runs(psm, length)


@settings(max_examples=100, deadline=None)
@given(psms(), st.integers(0, 12))
def test_the_witness_is_a_run_and_attains_the_curve(psm: Psm, length: int) -> None:
    run = witness_run(psm, length)
    assert sum(t.cost for t in run) == workload_curve(psm, length)[length]
    assert all(t in psm.transitions for t in run)
    assert all(first.target == then.source for first, then in pairwise(run))
    end = run[-1].target if run else psm.initial
    assert len(run) == length or sum(t.cost for t in psm.transitions if t.source == end) == 0 or not run


@settings(max_examples=100, deadline=None)
@given(psms())
def test_the_curve_never_falls_is_subadditive_and_has_the_cycle_mean_as_slope(psm: Psm) -> None:
    curve = workload_curve(psm, 24)
    assert all(step >= 0 for step in trace(curve))
    assert all(curve[k + n] <= curve[k] + curve[n] for k in range(12) for n in range(12))
    assert all(curve[n] >= n * max_cycle_mean(psm) for n in range(25))


@settings(max_examples=150, deadline=None)
@given(psms())
def test_a_proven_repetition_holds(psm: Psm) -> None:
    searched = PsmCurve(psm)
    searched._cap = 100
    law = searched.repeat()
    if law is not None:
        plain = reference_curve(psm, law.start + 3 * law.jobs)
        assert all(
            plain[n + law.jobs] == plain[n] + law.cost for n in range(law.start, law.start + 2 * law.jobs)
        )
        assert Fraction(law.cost, law.jobs) == max_cycle_mean(psm)
        curve = PsmCurve(psm)
        assert [curve.total(n) for n in range(len(plain))] == plain


def reference_curve(psm: Psm, length: int) -> list[int]:
    """The recursion without any shortcut."""
    _, edges = reachable_edges(psm)
    values, totals = [0] * len(edges), [0]
    for _ in range(length):
        values = [max((cost + values[target] for cost, target in out), default=0) for out in edges]
        totals.append(max(values))
    return totals


@settings(max_examples=100, deadline=None)
@given(psms(), st.integers(0, 60))
def test_beyond_the_cap_the_extension_is_an_upper_bound_and_says_so(psm: Psm, jobs: int) -> None:
    curve = PsmCurve(psm)
    curve._cap = 5
    true = reference_curve(psm, jobs)[jobs]
    if curve.estimated(jobs):
        assert curve.total(jobs) >= true
    else:
        assert curve.total(jobs) == true


def test_two_rates_that_never_align_are_extended_by_subadditivity() -> None:
    psm = psm_of(("work", 5, "work"), ("work", 1, "abort"), ("abort", 2, "abort"))
    curve = PsmCurve(psm)
    curve._cap = 50
    far = curve._cap + 7
    assert curve.repeat() is None
    assert curve.estimated(far)
    assert curve.total(far) == 5 * far


def test_runs_from_the_initial_state_alone_would_be_unsound() -> None:
    assert trace(workload_curve(psm_of(("boot", 1, "run"), ("run", 9, "run")), 3)) == (9, 9, 9)


def test_a_trace_need_not_fall() -> None:
    assert trace(workload_curve(psm_of(("a", 5, "b"), ("b", 1, "a")), 4)) == (5, 1, 5, 1)


def test_frames_start_anywhere_and_repeat() -> None:
    curve = FramesCurve((5, 1, 1))
    assert [curve.total(n) for n in range(8)] == [0, 5, 6, 7, 12, 13, 14, 19]
    assert curve.mean == Fraction(7, 3)


@given(st.lists(st.integers(0, 9), min_size=1, max_size=6), st.integers(0, 20))
def test_frames_are_a_psm_of_one_cycle(frames: list[int], jobs: int) -> None:
    size = len(frames)
    arrows = [PsmTransition(str(n), str((n + 1) % size), cost) for n, cost in enumerate(frames)]
    curve = PsmCurve(make_psm("m", "0", arrows))
    assert FramesCurve(frames).total(jobs) == curve.total(jobs)
    assert FramesCurve(frames).mean == curve.mean


def test_a_table_is_extended_by_its_last_value() -> None:
    curve = TableCurve((6, 8, 14))
    assert [curve.total(n) for n in range(8)] == [0, 6, 8, 14, 20, 22, 28, 34]


@pytest.mark.parametrize("make", [lambda: TableCurve(()), lambda: TableCurve((3, 2)), lambda: FramesCurve((-1,))])
def test_a_curve_that_cannot_be_is_refused(make: object) -> None:
    with pytest.raises(ValueError, match=r"negative|at least one"):
        make()  # type: ignore[operator]
    with pytest.raises(ValueError, match="negative"):
        ConstantCurve(-1)


def test_unequal_runs_are_refused() -> None:
    with pytest.raises(ValueError, match="one length"):
        approximation_of_runs([(1, 2), (1,)])


def test_a_large_machine_is_fast() -> None:
    rng = random.Random(5)
    arrows = [PsmTransition(f"s{n}", f"s{(n + 1) % 200}", rng.randrange(10**9)) for n in range(200)]
    arrows += [
        PsmTransition(f"s{rng.randrange(200)}", f"s{rng.randrange(200)}", rng.randrange(10**9)) for _ in range(400)
    ]
    psm = make_psm("m", "s0", arrows)
    best = min(_seconds(psm) for _ in range(3))
    assert best < 0.25  # about 0.03 s on an idle machine


def _seconds(psm: Psm) -> float:
    start = time.process_time()
    workload_curve(psm, 200)
    return time.process_time() - start
