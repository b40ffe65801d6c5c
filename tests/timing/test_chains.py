"""Reaction time and data age of chains: against runs of jobs that read and publish as the semantics says."""

from __future__ import annotations

import random

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.timing.chains import Hop, Latency, chain_latencies
from mauve.timing.response import analyse
from mauve.timing.task import Task, constant


def test_periodic_hops_add_their_periods_and_responses() -> None:
    found = chain_latencies([Hop("a", 10, 3, 3), Hop("b", 20, 8, 8), Hop("c", 5, 1, 1)])
    assert (found.reaction.total, found.age.total) == (47, 42)
    assert [(share.hop, share.wait, share.work) for share in found.reaction.shares] == [
        ("a", 10, 3),
        ("b", 20, 8),
        ("c", 5, 1),
    ]
    assert [(share.wait, share.work) for share in found.age.shares] == [(10, 3), (20, 8), (0, 1)]


def test_a_hop_that_the_one_before_wakes_waits_for_nothing() -> None:
    found = chain_latencies([Hop("a", 10, 3, 3), Hop("b", 10, 7, 4, woken=True), Hop("c", 5, 1, 1)])
    assert (found.reaction.total, found.age.total) == (10 + 3 + 4 + 5 + 1, 10 + 3 + 4 + 1)


def test_what_nothing_bounds_has_no_bound_and_says_why() -> None:
    sporadic = Hop("s", None, 3, 3)
    found = chain_latencies([Hop("a", 10, 3, 3), sporadic])
    assert found.reaction == Latency(None, (), "nothing bounds how long `s` waits for its next activation")
    assert found.age.total == 16
    assert chain_latencies([sporadic, Hop("a", 10, 3, 3)]).age.total is None
    assert chain_latencies([Hop("s", None, 3, 3, woken=True)]).reaction.total == 3
    with pytest.raises(ValueError, match="at least one hop"):
        chain_latencies([])


class Jobs:
    """The jobs of one task: when each reads and publishes, both rising, and the publication that it read."""

    def __init__(self, reads: list[int], ends: list[int], sources: list[int]) -> None:
        self.reads, self.ends, self.sources = reads, ends, sources


def newest(before: Jobs, at: int) -> int:
    """The last job that has published by then; -1 for none."""
    return max((k for k, end in enumerate(before.ends) if end <= at), default=-1)


def run_jobs(hops: list[Hop], rng: random.Random, horizon: int) -> tuple[list[Jobs], list[int]]:
    """Jobs at extreme or random times within the bounds of each hop; the nominal arrivals of the first hop."""
    every: list[Jobs] = []
    first: list[int] = []
    for at, hop in enumerate(hops):
        assert hop.period is not None
        if at and hop.woken:
            starts = [(end, hop.from_release) for end in every[-1].ends]
        else:
            phase = rng.randrange(hop.period)
            starts = [(time, hop.response) for time in range(phase, horizon, hop.period)]
        if not at:
            first = [time for time, _ in starts]
        reads, ends = [], []
        for time, response in starts:
            end = time + rng.choice([1, response, response, rng.randint(1, response)])
            end = max(end, ends[-1] + 1) if ends else end
            end = min(end, time + response)
            ends.append(end)
            reads.append(rng.choice([time, end - 1, rng.randint(time, end - 1)]))
        sources = [newest(every[-1], read) for read in reads] if every else list(range(len(reads)))
        every.append(Jobs(reads, ends, sources))
    return every, first


@st.composite
def chains(draw: st.DrawFn) -> list[Hop]:
    hops: list[Hop] = []
    for number in range(draw(st.integers(1, 4))):
        woken = number > 0 and draw(st.booleans())
        period = draw(st.integers(2, 12))
        response = draw(st.integers(1, period))
        if woken and hops:
            period = hops[-1].period or 1
            response = draw(st.integers(1, 4))
        hops.append(Hop(f"h{number}", period, response, response, woken=woken))
    return hops


@settings(max_examples=60, deadline=None)
@given(chains(), st.integers(0, 2**32))
def test_no_run_exceeds_the_bounds(hops: list[Hop], seed: int) -> None:
    rng = random.Random(seed)
    found = chain_latencies(hops)
    assert found.reaction.total is not None and found.age.total is not None
    every, first = run_jobs(hops, rng, 120)
    used: dict[int, int] = {}
    for job, end in enumerate(every[-1].ends):
        source = job
        for jobs in reversed(every[1:]):
            source = jobs.sources[source] if source >= 0 else -1
        if source < 0:
            continue
        assert end - first[source] <= found.age.total
        used.setdefault(source, end)
    for source, read in enumerate(every[0].reads[:-1]):
        # A change just after this read is seen by the next job, and shows in the first output that used it or a later.
        shows = [end for other, end in used.items() if other > source]
        if shows:
            assert min(shows) - read <= found.reaction.total


def test_the_bounds_are_met_by_the_worst_phases() -> None:
    hops = [Hop("a", 10, 3, 3), Hop("b", 20, 8, 8)]
    # a publishes at 3, 13, ..; b reads at 12 (just before), 32, .. and publishes 8 later.
    writer = Jobs(list(range(0, 200, 10)), list(range(3, 203, 10)), [])
    ages = [read + 8 - 10 * newest(writer, read) for read in range(12, 152, 20)]
    assert chain_latencies(hops).age.total == max(ages) + 1
    # A change at 0+ is read at 10, published at 13, read by b at 32, and shows at 40.
    assert chain_latencies(hops).reaction.total == 40 - 0 + 1


def test_the_response_from_the_release_is_that_of_other_tools() -> None:
    """Jitter above the period: 6 and 31 from the release, 27 and 49 from the nominal arrival."""
    tasks = [
        Task("a", 2, 10, 60, (constant("a", 2),), jitter=25),
        Task("b", 1, 20, 200, (constant("b", 9),), jitter=30),
    ]
    found = [(one.wcrt, one.from_release) for one in analyse(tasks).results]
    assert found == [(27, 6), (49, 31)]
