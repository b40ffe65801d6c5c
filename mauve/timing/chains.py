"""Chains of tasks that hand on data: how old an output's data is at most, and how long a change takes to show.

A hop copies its inputs when its job is released and publishes its outputs when the job ends (semantics of record,
section 1). It is either woken by the hop before it (`woken`), or runs on its own and takes whatever was published last.
With a(k) the nominal arrival of job k, it reads at or after a(k) and publishes by a(k) + R. Hops that wake one another
form a segment with the period T of its first hop; its response R is the sum of the first hop's response from its
nominal arrival and of the others' from their release.

Reaction time: from a change at the input of the first hop to the first output that reflects it. The change just misses
a job, so the next one publishes by T_1 + R_1 after it; from each publication the next segment has an arrival within
T, and publishes by R after that:

    reaction <= sum over all segments of T + R        (Davare et al., 2007; R alone for a first hop woken from outside)

Data age: from the nominal arrival of the first hop's job whose input an output reflects to the output's publication.
A job of segment s that reads at r finds the output of the last job k of the segment before that has published; as job
k+1 has not, r < a(k) + T + R:

    age <= R of the last segment + sum over the segments before it of T + R

After its publication an output stays until the next one replaces it; what reads it sees data older by up to T + R of
the last segment, less what the job itself took.

Nothing is assumed about offsets between tasks.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

from mauve.records import record


@record
class Hop:
    """A task on a chain.

    period: greatest separation of its nominal arrivals, None where nothing bounds it; response: R from the nominal
    arrival; from_release: the same from the release (`ResponseResult.from_release`); woken: activated by each
    publication of the hop before it and by nothing else (for the first hop: by the event that the chain starts with).
    """

    name: str
    period: int | None
    response: int
    from_release: int
    woken: bool = False


@record
class Share:
    """What one hop contributes: `wait` until it looks at the data (reaction), or for how long its output stands
    (age); `work` from its arrival to its publication."""

    hop: str
    wait: int
    work: int

    @property
    def total(self) -> int:
        """Both together."""
        return self.wait + self.work


@record
class Latency:
    """A bound and the shares that add up to it, in the order of the hops; None where `unbounded` names why."""

    total: int | None
    shares: tuple[Share, ...]
    unbounded: str = ""


@record
class ChainResult:
    """Both latencies of one chain."""

    reaction: Latency
    age: Latency


def chain_latencies(hops: Sequence[Hop]) -> ChainResult:
    """Reaction time and data age of a chain. ValueError for a chain without a hop."""
    if not hops:
        raise ValueError("a chain has at least one hop")
    return ChainResult(_reaction(hops), _age(hops))


def _heads(hops: Sequence[Hop]) -> list[int]:
    """Where the segments begin."""
    return [at for at, hop in enumerate(hops) if at == 0 or not hop.woken]


def _works(hops: Sequence[Hop]) -> list[int]:
    """What each hop takes within its segment."""
    return [hop.from_release if at and hop.woken else hop.response for at, hop in enumerate(hops)]


def _reaction(hops: Sequence[Hop]) -> Latency:
    heads, works = _heads(hops), _works(hops)
    shares: list[Share] = []
    for at, hop in enumerate(hops):
        wait = 0
        if at in heads and not (at == 0 and hop.woken):
            if hop.period is None:
                return Latency(None, (), f"nothing bounds how long `{hop.name}` waits for its next activation")
            wait = hop.period
        shares.append(Share(hop.name, wait, works[at]))
    return _latency(shares)


def _age(hops: Sequence[Hop]) -> Latency:
    heads, works = _heads(hops), _works(hops)
    shares = [Share(hop.name, 0, work) for hop, work in zip(hops, works, strict=True)]
    for head, following in pairwise(heads):
        first, writer = hops[head], hops[following - 1]
        if first.period is None:
            return Latency(None, (), f"nothing bounds how long an output of `{writer.name}` stands")
        last = shares[following - 1]
        shares[following - 1] = Share(last.hop, first.period, last.work)
    return _latency(shares)


def _latency(shares: Sequence[Share]) -> Latency:
    return Latency(sum(share.total for share in shares), tuple(shares))
