"""Templates of objectives, parallel blocks and the mission (mission paper, section 6.3, figures 3 and 9).

Each block is written between three places: its entry, and what it fills on success and on failure.
"""

from __future__ import annotations

from collections.abc import Mapping

from mauve.mission.activities import Parts
from mauve.mission.draft import Draft
from mauve.mission.flatten import Fork, Leaf, Link, Node, Series, leaves, short_names
from mauve.mission.net import Event, EventKind, Level
from mauve.mission.plan import Continue, Recover, Retry
from mauve.records import record

M = Level.MISSION


@record
class _Between:
    """What a block is written between."""

    entry: int
    ok: int
    fail: int


@record
class _Context:
    draft: Draft
    parts: Mapping[str, Parts]
    names: Mapping[str, str]


def mission_template(
    draft: Draft, root: Series, parts: Mapping[str, Parts], stems: Mapping[str, str] | None = None
) -> None:
    """The mission around its root: it starts on MISSION_EV_START, and ends in success or failure."""
    names = short_names(tuple(leaf.path for leaf in leaves(root))) if stems is None else stems
    initial = draft.place("", "MISSION_initial", marked=True)
    success, failure = draft.place("", "MISSION_success"), draft.place("", "MISSION_failure")
    draft.outcomes.extend([(success, "success"), (failure, "failure")])
    entry = draft.place("", "entry", transient=True)
    start = Event("MISSION_EV_START", EventKind.START)
    draft.fire("MISSION_start", Level.EVENT, (initial,), (entry,), event=start)
    _node(_Context(draft, parts, names), root, _Between(entry, success, failure))


def _node(context: _Context, node: Node, between: _Between) -> None:
    match node:
        case Leaf():
            _elementary(context, node, between)
        case Series():
            _series(context, node, between)
        case Fork():
            _fork(context, node, between)


def _elementary(context: _Context, leaf: Leaf, between: _Between) -> None:
    """Asks for its activities while it is pursued; its end is an event, also when one of them has failed."""
    draft, path = context.draft, leaf.path
    demands = [context.parts[name].demands[slot] for name, slot in leaf.slots]
    asked, unasked = [one.asked for one in demands], [one.unasked for one in demands]
    failures = [(name, place) for name, _ in leaf.slots if (place := context.parts[name].failed) is not None]
    active = draft.place(path, "active")
    draft.objectives.append((active, path))
    draft.fire(f"{path}.enter", M, (between.entry, *unasked), (active, *asked))
    stem = context.names[path]

    def ends(source: int, kind: EventKind, target: int, suffix: str = "") -> None:
        event = Event(f"{stem}_{kind.value}", kind, path)
        name = f"{path}.{kind.name.lower()}{suffix}"
        draft.fire(name, Level.EVENT, (source, *asked), (target, *unasked), event=event)

    timed = leaf.objective.timeout is not None
    ends(active, EventKind.OK, between.ok)
    ends(active, EventKind.FAIL, between.fail)
    if timed:
        ends(active, EventKind.TIMEOUT, between.fail)
    if failures:
        error = draft.place(path, "in_error")
        draft.objectives.append((error, path))
        for name, failed in failures:
            draft.fire(f"{path}.error({name})", M, (active,), (error,), reads=(failed,))
        ends(error, EventKind.FAIL, between.fail, "_error")
        if timed:
            ends(error, EventKind.TIMEOUT, between.fail, "_error")


def _series(context: _Context, series: Series, between: _Between) -> None:
    draft = context.draft
    if not series.links:
        draft.fire(f"{series.path}.nothing", M, (between.entry,), (between.ok,))
        return
    entry = between.entry
    for index, link in enumerate(series.links):
        last = index + 1 == len(series.links)
        ok = between.ok if last else draft.place(series.path, f"then{index + 1}", transient=True)
        _link(context, link, _Between(entry, ok, between.fail))
        entry = ok


def _link(context: _Context, link: Link, between: _Between) -> None:
    """A step, with what its failure means."""
    draft, path = context.draft, link.node.path
    match link.step.on_failure:
        case Continue():
            _node(context, link.node, _Between(between.entry, between.ok, between.ok))
        case Retry(times) if times > 0:
            _retry(context, link, times, between)
        case Recover(_, resume) if link.recovery is not None:
            lost = draft.place(path, "recover", transient=True)
            _node(context, link.node, _Between(between.entry, between.ok, lost))
            _series(context, link.recovery, _Between(lost, between.ok if resume else between.fail, between.fail))
        case _:
            _node(context, link.node, between)


def _retry(context: _Context, link: Link, times: int, between: _Between) -> None:
    """A counter of the failures so far sends each back to the entry, until there were too many."""
    draft, path = context.draft, link.node.path
    tries = [draft.place(path, f"try{index + 1}", marked=index == 0, unit=f"{path}.try") for index in range(times + 1)]
    done, lost = draft.place(path, "done", transient=True), draft.place(path, "lost", transient=True)
    for index, here in enumerate(tries):
        draft.fire(f"{path}.done{index + 1}", M, (done, here), (between.ok, tries[0]))
        after = (between.entry, tries[index + 1]) if index < times else (between.fail, tries[0])
        draft.fire(f"{path}.retry{index + 1}", M, (lost, here), after)
    _node(context, link.node, _Between(between.entry, done, lost))


def _fork(context: _Context, fork: Fork, between: _Between) -> None:
    """All children are entered together, and their results collected in the order written, as a chain.

    A result that comes before its turn waits. Once a mandatory child has failed, only the end of the others is awaited.
    """
    draft, path = context.draft, fork.path
    if not fork.children:
        draft.fire(f"{path}.nothing", M, (between.entry,), (between.ok,))
        return
    entries = [draft.place(path, f"fork{index + 1}", transient=True) for index in range(len(fork.children))]
    good = draft.place(path, "join1")
    bad: int | None = None
    draft.fire(f"{path}.fork", M, (between.entry,), (*entries, good))
    for index, (link, mandatory) in enumerate(fork.children):
        last = index + 1 == len(fork.children)
        ok = draft.place(path, f"ok{index + 1}")
        ko = draft.place(path, f"ko{index + 1}") if mandatory else ok
        next_good = between.ok if last else draft.place(path, f"join{index + 2}")
        spoils = bad is not None or mandatory
        next_bad = between.fail if last else draft.place(path, f"broken{index + 2}") if spoils else None
        draft.fire(f"{path}.join_ok{index + 1}", M, (good, ok), (next_good,))
        if mandatory and next_bad is not None:
            draft.fire(f"{path}.join_ko{index + 1}", M, (good, ko), (next_bad,))
        if bad is not None and next_bad is not None:
            draft.fire(f"{path}.broken_ok{index + 1}", M, (bad, ok), (next_bad,))
            if mandatory:
                draft.fire(f"{path}.broken_ko{index + 1}", M, (bad, ko), (next_bad,))
        _link(context, link, _Between(entries[index], ok, ko))
        good, bad = next_good, next_bad if spoils else None
