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

One case is tighter, where inputs are copied only when the job starts to run (`reads_at_start`). If the last hop of a
segment and the first of the next share a processor, and the former is more urgent and never waits within its job, then
the latter cannot start while the former is released and unfinished. So it arrives at most T after the release
(reaction), or before the release of job k+1 (age): what the writer itself takes from its release does not count (after
Duerr et al., 2019). Offsets between tasks are not assumed.
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
    publication of the hop before it and by nothing else (for the first hop: by the event that the chain starts with);
    jitter: greatest delay from the nominal arrival to the release; reads_at_start: its inputs are copied by the job
    itself when it starts to run, not at its release; then processor and priority, where both are known, are for the
    tighter case; waits: whether a job may suspend itself.
    """

    name: str
    period: int | None
    response: int
    from_release: int
    woken: bool = False
    jitter: int = 0
    processor: str = ""
    priority: int | None = None
    waits: bool = False
    reads_at_start: bool = False


@record
class Share:
    """What one hop contributes: `wait` until it looks at the data (reaction), or for how long its output stands
    (age); `work` from its arrival to its publication. `hidden` says that a more urgent writer's time does not count."""

    hop: str
    wait: int
    work: int
    hidden: bool = False

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


def _hides(writer: Hop, reader: Hop) -> bool:
    """Whether the reader's job cannot read while the writer's is released and unfinished."""
    if not reader.reads_at_start or writer.waits or writer.priority is None or reader.priority is None:
        return False
    return writer.processor == reader.processor != "" and writer.priority > reader.priority


def _reaction(hops: Sequence[Hop]) -> Latency:
    heads, works = _heads(hops), _works(hops)
    shares: list[Share] = []
    for at, hop in enumerate(hops):
        if at and at in heads and _hides(hops[at - 1], hop):
            last = shares[-1]
            shares[-1] = Share(last.hop, last.wait, hops[at - 1].jitter if at - 1 in heads else 0, hidden=True)
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
        first, writer, reader = hops[head], hops[following - 1], hops[following]
        if first.period is None:
            return Latency(None, (), f"nothing bounds how long an output of `{writer.name}` stands")
        last = shares[following - 1]
        hidden = _hides(writer, reader)
        work = last.work if not hidden else writer.jitter if following - 1 == head else 0
        shares[following - 1] = Share(last.hop, first.period, work, hidden)
    return _latency(shares)


def _latency(shares: Sequence[Share]) -> Latency:
    return Latency(sum(share.total for share in shares), tuple(shares))
