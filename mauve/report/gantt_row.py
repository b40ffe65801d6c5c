"""The row of one task in a Gantt chart: its jobs with releases, deadlines, and where they run and wait."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterator, Sequence

from mauve.records import record
from mauve.report.gantt_axis import Axis
from mauve.report.gantt_shapes import DOT, box, line, plain, shortened, words
from mauve.report.gantt_style import PALETTE
from mauve.report.simulation_views import Wait, Waiting, waits
from mauve.timing.simulation.outcome import Activity, Job, Measures, Outcome, Segment
from mauve.timing.task import Kind

MARGIN = 24
ROW = 38
BAR = 16

LONGEST = 30
"""Characters of a name that are shown; the tooltip has all."""

ARROWS = 14.0
"""Pixels between releases below which arrows would hide the jobs: strokes stand for releases then."""

STROKES = 4.0
"""Pixels between releases below which strokes would blacken the row."""


@record
class Scene:
    """What all rows share: the axis, the right edge, the end of the simulation, and how times read."""

    axis: Axis
    right: float
    end: int
    show: Callable[[int], str]


@record
class Row:
    """What a row shows: a task, its proven bound, the class of its colour, and what happens in the window."""

    measures: Measures
    bound: int | None
    colour: str
    top: float
    jobs: tuple[Job, ...]
    segments: tuple[Segment, ...]
    waits: tuple[Waiting, ...]
    away: tuple[Segment, ...] = ()


def rows(outcome: Outcome, order: Sequence[tuple[Measures, int | None]], top: float) -> list[Row]:
    """The rows of these tasks, from the top."""
    jobs: dict[str, list[Job]] = defaultdict(list)
    segments: dict[str, list[Segment]] = defaultdict(list)
    waiting: dict[str, list[Waiting]] = defaultdict(list)
    for job in outcome.jobs:
        jobs[job.task].append(job)
    for segment in outcome.segments:
        segments[segment.task].append(segment)
    for wait in waits(outcome):
        waiting[wait.task].append(wait)
    return [
        Row(
            one,
            bound,
            f"t{number % len(PALETTE)}",
            top + ROW * number,
            tuple(jobs[one.task]),
            tuple(segments[one.task]),
            tuple(waiting[one.task]),
            tuple(away for away in outcome.waits if away.task == one.task),
        )
        for number, (one, bound) in enumerate(order)
    ]


def draw_row(row: Row, scene: Scene) -> Iterator[str]:
    """The row, from the back to the front; each job is a group with a tooltip."""
    yield from _label(row, scene)
    yield from _figures(row, scene)
    base = row.top + ROW - 8
    marks: dict[int, list[str]] = defaultdict(list)
    for wait in row.waits:
        marks[wait.job].append(_wait(wait, scene.axis, base))
    for away in row.away:
        x = scene.axis.x(away.start)
        marks[away.job].append(f'<path class="away" d="M{x:.2f} {base - 2.5:.1f}H{scene.axis.x(away.end):.2f}"/>')
    for segment in row.segments:
        marks[segment.job] += _segment(segment, row.colour, scene.axis, base)
    for job in row.jobs:
        drawn = marks.pop(job.number, [])
        if job.missed(scene.end) and scene.axis.start <= job.deadline <= scene.axis.end:
            drawn.append(_late(job, scene.axis, base))
        if drawn:
            yield f"<g><title>{plain(_tooltip(job, scene))}</title>{''.join(drawn)}</g>"
    for drawn in marks.values():
        yield from drawn
    apart = scene.axis.pixels(row.measures.period)
    for job in row.jobs:
        if apart >= ARROWS:
            yield from _arrows(job, row.measures.kind is Kind.TASK, scene, base)
        elif apart >= STROKES and scene.axis.start <= job.release <= scene.axis.end:
            yield f'<path class="stroke" d="M{scene.axis.x(job.release):.2f} {base - BAR:.1f}v-4"/>'
    yield line("grid", MARGIN / 2, row.top + ROW, scene.right + MARGIN / 2, row.top + ROW)


def _label(row: Row, scene: Scene) -> Iterator[str]:
    one = row.measures
    facts = f"every {scene.show(one.period)}{DOT}"
    facts += f"priority {one.priority}" if one.kind is Kind.TASK else one.kind.value
    yield f"<g><title>{plain(one.task)}</title>"
    yield box(f'class="{row.colour}"', MARGIN - 10, row.top + 8, 4, ROW - 15)
    yield words(shortened(one.task, LONGEST), MARGIN, row.top + 17, 12, "ink mono")
    yield words(facts, MARGIN, row.top + 30, 10) + "</g>"


def _figures(row: Row, scene: Scene) -> Iterator[str]:
    """The greatest response seen, and the proven bound beside it."""
    one, y = row.measures, row.top + 23
    if one.greatest is not None:
        yield words(
            scene.show(one.greatest), scene.right - 74, y, 11, "alarm mono" if one.misses else "ink mono", "end"
        )
    if row.bound is not None:
        yield words(scene.show(row.bound), scene.right, y, 11, "soft mono", "end")


def _span(look: str, start: int, end: int, axis: Axis, y: float, height: float) -> str:
    x = axis.x(start)
    return box(look, x, y, axis.x(end) - x, height)


def _wait(wait: Waiting, axis: Axis, base: float) -> str:
    if wait.wait is Wait.BLOCKED:
        return _span('fill="url(#blocked)"', wait.start, wait.end, axis, base - 8, 8)
    return _span('class="wait"', wait.start, wait.end, axis, base - 5, 5)


def _segment(segment: Segment, colour: str, axis: Axis, base: float) -> Iterator[str]:
    look = "switch" if segment.activity is Activity.SWITCH else colour
    yield _span(f'class="{look}"', segment.start, segment.end, axis, base - BAR, BAR)
    if segment.activity is Activity.SECTION:
        yield _span('fill="url(#locked)"', segment.start, segment.end, axis, base - BAR, BAR)


def _late(job: Job, axis: Axis, base: float) -> str:
    x, y = axis.x(job.deadline), base - BAR - 4
    return f'<path class="late" d="M{x - 4:.2f} {y - 4:.1f}l8 8m0 -8l-8 8M{x:.2f} {y + 4:.1f}V{base + 5:.1f}"/>'


def _arrows(job: Job, task: bool, scene: Scene, base: float) -> Iterator[str]:
    """Release and deadline; interrupts and ticks have no deadline."""
    axis = scene.axis
    if axis.start <= job.release <= axis.end:
        yield f'<path class="release" d="M{axis.x(job.release):.2f} {base:.1f}v-23m-3 4l3 -4l3 4"/>'
    if task and axis.start <= job.deadline <= axis.end and not job.missed(scene.end):
        yield f'<path class="deadline" d="M{axis.x(job.deadline):.2f} {base - 11:.1f}v16m-2.6 -3.6l2.6 3.6l2.6 -3.6"/>'


def _tooltip(job: Job, scene: Scene) -> str:
    show = scene.show
    released = f"released at {show(job.release)}"
    if job.release != job.arrival:
        released += f", {show(job.release - job.arrival)} after its arrival"
    lines = [f"{job.task}, job {job.number}" + (f": {job.mode}" if job.mode else "")]
    lines.append(f"{released}, deadline {show(job.deadline)}")
    if job.finish is None or job.response is None:
        lines.append("has not ended when the simulation does")
    else:
        lines.append(f"ended at {show(job.finish)}: response {show(job.response)}")
    if job.missed(scene.end):
        lines.append("missed its deadline")
    lines.append(f"executed {show(job.cost)}, preempted {job.preemptions} times, blocked {show(job.blocked)}")
    return "\n".join(lines)
