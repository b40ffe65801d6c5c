"""A simulation as a Gantt chart in SVG: a row per task, the most urgent first, and one for the processor.

Longer schedules are cut after so many segments that a browser still draws them at once; what lies behind is seen with
another window.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from mauve.records import changed
from mauve.report.gantt_axis import Axis, ticks
from mauve.report.gantt_row import BAR, LONGEST, MARGIN, ROW, Scene, draw_row, rows
from mauve.report.gantt_shapes import DOT, box, line, plain, words
from mauve.report.gantt_style import legend, stylesheet
from mauve.report.simulation_views import NOT_A_BOUND, describe, reach_note, show_time
from mauve.timing.simulation.outcome import Outcome, Segment, Simulated

WIDTH = 1280
HEAD = 84
FIGURES = 150
"""Pixels to the right of the axis, for the responses."""

NAME = 7.3
"""Pixels of a character of a name."""

DRAWN = 6_000
"""Segments drawn at most for one processor."""


def gantt(runs: Sequence[Simulated], file: str, dark: bool = False) -> str:
    """The chart of all processors, one under the other; `dark` fixes the dark colours."""
    body: list[str] = []
    top = float(MARGIN)
    for run in runs:
        for outcome, bounds in zip(run.outcomes, run.bounds, strict=True):
            panel = _Panel(run, outcome, bounds, file, top)
            body += panel.lines()
            top = panel.bottom + 2 * MARGIN
    marks, height = legend(MARGIN, top, WIDTH - 2 * MARGIN)
    total = int(top + height + MARGIN / 2)
    head = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{WIDTH}" height="{total}" viewBox="0 0 {WIDTH} {total}">',
        f"<title>{plain(f'simulated schedule of {file}')}</title>",
        stylesheet(dark),
        f'<rect class="page" width="{WIDTH}" height="{total}"/>',
    ]
    return "\n".join([*head, *body, *marks, "</svg>"]) + "\n"


class _Panel:
    """One processor: its title, axis and rows."""

    def __init__(
        self, run: Simulated, outcome: Outcome, bounds: Mapping[str, int | None], file: str, top: float
    ) -> None:
        self.run, self.file, self.top = run, file, top
        self.outcome, self.cut = _drawable(outcome)
        longest = max((min(LONGEST, len(one.task)) for one in outcome.tasks), default=8)
        left = MARGIN + max(136.0, NAME * longest + 16)
        start, end = self.outcome.window
        self.axis = Axis(start, end, left, WIDTH - MARGIN - FIGURES - left, run.unit)
        self.scene = Scene(self.axis, WIDTH - MARGIN, outcome.end, self.show)
        self.rows_top = top + HEAD
        order = sorted(outcome.tasks, key=lambda one: -one.priority)
        self.rows = rows(self.outcome, [(one, bounds.get(one.task)) for one in order], self.rows_top)
        self.bottom = self.rows_top + ROW * (len(self.rows) + 1) + 18

    def lines(self) -> Iterator[str]:
        """The panel, from the back to the front."""
        yield from self._head()
        yield from self._grid()
        for row in self.rows:
            yield from draw_row(row, self.scene)
        yield from self._processor()

    def show(self, time: int) -> str:
        """A time with its unit."""
        return show_time(time, self.run.unit)

    def _head(self) -> Iterator[str]:
        outcome, run = self.outcome, self.run
        title = f"Simulated schedule of {run.name} on {outcome.processor.name}"
        shown = f"{self.show(self.axis.start)} to {self.show(self.axis.end)} of {self.show(outcome.end)} simulated"
        notes = [self.file, shown, *filter(None, [reach_note(run)])]
        if self.cut:
            notes.append("no more than this is drawn: choose a window with --from and --to")
        choices = ", ".join(f"{name} {value}" for name, value in describe(outcome.settings))
        yield words(title, MARGIN, self.top + 12, 19, "ink strong")
        yield words(DOT.join(notes), MARGIN, self.top + 31, 12)
        yield words(f"{choices}{DOT}{NOT_A_BOUND}", MARGIN, self.top + 48, 12)
        yield words("greatest", self.scene.right - 74, self.rows_top - 20, 10.5, anchor="end")
        yield words("seen", self.scene.right - 74, self.rows_top - 8, 10.5, anchor="end")
        yield words("proven", self.scene.right, self.rows_top - 20, 10.5, anchor="end")
        yield words("bound", self.scene.right, self.rows_top - 8, 10.5, anchor="end")

    def _grid(self) -> Iterator[str]:
        axis, bottom = self.axis, self.rows_top + ROW * (len(self.rows) + 1)
        for number in range(0, len(self.rows) + 1, 2):
            yield box('class="band"', MARGIN / 2, self.rows_top + ROW * number, WIDTH - MARGIN, ROW)
        marks = ticks(axis, 12)
        if max((len(label) for _, label in marks), default=0) > 8:
            marks = ticks(axis, 6)
        for at, label in marks:
            x = axis.x(at)
            yield line("grid", x, self.rows_top, x, bottom)
            yield words(label, x, self.rows_top - 8, 11, anchor="middle")
            yield words(label, x, bottom + 15, 11, anchor="middle")
        for y in (self.rows_top, bottom):
            yield line("rule", axis.left, y, axis.left + axis.width, y)

    def _processor(self) -> Iterator[str]:
        """Who has the processor."""
        outcome, top = self.outcome, self.rows_top + ROW * len(self.rows)
        colours = {row.measures.task: row.colour for row in self.rows}
        share = f"busy {100 * outcome.busy / outcome.end:.1f} % of the time" if outcome.end else ""
        yield words("processor", MARGIN, top + 17, 12, "ink mono")
        yield words(share, MARGIN, top + 30, 10)
        for task, start, end in _stretches(outcome.segments):
            x = self.axis.x(start)
            yield box(f'class="{colours[task]}"', x, top + 11, self.axis.x(end) - x, BAR)
        yield words(f"context switches: {outcome.switches}", self.scene.right, top + 18, 10, anchor="end")
        yield words(f"preemptions: {outcome.preemptions}", self.scene.right, top + 31, 10, anchor="end")


def _stretches(segments: Sequence[Segment]) -> Iterator[tuple[str, int, int]]:
    """Segments of one task that follow each other as one."""
    task, start, end = "", 0, 0
    for segment in segments:
        if segment.task == task and segment.start == end:
            end = segment.end
            continue
        if end > start:
            yield task, start, end
        task, start, end = segment.task, segment.start, segment.end
    if end > start:
        yield task, start, end


def _drawable(outcome: Outcome) -> tuple[Outcome, bool]:
    """The outcome with no more segments than are drawn, and whether that cut the window."""
    start, _ = outcome.window
    if len(outcome.segments) <= DRAWN:
        return outcome, False
    end = outcome.segments[DRAWN].start
    kept = changed(outcome.settings, window=(start, end))
    jobs = tuple(job for job in outcome.jobs if job.release < end)
    return changed(outcome, settings=kept, jobs=jobs, segments=outcome.segments[:DRAWN]), True
