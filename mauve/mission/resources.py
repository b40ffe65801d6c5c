"""Templates of resources (mission paper, section 6.1), with the places that the paper's figures leave to the reader.

Every resource has the paper's interface: `available` (it may be requested), `take`, `answer`, `release`, and `error`:
what the consumer holds is gone. A software resource has `refused` as well, which answers a request in vain: a consumer
that still collects answers could else not tell what it never had from what it has lost since.
"""

from __future__ import annotations

from mauve.mission.draft import Draft
from mauve.mission.net import Event, EventKind, Level
from mauve.mission.plan import Hardware, Software
from mauve.records import record

R = Level.RESOURCE


@record
class Demand:
    """Whether somebody asks for something: exactly one of the two places holds a token."""

    asked: int
    unasked: int


@record
class Access:
    """The interface of a resource for one consumer; `refusals` are read to know that a request would be in vain.

    `error` is None where the resource cannot be lost, `refused` where a request is never refused.
    """

    available: int
    take: int
    answer: int
    release: int
    error: int | None
    refused: int | None
    refusals: tuple[int, ...]


@record
class Refusal:
    """What refuses a request that waits: the places it takes, and those it fills."""

    before: tuple[int, ...]
    after: tuple[int, ...]


@record
class Product:
    """A software resource as its producer sees it."""

    activation: int
    deactivation: int
    ack: int
    demands: tuple[Demand, ...]
    refusals: tuple[Refusal, ...]


def asking(draft: Draft, group: str, suffix: str = "") -> Demand:
    """A demand that nobody makes at first."""
    unit = f"{group}.asked{suffix}"
    asked = draft.place(group, f"asked{suffix}", unit=unit)
    return Demand(asked, draft.place(group, f"unasked{suffix}", marked=True, unit=unit))


def _access(draft: Draft, group: str, suffix: str = "", error: bool = True) -> tuple[int, int, int, int, int | None]:
    return (
        draft.place(group, f"available{suffix}", marked=True),
        draft.place(group, f"take{suffix}", transient=True),
        draft.place(group, f"answer{suffix}", transient=True),
        draft.place(group, f"release{suffix}", transient=True),
        draft.place(group, f"error{suffix}", transient=True) if error else None,
    )


def _crossing(draft: Draft, name: str, release: int, error: int | None) -> None:
    """The consumer gave the resource back while the news of its loss was on the way."""
    if error is not None:
        draft.fire(name, R, (release, error), ())


def hardware(
    draft: Draft, resource: Hardware, contended: bool, news: int | None = None, crossing: bool = True
) -> Access:
    """A sensor or actuator (figure 6): free, busy, or out of service.

    contended: more than one activity takes it, so that it can be found busy. news: filled when it recovers. crossing:
    whether a release can cross an error; it cannot where the resource stands alone (figure 10).
    """
    name = resource.name
    free, busy = draft.place(name, "free", marked=True, unit=name), draft.place(name, "busy", unit=name)
    out = failing_free = failing_busy = 0
    if resource.may_fail:
        out = draft.place(name, "OOS", unit=name)
        failing_free = draft.place(name, "failingF", transient=True, unit=name)
        failing_busy = draft.place(name, "failingB", transient=True, unit=name)
    available, take, answer, release, error = _access(draft, name, error=resource.may_fail)
    draft.fire(f"{name}.take!", R, (take, free), (answer, busy))
    draft.fire(f"{name}.release!", R, (release, busy), (free, available))
    if resource.may_fail and error is not None:
        loss = Event(f"{name}_EV_OOS", EventKind.LOST, name)
        draft.lost.append((out, name))
        draft.fire(f"{name}.oos_free", Level.EVENT, (free,), (failing_free,), event=loss)
        draft.fire(f"{name}.fail_free", R, (failing_free, available), (out,))
        draft.fire(f"{name}.oos_busy", Level.EVENT, (busy,), (failing_busy,), event=loss)
        draft.fire(f"{name}.fail_busy", R, (failing_busy,), (out, error))
        if resource.may_recover:
            back = Event(f"{name}_EV_RD", EventKind.RECOVERED, name)
            told = () if news is None else (news,)
            draft.fire(f"{name}.rd", Level.EVENT, (out,), (free, available, *told), event=back)
        if crossing:
            _crossing(draft, f"{name}.cross", release, error)
    refusals = ((out,) if resource.may_fail else ()) + ((busy,) if contended else ())
    return Access(available, take, answer, release, error, None, refusals)


def exclusive(draft: Draft, resource: Software, contended: bool) -> tuple[Product, Access]:
    """A software resource with one consumer at a time (figure 7), and `ack`: the producer waits until it is gone."""
    name = resource.name
    off = draft.place(name, "notAvailable", marked=True, unit=name)
    free, busy = draft.place(name, "free", unit=name), draft.place(name, "busy", unit=name)
    waiting = draft.place(name, "waiting", transient=True, unit=name)
    activation = draft.place(name, "activation", transient=True)
    deactivation = draft.place(name, "deactivation", transient=True)
    ack = draft.place(name, "ack", transient=True)
    demand = asking(draft, name)
    available, take, answer, release, error = _access(draft, name)
    refused = draft.place(name, "refused", transient=True)
    assert error is not None
    draft.fire(f"{name}.take_start", R, (take, off, demand.unasked), (waiting, demand.asked))
    draft.fire(f"{name}.take_free", R, (take, free, demand.unasked), (answer, busy, demand.asked))
    draft.fire(f"{name}.act_wait", R, (activation, waiting), (answer, busy))
    draft.fire(f"{name}.act_off", R, (activation, off), (free,))
    draft.fire(f"{name}.act_free", R, (activation,), (), reads=(free,))
    draft.fire(f"{name}.act_busy", R, (activation,), (), reads=(busy,))
    quiet = (off, available, demand.unasked)
    draft.fire(f"{name}.deact_wait", R, (deactivation, waiting, demand.asked), (*quiet, refused, ack))
    draft.fire(f"{name}.deact_busy", R, (deactivation, busy, demand.asked), (*quiet, error, ack))
    draft.fire(f"{name}.deact_free", R, (deactivation, free), (off, ack))
    draft.fire(f"{name}.deact_off", R, (deactivation,), (ack,), reads=(off,))
    draft.fire(f"{name}.release!", R, (release, busy, demand.asked), (free, available, demand.unasked))
    _crossing(draft, f"{name}.cross", release, error)
    refusal = Refusal((waiting, demand.asked), (*quiet, refused))
    access = Access(available, take, answer, release, error, refused, (busy,) if contended else ())
    return Product(activation, deactivation, ack, (demand,), (refusal,)), access


def shared(draft: Draft, resource: Software, consumers: tuple[str, ...]) -> tuple[Product, dict[str, Access]]:
    """A software resource for any number of consumers: each has an interface and a demand of its own.

    Where the producer stops it, a token passes from consumer to consumer, takes from each what it has or waits for,
    and ends as `ack`.
    """
    name = resource.name
    off, on = draft.place(name, "notAvailable", marked=True, unit=name), draft.place(name, "on", unit=name)
    activation = draft.place(name, "activation", transient=True)
    deactivation = draft.place(name, "deactivation", transient=True)
    ack = draft.place(name, "ack", transient=True)
    draft.fire(f"{name}.act_off", R, (activation, off), (on,))
    draft.fire(f"{name}.act_on", R, (activation,), (), reads=(on,))
    telling = [draft.place(name, f"tell{index}", transient=True) for index in range(len(consumers))] + [ack]
    draft.fire(f"{name}.deact_on", R, (deactivation, on), (off, telling[0]))
    draft.fire(f"{name}.deact_off", R, (deactivation,), (telling[0],), reads=(off,))
    accesses: dict[str, Access] = {}
    demands, refusals = [], []
    for index, consumer in enumerate(consumers):
        suffix = f"({consumer})"
        waiting = draft.place(name, f"waiting{suffix}", transient=True)
        busy = draft.place(name, f"busy{suffix}")
        demand = asking(draft, name, suffix)
        available, take, answer, release, error = _access(draft, name, suffix)
        refused = draft.place(name, f"refused{suffix}", transient=True)
        assert error is not None
        here, onward = telling[index], telling[index + 1]
        quiet = (available, demand.unasked)
        draft.fire(f"{name}.take_off{suffix}", R, (take, demand.unasked), (waiting, demand.asked), reads=(off,))
        draft.fire(f"{name}.take_on{suffix}", R, (take, demand.unasked), (answer, busy, demand.asked), reads=(on,))
        draft.fire(f"{name}.wake{suffix}", R, (waiting,), (answer, busy), reads=(on,))
        draft.fire(f"{name}.release!{suffix}", R, (release, busy, demand.asked), (available, demand.unasked))
        draft.fire(f"{name}.tell_wait{suffix}", R, (here, waiting, demand.asked), (*quiet, refused, onward))
        draft.fire(f"{name}.tell_busy{suffix}", R, (here, busy, demand.asked), (*quiet, error, onward))
        draft.fire(f"{name}.tell_none{suffix}", R, (here,), (onward,), reads=(demand.unasked,))
        _crossing(draft, f"{name}.cross{suffix}", release, error)
        demands.append(demand)
        refusals.append(Refusal((waiting, demand.asked), (*quiet, refused)))
        accesses[consumer] = Access(available, take, answer, release, error, refused, ())
    return Product(activation, deactivation, ack, tuple(demands), tuple(refusals)), accesses
