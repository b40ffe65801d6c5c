"""`mauvec simulate`: one run of the schedule, as tables, a Gantt chart or data. What it shows is no bound."""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

from mauve import __version__
from mauve.cli.check import unknown_deployment
from mauve.cli.output import style, table_width, write_file, write_messages, wrong_usage
from mauve.diagnostics.allow import filter_allowed
from mauve.diagnostics.diagnostic import Report
from mauve.timing.simulation.horizon import Asked
from mauve.timing.simulation.system import (
    Arrivals,
    Execution,
    Jitter,
    Offsets,
    Order,
    Protocol,
    Runs,
    Settings,
)
from mauve.units import TIME_UNITS

if TYPE_CHECKING:
    from mauve.timing.simulation.outcome import Simulated


def run(arguments: Namespace) -> int:
    """Simulate and write; 0 where no deadline was missed, or where the model expects that."""
    report = Report()
    model = not arguments.file.lower().endswith((".json", ".csv", ".xml", ".mast", ".txt"))
    runs = _simulate_model(arguments, report) if model else _simulate_sets(arguments, report)
    if isinstance(runs, int):
        return runs
    messages = [message for message in filter_allowed(report) if message.code != "MV420"]
    write_messages(messages, "short" if arguments.format == "json" else "full", arguments, arguments.file)
    if not runs and not report.has_errors:
        print(f"mauvec: `{arguments.file}` has nothing to simulate", file=sys.stderr)
    if not runs and arguments.format != "json":
        return 1 if report.has_errors else 0
    text = _render(arguments, runs)
    if arguments.output:
        wrong = write_file(arguments.output, text)
        if wrong:
            print(f"mauvec: cannot write `{arguments.output}`: {wrong.lower()}", file=sys.stderr)
            return 1
    else:
        sys.stdout.write(text)
    missed = any(one.misses and not one.misses_expected for one in runs)
    return 1 if report.has_errors or missed else 0


def _simulate_sets(arguments: Namespace, report: Report) -> tuple[Simulated, ...] | int:
    """The simulations of plain task sets; an exit code where a time asked for is none of theirs."""
    from mauve.tasksets.read import read_tasksets
    from mauve.tasksets.simulated import clock, simulate_set

    if arguments.deployment is not None:
        return wrong_usage("a plain task set has no deployments")
    document = read_tasksets(arguments.file, report)
    runs = []
    for taskset in document.sets:
        if taskset is not None:
            ticks = clock(taskset)
            asked = _asked(arguments, taskset.unit, ticks.per_unit)
            if isinstance(asked, str):
                return wrong_usage(asked)
            runs.append(simulate_set(taskset, arguments.file, _settings(arguments), asked))
    return tuple(runs)


def _simulate_model(arguments: Namespace, report: Report) -> tuple[Simulated, ...] | int:
    """The simulations of a model; an exit code where the deployment asked for does not exist."""
    from mauve.pipeline import Options, simulate
    from mauve.report.progress import progress

    asked = _asked(arguments, "ps", 0)
    if isinstance(asked, str):
        return wrong_usage(asked)
    with progress(sys.stderr, "codels") as told:
        options = Options(
            arguments.deployment, cache=not arguments.no_cache, workers=os.cpu_count() or 1, progress=told
        )
        result, runs = simulate(arguments.file, options, _settings(arguments), asked, report)
    unknown = unknown_deployment(arguments.deployment, result)
    if unknown and not report.has_errors:
        return wrong_usage(unknown)
    return runs


def _settings(arguments: Namespace) -> Settings:
    return Settings(
        length=1,
        seed=arguments.seed,
        offsets=Offsets(arguments.offsets),
        runs=Runs(arguments.runs),
        jitter=Jitter(arguments.jitter or ("none" if arguments.runs == "first" else arguments.runs)),
        arrivals=Arrivals(arguments.arrivals),
        execution=Execution(arguments.execution),
        order=Order(arguments.order),
        protocol=Protocol(arguments.protocol),
        events=arguments.events,
    )


def _asked(arguments: Namespace, unit: str, ticks: int) -> Asked | str:
    """The times asked for, in ticks of which a unit has so many (0: a number alone means nothing, and a unit is one
    tick); what is wrong with them where something is."""
    found: dict[str, int | None] = {}
    for option, given in (("--for", arguments.length), ("--from", arguments.start), ("--to", arguments.end)):
        time = None if given is None else _in_ticks(given, unit, ticks)
        if isinstance(time, str):
            return f"{option}: {time}"
        found[option] = time
    length, start, end = found.values()
    if length is not None and arguments.hyperperiod:
        return "--for and --hyperperiod contradict each other"
    if length == 0:
        return "--for: there is nothing to simulate in no time"
    if end is not None and end <= (start or 0):
        return "--to must be later than --from"
    return Asked(length, arguments.hyperperiod, start, end)


def _in_ticks(duration: tuple[Fraction, str], unit: str, ticks: int) -> int | str:
    """A time as a whole number of ticks; what is wrong with it where it is none."""
    value, given = duration
    if not given and not ticks and value:
        return "say the unit, e.g. 20ms"
    if given and unit not in TIME_UNITS:
        return f"the times of this file have no unit of time{f' ({unit})' if unit else ''}: give a plain number"
    factor = Fraction(TIME_UNITS[given], TIME_UNITS[unit]) if given else Fraction(1)
    time = value * factor * max(1, ticks)
    if time.denominator != 1:
        return f"{float(value):g}{given} is finer than the times of this file"
    return int(time)


def _render(arguments: Namespace, runs: Sequence[Simulated]) -> str:
    match arguments.format:
        case "json":
            import json

            from mauve.report.simulation_json import simulation_document

            return json.dumps(simulation_document(runs, arguments.file, __version__), indent=1, allow_nan=False) + "\n"
        case "perfetto":
            import json

            from mauve.report.trace_json import trace_document

            return json.dumps(trace_document(runs, __version__), allow_nan=False) + "\n"
        case "svg":
            from mauve.report.gantt_svg import gantt

            return gantt(runs, Path(arguments.file).name)
        case "csv" | "segments-csv":
            from mauve.report.simulation_csv import format_jobs, format_segments

            return format_jobs(runs) if arguments.format == "csv" else format_segments(runs)
        case _:
            from mauve.report.simulation_text import format_simulation

            return format_simulation(runs, style(arguments), table_width())
