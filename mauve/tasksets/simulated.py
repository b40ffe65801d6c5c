"""One run of the schedule of a plain task set, in the set's own unit where that is fine enough."""

from __future__ import annotations

from mauve.records import record
from mauve.tasksets.taskset import TaskSet, timing_tasks
from mauve.timing.response import analyse
from mauve.timing.simulation.engine import simulate
from mauve.timing.simulation.horizon import Asked, horizon, windowed
from mauve.timing.simulation.outcome import Simulated
from mauve.timing.simulation.system import Processor, Settings, simulated
from mauve.units import TIME_UNITS


@record
class Clock:
    """What a set's times are counted in: the `label` of a tick, ticks per unit of the set, and how many times finer
    that is than the set needs."""

    label: str
    per_unit: int
    finer: int = 1


def clock(taskset: TaskSet) -> Clock:
    """Units of the set where all of its times are whole; else picoseconds, or parts of a unit that is none of time."""
    scale, unit = taskset.scale, taskset.unit
    if scale == 1:
        return Clock(unit, 1)
    finest = TIME_UNITS.get(unit, 0)
    if finest and finest % scale == 0:
        return Clock("ps", finest, finest // scale)
    return Clock(f"/{scale}{unit}", scale)


def simulate_set(taskset: TaskSet, file: str, settings: Settings, asked: Asked) -> Simulated:
    """The simulation of a set, beside the bounds of the analysis. A blocking given as a number has no section that it
    comes from, so that it is not simulated."""
    ticks = clock(taskset)
    tasks, _ = timing_tasks(taskset, ticks.finer)
    processor = Processor("processor", tuple(simulated(task, sporadic=True) for task in tasks))
    reach = horizon((processor,), asked)
    outcome = simulate(processor, windowed(settings, reach, asked))
    bounds = {one.task: one.wcrt for one in analyse(tasks).results}
    return Simulated(taskset.name or "the task set", file, ticks.label, (outcome,), (bounds,), reach)
