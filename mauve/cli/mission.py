"""`mauvec mission`: build, check, simulate and export the missions of a model."""

from __future__ import annotations

import os
import sys
from argparse import Namespace
from collections.abc import Sequence

from mauve.cli.output import style, table_width, write_file, write_json, write_messages, wrong_usage
from mauve.diagnostics.allow import filter_allowed
from mauve.diagnostics.diagnostic import Report
from mauve.pipeline import check_missions, read_model
from mauve.verdict.missions import MissionOptions, MissionResult


def run(arguments: Namespace) -> int:
    """Check the missions and write what was asked for; 0 where all of them hold."""
    report = Report()
    _, model = read_model(arguments.file, report)
    sound = model is not None and not report.has_errors
    known = [mission.name for mission in model.missions.missions] if model and model.missions else []
    if sound and arguments.mission is not None and arguments.mission not in known:
        from mauve.diagnostics.suggest import closest

        names = ", ".join(f"`{name}`" for name in closest(arguments.mission, known) or known) or "none"
        return wrong_usage(f"there is no mission `{arguments.mission}`; the model has {names}")
    if model is not None and sound and not known:
        write_messages(filter_allowed(report), "full", arguments, arguments.file)
        print(f"mauvec: {arguments.file} has no mission", file=sys.stderr)
        return _nothing(arguments)
    chosen = [name for name in known if arguments.mission in (None, name)]
    single = arguments.simulate or arguments.emit
    if sound and single and len(chosen) > 1:
        names = ", ".join(f"`{name}`" for name in chosen)
        return wrong_usage(f"the model has several missions: choose one of {names} by `--mission`")
    if model is None or not sound:
        return _refused(arguments, report)
    if arguments.simulate:
        from mauve.cli.mission_steps import simulate

        write_messages(filter_allowed(report), arguments.messages, arguments, arguments.file)
        return simulate(model, chosen[0], arguments)
    options = MissionOptions(arguments.budget, arguments.markings)
    results = check_missions(model, options, report, tuple(chosen))
    write_messages(filter_allowed(report), arguments.messages, arguments, arguments.file)
    holds = not report.has_errors and all(result.holds for result in results)
    if arguments.emit:
        return _emit(arguments, results[0], holds)
    text = _document(arguments, results)
    if not arguments.output:
        sys.stdout.write(text)
    else:
        problem = write_file(arguments.output, text)
        if problem:
            return wrong_usage(f"cannot write {arguments.output}: {problem}")
    return 0 if holds else 1


def _refused(arguments: Namespace, report: Report) -> int:
    """A file in error: the messages, and what there is to write."""
    write_messages(filter_allowed(report), arguments.messages, arguments, arguments.file)
    return _nothing(arguments)


def _nothing(arguments: Namespace) -> int:
    """No mission was looked at: for a program, a document that says so."""
    if arguments.format == "json" and not arguments.emit and not arguments.simulate:
        from mauve.report.mission_json import mission_document

        write_json(mission_document(()))
    return 1


def _document(arguments: Namespace, results: Sequence[MissionResult]) -> str:
    if arguments.format == "json":
        import json

        from mauve.report.mission_json import mission_document

        return json.dumps(mission_document(results), indent=2, allow_nan=False) + "\n"
    from mauve.report.mission_text import format_missions

    return format_missions(results, style(arguments), table_width())


def _emit(arguments: Namespace, result: MissionResult, holds: bool) -> int:
    """Write one form of a mission. The controller in C is a source and its header, both where a file is named."""
    from mauve.report.mission_emit import OF_GRAPH, emit_mission

    if arguments.emit in OF_GRAPH and result.graph is None:
        why = "has too many states for one graph" if result.exceeded else "is not sound: it has no graph"
        print(f"mauvec: the mission {result.mission.name} {why}", file=sys.stderr)
        return 1
    if not arguments.output:
        sys.stdout.write(emit_mission(arguments.emit, result))
        return 0 if holds else 1
    stem, suffix = os.path.splitext(os.path.basename(arguments.output))
    wanted = [(arguments.output, arguments.emit)]
    if arguments.emit == "c" and suffix == ".c":
        wanted.append((os.path.splitext(arguments.output)[0] + ".h", "c-header"))
    for path, form in wanted:
        problem = write_file(path, emit_mission(form, result, stem if form.startswith("c") else None))
        if problem:
            return wrong_usage(f"cannot write {path}: {problem}")
    return 0 if holds else 1
