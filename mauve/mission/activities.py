"""Template of activities (mission paper, section 6.2): evaluation, reservation, running, stop, failure.

An activity evaluates its alternatives in falling priority. One is selected if all it consumes may be requested; then
it asks for all of it, and collects answers and refusals in the order written. What it holds when one is refused, or
when something is lost, it gives back; what it produces stays up while it evaluates again, so that its consumers
notice nothing where another alternative takes over.
"""

from __future__ import annotations

from collections.abc import Mapping

from mauve.mission.draft import Draft
from mauve.mission.net import Level
from mauve.mission.plan import Activity, Alternative
from mauve.mission.resources import Access, Demand, Product, asking
from mauve.records import record

R = Level.RESOURCE


@record
class Parts:
    """What the rest of the net needs to know of an activity.

    demands: of the objectives that can ask for it at one time; failed: None where it never fails; runs: the place of
    each alternative; restarts: what each alternative gives back to evaluate again.
    """

    demands: tuple[Demand, ...]
    failed: int | None
    idle: int
    first: int
    runs: tuple[int, ...]
    restarts: tuple[tuple[int, ...], ...]


@record
class _Shape:
    """The places of an activity while its transitions are written."""

    activity: Activity
    alternatives: tuple[Alternative, ...]
    accesses: Mapping[str, Access]
    products: Mapping[str, Product]
    demands: tuple[Demand, ...]
    idle: int
    evaluations: tuple[int, ...]
    closing: int
    closing_failed: int | None
    failed: int | None
    runs: tuple[int, ...]


def reachable(activity: Activity) -> tuple[Alternative, ...]:
    """The alternatives down to the first that consumes nothing: it is always taken, and none after it."""
    for index, alternative in enumerate(activity.alternatives):
        if not alternative.consumes:
            return activity.alternatives[: index + 1]
    return activity.alternatives


def can_fail(activity: Activity) -> bool:
    """Whether it can be left without an alternative."""
    return all(alternative.consumes for alternative in activity.alternatives)


def activity_template(
    draft: Draft,
    activity: Activity,
    slots: int,
    accesses: Mapping[str, Access],
    products: Mapping[str, Product],
) -> Parts:
    """The net of an activity that at most `slots` objectives ask for at a time; accesses and products by resource."""
    name = activity.name
    alternatives = reachable(activity)
    fails = can_fail(activity)
    demands = tuple(asking(draft, name, _nth(slot)) for slot in range(slots))
    idle = draft.place(name, "idle", marked=True, unit=name)
    evaluations = tuple(
        draft.place(name, f"eval{index + 1}", transient=True, unit=name) for index in range(len(alternatives) + fails)
    )
    closing = draft.place(name, "closing", transient=True, unit=name)
    reports = fails and slots > 0
    closing_failed = draft.place(name, "closingF", transient=True, unit=name) if reports else None
    failed = draft.place(name, "failed", unit=name) if reports else None
    runs = tuple(draft.place(name, f"{alternative.name}.run", unit=name) for alternative in alternatives)
    draft.running.extend((place, name, one.name) for place, one in zip(runs, alternatives, strict=True))
    if failed is not None:
        draft.failed.append((failed, name))
    shape = _Shape(
        activity, alternatives, accesses, products, demands, idle, evaluations, closing, closing_failed, failed, runs
    )
    _starts(draft, shape)
    for index in range(len(alternatives)):
        _alternative(draft, shape, index)
    _stops(draft, shape)
    if fails:
        _failure(draft, shape)
    restarts = tuple(
        tuple(accesses[one].release for one in dict.fromkeys(alternative.consumes)) for alternative in alternatives
    )
    return Parts(demands, failed, idle, evaluations[0], runs, restarts)


def _nth(slot: int) -> str:
    return "" if slot == 0 else f"#{slot + 1}"


def _all_demands(shape: _Shape) -> tuple[Demand, ...]:
    return (*shape.demands, *(demand for product in shape.products.values() for demand in product.demands))


def _starts(draft: Draft, shape: _Shape) -> None:
    for index, demand in enumerate(_all_demands(shape)):
        name = f"{shape.activity.name}.start{index + 1}"
        draft.fire(name, R, (shape.idle,), (shape.evaluations[0],), reads=(demand.asked,))


def _alternative(draft: Draft, shape: _Shape, index: int) -> None:
    """Selection, the two chains that collect the answers, and what happens when something held is lost."""
    alternative = shape.alternatives[index]
    owner = shape.activity.name
    name = f"{owner}.{alternative.name}"
    accesses = [shape.accesses[one] for one in dict.fromkeys(alternative.consumes)]
    consumed = list(dict.fromkeys(alternative.consumes))
    here = shape.evaluations[index]
    running = _entering(draft, shape, index)
    if not accesses:
        draft.fire(f"{name}.select", Level.CHOICE, (here,), running)
        return
    good = [
        draft.place(owner, f"{alternative.name}.good{j + 1}", transient=True, unit=owner) for j in range(len(accesses))
    ]
    before, after = (here, *(one.available for one in accesses)), (good[0], *(one.take for one in accesses))
    draft.fire(f"{name}.select", Level.CHOICE, before, after)
    onward = shape.evaluations[index + 1]
    named = list(zip(consumed, accesses, strict=True))
    for resource, access in named:
        for number, sign in enumerate(access.refusals):
            draft.fire(f"{name}.no{number + 1}({resource})", Level.CHOICE, (here,), (onward,), reads=(sign,))
        if access.error is not None:
            rest = (one.release for one in accesses if one is not access)
            gone = (shape.runs[index], access.error)
            draft.fire(f"{name}.lost({resource})", R, gone, (shape.evaluations[0], *rest))
    _collection(draft, owner, alternative.name, named, good, running, onward)


def _collection(
    draft: Draft,
    owner: str,
    alternative: str,
    named: list[tuple[str, Access]],
    good: list[int],
    running: tuple[int, ...],
    onward: int,
) -> None:
    """Collects the answers in order; after the first refusal the rest is collected to be given back."""
    name = f"{owner}.{alternative}"
    accesses = [access for _, access in named]
    bad: int | None = None
    for j, (resource, access) in enumerate(named):
        last = j + 1 == len(named)
        draft.fire(f"{name}.ok({resource})", R, (good[j], access.answer), running if last else (good[j + 1],))
        if access.refused is None and bad is None:
            continue
        target = onward
        if not last:
            target = draft.place(owner, f"{alternative}.bad{j + 2}", transient=True, unit=owner)
        if access.refused is not None:
            back = (one.release for one in accesses[:j])
            draft.fire(f"{name}.refused({resource})", R, (good[j], access.refused), (target, *back))
        if bad is not None:
            draft.fire(f"{name}.return({resource})", R, (bad, access.answer), (target, access.release))
            if access.refused is not None:
                draft.fire(f"{name}.refused2({resource})", R, (bad, access.refused), (target,))
        bad = target


def _entering(draft: Draft, shape: _Shape, index: int) -> tuple[int, ...]:
    """What is filled when an alternative has all it consumes: its products go up, those of the others down."""
    alternative = shape.alternatives[index]
    owner = shape.activity.name
    name = f"{owner}.{alternative.name}"
    offered = [product for one, product in shape.products.items() if one in alternative.produces]
    withdrawn = {one: product for one, product in shape.products.items() if one not in alternative.produces}
    up = tuple(product.activation for product in offered)
    if not withdrawn:
        return (shape.runs[index], *up)
    settling = draft.place(owner, f"{alternative.name}.settling", transient=True, unit=owner)
    draft.fire(f"{name}.settled", R, (settling, *(one.ack for one in withdrawn.values())), (shape.runs[index],))
    for one, product in withdrawn.items():
        for number, refusal in enumerate(product.refusals):
            label = f"{name}.refuse({one}){_nth(number)}"
            draft.fire(label, R, refusal.before, refusal.after, reads=(shape.runs[index],))
    return (settling, *up, *(one.deactivation for one in withdrawn.values()))


def _stops(draft: Draft, shape: _Shape) -> None:
    """Nobody asks any more: give back what is held, end what is offered, and be idle once that is gone."""
    down = tuple(product.deactivation for product in shape.products.values())
    gone = tuple(product.ack for product in shape.products.values())
    unasked = tuple(demand.unasked for demand in _all_demands(shape))
    for index, alternative in enumerate(shape.alternatives):
        back = (shape.accesses[one].release for one in dict.fromkeys(alternative.consumes))
        name = f"{shape.activity.name}.{alternative.name}.stop"
        draft.fire(name, Level.STOP, (shape.runs[index],), (shape.closing, *back, *down), reads=unasked)
    draft.fire(f"{shape.activity.name}.closed", R, (shape.closing, *gone), (shape.idle,))


def _failure(draft: Draft, shape: _Shape) -> None:
    """No alternative is left: refuse all requests, and, if an objective asked, stay failed until none asks."""
    name = shape.activity.name
    last = shape.evaluations[-1]
    down = tuple(product.deactivation for product in shape.products.values())
    gone = tuple(product.ack for product in shape.products.values())
    unasked = tuple(demand.unasked for demand in shape.demands)
    draft.fire(f"{name}.none", R, (last,), (shape.closing, *down), reads=unasked)
    if shape.failed is None or shape.closing_failed is None:
        return
    for slot, demand in enumerate(shape.demands):
        label = f"{name}.none_failed{_nth(slot)}"
        draft.fire(label, R, (last,), (shape.closing_failed, *down), reads=(demand.asked,))
    draft.fire(f"{name}.closedF", R, (shape.closing_failed, *gone), (shape.failed,))
    draft.fire(f"{name}.down", R, (shape.failed,), (shape.idle,), reads=unasked)
    for one, product in shape.products.items():
        for number, refusal in enumerate(product.refusals):
            label = f"{name}.refuse({one}){_nth(number)}"
            draft.fire(label, R, refusal.before, refusal.after, reads=(shape.failed,))
