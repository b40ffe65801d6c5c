"""The simulation of one processor: fixed priorities, from event to event in exact integers.

At one instant work ends before new jobs are released, and then the most urgent ready job runs. A job without any work
ends at the first instant at which no other ready job goes before it. Jobs of one task run one after the other, in the
order of their arrivals. A critical section is entered when its first piece is executed; under the immediate ceiling
protocol its holder then runs at the greatest priority of the tasks that use what it holds, and before equals.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from heapq import heappop, heappush
from random import Random

from mauve.timing.simulation.choices import Piece, Plan, arrivals, generator, plans
from mauve.timing.simulation.horizon import busy_period
from mauve.timing.simulation.outcome import Activity, Job, Measures, Outcome, Segment
from mauve.timing.simulation.system import Order, Processor, Protocol, Settings, SimTask
from mauve.timing.task import Kind, Task


class _Job:
    """A released job. `priority` is the one it competes with, `held` the number of the section it is in (-1: it may
    not be preempted); `left` is what is left of the piece `pieces[at]`."""

    __slots__ = (
        "arrival", "at", "blocked", "deadline", "done", "held", "left", "mode", "number", "pieces", "preemptions",
        "priority", "release", "start", "tie", "track",
    )  # fmt: skip

    def __init__(self, track: _Track, number: int, arrival: int, release: int) -> None:
        self.track, self.number, self.arrival, self.release = track, number, arrival, release
        self.deadline = arrival + track.task.deadline
        self.pieces: tuple[Piece, ...] = ()
        self.at = self.left = self.held = self.preemptions = self.blocked = self.done = 0
        self.start: int | None = None
        self.mode = ""
        self.priority = track.task.priority
        self.tie = 0.0

    def key(self) -> tuple[int, bool, float, int]:
        """Its place among ready jobs, least first."""
        return -self.priority, self.held == 0, self.tie, self.track.index


class _Track:
    """A task while it is simulated: its coming arrivals, its waiting jobs (the first is ready or runs), its sums."""

    __slots__ = (
        "arrivals", "blocked", "busy", "finished", "greatest", "index", "least", "misses", "name_rank", "one", "plans",
        "preemptions", "queue", "released", "task", "total", "worst",
    )  # fmt: skip

    def __init__(self, one: SimTask, index: int, name_rank: int) -> None:
        self.one, self.task, self.index, self.name_rank = one, one.task, index, name_rank
        self.arrivals: Iterator[tuple[int, int]] = iter(())
        self.plans: Iterator[Plan] = iter(())
        self.queue: deque[_Job] = deque()
        self.released = self.finished = self.total = self.preemptions = self.misses = self.blocked = self.busy = 0
        self.greatest: int | None = None
        self.least: int | None = None
        self.worst: _Job | None = None

    def measures(self) -> Measures:
        """What was seen of the task."""
        task, worst = self.task, self.worst
        return Measures(
            task.name, task.kind, task.priority, task.period, task.deadline, self.released, self.finished,
            self.greatest, self.least, self.total, worst.number if worst else None, worst.arrival if worst else None,
            self.preemptions, self.misses, self.blocked, self.busy,
        )  # fmt: skip


def simulate(processor: Processor, settings: Settings) -> Outcome:
    """Run the tasks of a processor. Ends at `settings.length` or after `settings.events` events, whatever the load."""
    return _Run(processor, settings).run()


class _Run:
    """One simulation under way."""

    def __init__(self, processor: Processor, settings: Settings) -> None:
        self.processor, self.settings = processor, settings
        self.now = self.events = self.busy = self.switches = self.preemptions = 0
        self.window = settings.window or (0, settings.length)
        self.ready: list[tuple[tuple[int, bool, float, int], _Job]] = []
        self.running: _Job | None = None
        self.last: _Job | None = None
        self.since = 0
        self.yielded = False
        self.jobs: list[Job] = []
        self.segments: list[Segment] = []
        self.waits: list[Segment] = []
        self.choice = generator(settings, processor.name, "order")
        protected = settings.protocol is not Protocol.NONE
        self.protected, self.ceilings = protected, processor.ceilings()
        self.eager = settings.protocol is Protocol.EAGER
        self.top = max((one.task.priority for one in processor.tasks if one.task.kind is Kind.TASK), default=0)
        self.tracks = self._tracks()
        # Time, whether it is a release (an answer comes before), the task, the arrival.
        self.coming: list[tuple[int, bool, int, int]] = []
        for track in self.tracks:
            self._expect(track)

    def _tracks(self) -> list[_Track]:
        tasks = [one.task for one in self.processor.tasks]
        names = {name: rank for rank, name in enumerate(sorted(task.name for task in tasks))}
        length = busy_period(tasks, max(1, self.settings.length)) if tasks else 1
        tracks = []
        for index, one in enumerate(self.processor.tasks):
            task = one.task
            track = _Track(one, index, names[task.name])
            lengths = [-(-(length + task.jitter) // (part.period or task.period)) for part in task.work]
            track.arrivals = arrivals(one, self.settings, self._random(task, "arrivals"))
            track.plans = plans(one, self.settings, lengths, self._random(task, "work"))
            tracks.append(track)
        return tracks

    def _random(self, task: Task, purpose: str) -> Random:
        return generator(self.settings, self.processor.name, task.name, purpose)

    # ------------------------------------------------------------------------------------------------------ events
    def run(self) -> Outcome:
        """From event to event to the end."""
        end = self.settings.length
        while True:
            running = self.running
            then = self.coming[0][0] if self.coming else end
            if running is not None and self.now + running.left <= then:
                then = self.now + running.left
            if then > end or self.events >= self.settings.events:
                break
            self.events += 1
            if then > self.now:
                self._advance(then)
            if running is not None and running.left == 0:
                self._piece_ended(running)
                self._finish_empty()
            if then >= end:
                break
            self._release()
            self._dispatch()
        cut = self.events >= self.settings.events and self.now < end
        if not cut and self.now < end:
            self._advance(end)
        return self._outcome(cut)

    def _advance(self, then: int) -> None:
        """Let the running job run."""
        job, passed = self.running, then - self.now
        self.now = then
        if job is None:
            return
        job.left -= passed
        job.done += passed
        job.track.busy += passed
        self.busy += passed
        own = job.track.task.priority
        if job.priority > own:
            for _, other in self.ready:
                if own < other.track.task.priority <= job.priority:
                    other.blocked += passed

    def _expect(self, track: _Track) -> None:
        """Note the next release of a task."""
        arrival, release = next(track.arrivals)
        heappush(self.coming, (release, True, track.index, arrival))

    def _release(self) -> None:
        while self.coming and self.coming[0][0] <= self.now:
            release, new, index, arrival = heappop(self.coming)
            track = self.tracks[index]
            if not new:
                self._resume(track.queue[0])
                continue
            track.released += 1
            job = _Job(track, track.released, arrival, release)
            track.queue.append(job)
            if len(track.queue) == 1:
                self._make_ready(job)
            self._expect(track)

    def _make_ready(self, job: _Job) -> None:
        """A job that is the first of its task: plan it, and let it compete."""
        job.mode, job.pieces = next(job.track.plans)
        job.left = job.pieces[0].length if job.pieces else 0
        job.tie = self._tie(job)
        if self.eager:
            job.priority = max(job.track.task.priority, self._ceiling(job))
        heappush(self.ready, (job.key(), job))

    def _tie(self, job: _Job) -> float:
        match self.settings.order:
            case Order.FIFO:
                return job.release
            case Order.DECLARED:
                return job.track.index
            case Order.NAME:
                return job.track.name_rank
            case Order.RANDOM:
                return self.choice.random()

    def _ceiling(self, job: _Job) -> int:
        """The ceiling of what the current piece holds; -1 for nothing."""
        if job.at >= len(job.pieces):
            return -1
        piece = job.pieces[job.at]
        if piece.above_all:
            return self.top
        return max((self.ceilings[name] for name in piece.resources), default=-1)

    def _piece_ended(self, job: _Job) -> None:
        """Go on to the next piece; leave the section unless that is in it, too; finish after the last."""
        self._close(job)
        job.at += 1
        if job.at >= len(job.pieces):
            self._finish(job)
            return
        piece = job.pieces[job.at]
        job.left = piece.length
        if job.held > 0 and piece.section != job.held:
            job.held = 0
            job.priority = job.track.task.priority
        if self.eager and job.held == 0:
            job.priority = max(job.track.task.priority, self._ceiling(job))

    def _finish(self, job: _Job) -> None:
        track = job.track
        track.queue.popleft()
        response = self.now - job.arrival
        track.finished += 1
        track.total += response
        if track.least is None or response < track.least:
            track.least = response
        if track.greatest is None or response > track.greatest:
            track.greatest, track.worst = response, job
        self._account(job, self.now)
        if self.running is job:
            self.running = None
        if track.queue:
            self._make_ready(track.queue[0])

    def _finish_empty(self) -> None:
        """Jobs without work end as soon as nothing goes before them."""
        while self.running is None and self.ready and not self.ready[0][1].pieces:
            _, job = heappop(self.ready)
            job.start = self.now
            self._finish(job)

    def _account(self, job: _Job, finish: int | None) -> None:
        track = job.track
        late = (self.now + 1 if finish is None else finish) > job.deadline
        track.misses += late
        track.blocked = max(track.blocked, job.blocked)
        start, end = self.window
        if (job.release < end and (finish is None or finish >= start)) or (late and start <= job.deadline < end):
            self.jobs.append(
                Job(
                    track.task.name, job.number, job.arrival, job.release, job.deadline, job.start, finish,
                    job.preemptions, job.blocked, job.done, job.mode,
                )
            )  # fmt: skip

    # ---------------------------------------------------------------------------------------------------- dispatch
    def _dispatch(self) -> None:
        """Let the most urgent ready job run; one that starts to wait makes way at once."""
        self._choose()
        while self.running is None and self.ready:
            self._choose()

    def _choose(self) -> None:
        self._finish_empty()
        running = self.running
        if running is not None and self.ready and self._goes_before(self.ready[0][1], running):
            self._close(running)
            if self.settings.order is Order.RANDOM:
                running.tie = self.choice.random()
            heappush(self.ready, (running.key(), running))
            self.running = None
            self._finish_empty()
        if self.running is None and self.ready:
            self._start(heappop(self.ready)[1])
        elif self.running is not None:
            self._enter(self.running)

    def _goes_before(self, job: _Job, running: _Job) -> bool:
        if job.priority != running.priority:
            return job.priority > running.priority
        if running.held or self.settings.order is Order.FIFO:
            return False
        return job.key() < running.key()

    def _start(self, job: _Job) -> None:
        """Give the processor to a job."""
        self.running, self.since = job, self.now
        if job.start is None:
            job.start = self.now
        if job.track.task.kind is Kind.TASK:
            last = self.last
            if last is None or last.track is not job.track:
                self.switches += 1
                if last is not None and last.at < len(last.pieces) and not self.yielded:
                    last.preemptions += 1
                    last.track.preemptions += 1
                    self.preemptions += 1
            self.last, self.yielded = job, False
        self._enter(job)

    def _enter(self, job: _Job) -> None:
        """Enter the section of the piece that starts now; a job that may not be preempted holds the processor."""
        task, piece = job.track.task, job.pieces[job.at]
        if piece.wait:
            self._suspend(job)
        elif piece.tail or not task.preemptive:
            job.held, job.priority = -1, max(task.priority, self.top)
        elif piece.section and job.held == 0 and self.protected:
            job.held, job.priority = piece.section, max(task.priority, self._ceiling(job))

    def _suspend(self, job: _Job) -> None:
        """Take a job that waits off the processor until its answer comes."""
        end = self.now + job.left
        start_shown, end_shown = self.window
        if self.now < end_shown and end > start_shown:
            label = job.pieces[job.at].label
            self.waits.append(Segment(job.track.task.name, job.number, self.now, end, Activity.WAIT, label))
        heappush(self.coming, (end, False, job.track.index, 0))
        self.running, self.yielded = None, True

    def _resume(self, job: _Job) -> None:
        """Let a job compete again, or end, where the wait was the last that it did."""
        job.at += 1
        if job.at >= len(job.pieces):
            self._finish(job)
            return
        job.left = job.pieces[job.at].length
        heappush(self.ready, (job.key(), job))

    def _close(self, job: _Job) -> None:
        """Note the segment that ends now, where it is to be kept."""
        start, end = self.window
        if self.now > self.since and self.since < end and self.now > start:
            piece = job.pieces[job.at]
            activity = Activity.SWITCH if piece.switch else Activity.SECTION if piece.section else Activity.WORK
            self.segments.append(
                Segment(job.track.task.name, job.number, self.since, self.now, activity, piece.label, piece.resources)
            )
        self.since = self.now

    def _outcome(self, cut: bool) -> Outcome:
        if self.running is not None:
            self._close(self.running)
        for track in self.tracks:
            for job in track.queue:
                self._account(job, None)
        return Outcome(
            self.processor, self.settings, self.now, cut, self.events, tuple(track.measures() for track in self.tracks),
            tuple(self.jobs), tuple(self.segments), self.busy, self.switches, self.preemptions, tuple(self.waits),
        )  # fmt: skip
