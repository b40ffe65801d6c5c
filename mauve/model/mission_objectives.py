"""Objectives spread out into one tree per mission: each use of an objective is replaced by what it stands for
(mission paper, section 5.1)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.missions import (
    Abort,
    Block,
    Child,
    Continue,
    Elementary,
    OnFailure,
    Parallel,
    Recover,
    Ref,
    Retry,
    Step,
)
from mauve.model.missions import Sequence as Steps
from mauve.model.names import unknown
from mauve.source import Span
from mauve.syntax.ast import missions as written
from mauve.syntax.quantities import time_of

MOST_OBJECTIVES = 5_000
"""Elementary objectives of one mission, each counted at every place it stands."""

DEEPEST_BLOCK = 60
"""Objectives in objectives in one mission; later passes follow the tree by recursion."""

MOST_RETRIES = 100


class Tree:
    """Builds the trees of missions. `broken` are the objectives in error, which are left out wherever they stand."""

    def __init__(
        self, objectives: Mapping[str, written.ObjectiveDecl], activities: Mapping[str, Span], report: Report
    ) -> None:
        self._objectives = objectives
        self._activities = activities
        self._report = report
        self._made: dict[str, Block] = {}
        self._unnamed = 0
        self.broken = self._find_broken()
        self._sizes: dict[str, tuple[int, int]] = {}

    def root(self, name: str, sequence: written.SequenceDecl, span: Span) -> Steps | None:
        """The tree of a mission; None where a part of it is in error."""
        if any(use.name.text in self.broken for use in uses(sequence)):
            return None
        count, depth = self._measure(sequence)
        if count > MOST_OBJECTIVES or depth > DEEPEST_BLOCK:
            much = f"{count} objectives" if count > MOST_OBJECTIVES else f"blocks nested {depth} deep"
            message = f"the mission `{name}` has {much}, which is too much"
            self._report.add(Diagnostic("MV008", message, Label(span)))
            return None
        return self._sequence(name, sequence)

    # ---------------------------------------------------------------------------------------- what is in error
    def _find_broken(self) -> frozenset[str]:
        """Objectives that contain themselves, are empty, or use what does not exist, and those that use them."""
        broken = {name for name, decl in self._objectives.items() if not self._sound(decl)}
        broken |= self._cycles()
        grown = True
        while grown:
            more = {
                name
                for name, decl in self._objectives.items()
                if name not in broken
                and isinstance(decl.body, written.SequenceDecl)
                and any(use.name.text in broken or use.name.text not in self._objectives for use in uses(decl.body))
            }
            broken |= more
            grown = bool(more)
        return frozenset(broken)

    def _sound(self, decl: written.ObjectiveDecl) -> bool:
        if decl.body is None:
            message = f"the objective `{decl.name}` is empty"
            help_ = Fix("write what it `does`, or the objectives it consists of")
            self._report.add(Diagnostic("MV710", message, Label(decl.name.span), help=help_))
            return False
        if isinstance(decl.body, written.SequenceDecl):
            return self.check(decl.body)
        sound = True
        for name in decl.body.activities:
            if name.text not in self._activities:
                message = f"there is no activity `{name}`"
                self._report.add(
                    unknown("MV100", message, "not declared", name.span, self._activities, "an activity")
                )
                sound = False
        return sound

    def check(self, sequence: written.SequenceDecl) -> bool:
        """Whether a block uses declared objectives only, and every parallel block has a mandatory child."""
        sound = True
        for use in uses(sequence):
            name = use.name
            if name.text not in self._objectives:
                message = f"there is no objective `{name}`"
                if name.text in self._activities:
                    message = f"`{name}` is an activity, a step is an objective"
                known = {n: d.name.span for n, d in self._objectives.items()}
                self._report.add(unknown("MV100", message, "not declared", name.span, known, "an objective"))
                sound = False
        for parallel in parallels(sequence):
            if not any(child.mandatory for child in parallel.children):
                what = f"`{parallel.name}`" if parallel.name else "without a name"
                message = f"the parallel block {what} has no mandatory child: it could never fail, and never matter"
                span = parallel.name.span if parallel.name else parallel.span
                labels = tuple(Label(child.span, "optional") for child in parallel.children)
                help_ = Fix("make the child that the mission is about `mandatory`")
                self._report.add(Diagnostic("MV701", message, Label(span), labels=labels, help=help_))
                sound = False
        return sound

    def _cycles(self) -> set[str]:
        """Objectives on a cycle, each cycle reported once as a walk (MV712)."""
        done: set[str] = set()
        on_cycle: set[str] = set()
        for start in self._objectives:
            walk: list[written.UseDecl] = []
            names = [start]
            pending = [iter(self._uses(start))]
            while pending and start not in done:
                use = next(pending[-1], None)
                if use is None:
                    done.add(names.pop())
                    pending.pop()
                    if walk:
                        walk.pop()
                elif use.name.text in names:
                    at = names.index(use.name.text)
                    if not on_cycle & set(names[at:]):
                        self._cycle(names[at:], [*walk[at:], use])
                    on_cycle |= set(names[at:])
                elif use.name.text not in done and use.name.text in self._objectives:
                    names.append(use.name.text)
                    walk.append(use)
                    pending.append(iter(self._uses(use.name.text)))
        return on_cycle

    def _uses(self, name: str) -> Sequence[written.UseDecl]:
        body = self._objectives[name].body
        return tuple(uses(body)) if isinstance(body, written.SequenceDecl) else ()

    def _cycle(self, names: list[str], walk: list[written.UseDecl]) -> None:
        chain = " -> ".join(f"`{name}`" for name in [*names, names[0]])
        message = f"the objective `{names[0]}` contains itself: {chain}"
        labels = tuple(Label(use.span, f"`{name}` needs `{use.name}`") for name, use in zip(names, walk, strict=True))
        help_ = Fix("a step is repeated by `on failure retry`, not by naming the block around it")
        self._report.add(Diagnostic("MV712", message, labels[0], labels=labels[1:], help=help_))

    # ---------------------------------------------------------------------------------------- size
    def _measure(self, sequence: written.SequenceDecl) -> tuple[int, int]:
        """How many elementary objectives a block has, each use counted, and how deep it nests."""
        count, depth = 0, 0
        for use in uses(sequence):
            inner = self._sizes.get(use.name.text) or self._size(use.name.text)
            count, depth = count + inner[0], max(depth, inner[1])
        own = max((_levels(stage) for stage in sequence.stages), default=0)
        return count, depth + own + 1

    def _size(self, name: str) -> tuple[int, int]:
        """As `_measure`, of an objective; there is no cycle. Inner objectives first, without recursion."""
        open_ = [name]
        while open_:
            inner = {use.name.text for use in self._uses(open_[-1])} - self._sizes.keys()
            if inner:
                open_ += sorted(inner)
                continue
            current = open_.pop()
            body = self._objectives[current].body
            self._sizes[current] = self._measure(body) if isinstance(body, written.SequenceDecl) else (1, 1)
        return self._sizes[name]

    # ---------------------------------------------------------------------------------------- building
    def _sequence(self, name: str, sequence: written.SequenceDecl) -> Steps:
        return Steps(name, tuple(self._step(stage) for stage in sequence.stages), sequence.span)

    def _step(self, stage: written.StageDecl) -> Step:
        return Step(self._block(stage.body), self._on_failure(stage.on_failure), stage.span)

    def _block(self, body: written.UseDecl | written.ParallelDecl) -> Block:
        if isinstance(body, written.ParallelDecl):
            if body.name is None:
                self._unnamed += 1
            name = body.name.text if body.name else f"parallel{self._unnamed}"
            children = tuple(Child(self._step(child.stage), child.mandatory) for child in body.children)
            return Parallel(name, children, body.span)
        name = body.name.text
        if name not in self._made:
            self._made[name] = self._objective(self._objectives[name])
        return self._made[name]

    def _objective(self, decl: written.ObjectiveDecl) -> Block:
        name = decl.name
        if isinstance(decl.body, written.SequenceDecl):
            return Steps(name.text, self._sequence(name.text, decl.body).steps, name.span)
        assert decl.body is not None
        timeout = time_of(decl.body.timeout, self._report) if decl.body.timeout else None
        if timeout is not None and timeout <= 0 and decl.body.timeout is not None:
            self._report.add(Diagnostic("MV401", "a timeout is longer than 0", Label(decl.body.timeout.span)))
            timeout = None
        seen = {ref.text: Ref(ref.text, ref.span) for ref in reversed(decl.body.activities)}
        activities = tuple(seen[text] for text in dict.fromkeys(ref.text for ref in decl.body.activities))
        return Elementary(name.text, activities, timeout, name.span)

    def _on_failure(self, reaction: written.OnFailureDecl | None) -> OnFailure:
        match reaction:
            case written.ContinueDecl(span):
                return Continue(span)
            case written.RetryDecl(times, span):
                number = times.integer if times.is_integer else 0
                if not 1 <= number <= MOST_RETRIES:
                    message = f"a step is retried 1 to {MOST_RETRIES} times, not {times.text}"
                    self._report.add(Diagnostic("MV007", message, Label(times.span)))
                return Retry(min(max(1, number), MOST_RETRIES), span)
            case written.RecoverDecl(block, resume, span):
                return Recover(self._sequence("recovery", block), resume, span)
            case written.AbortDecl(span):
                return Abort(span)
            case None:
                return Abort()


def _stages(sequence: written.SequenceDecl) -> Iterator[written.StageDecl]:
    """All steps of a block, those of its parallel blocks and recoveries included; the text bounds their nesting."""
    open_ = list(reversed(sequence.stages))
    while open_:
        stage = open_.pop()
        yield stage
        if isinstance(stage.on_failure, written.RecoverDecl):
            open_ += reversed(stage.on_failure.block.stages)
        if isinstance(stage.body, written.ParallelDecl):
            open_ += [child.stage for child in reversed(stage.body.children)]


def uses(sequence: written.SequenceDecl) -> Iterator[written.UseDecl]:
    """The objectives that a block names, at any depth of its own text."""
    return (stage.body for stage in _stages(sequence) if isinstance(stage.body, written.UseDecl))


def parallels(sequence: written.SequenceDecl) -> Iterator[written.ParallelDecl]:
    """The parallel blocks written in a block."""
    return (stage.body for stage in _stages(sequence) if isinstance(stage.body, written.ParallelDecl))


def _levels(stage: written.StageDecl) -> int:
    """How deep a step nests blocks of its own text; brackets nest at most 64 deep."""
    children = stage.body.children if isinstance(stage.body, written.ParallelDecl) else ()
    inner = [_levels(child.stage) for child in children]
    if isinstance(stage.on_failure, written.RecoverDecl):
        inner += [_levels(each) for each in stage.on_failure.block.stages]
    return 1 + max(inner, default=0)
