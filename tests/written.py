"""Models from text, for tests of what comes after the syntax."""

from __future__ import annotations

from pathlib import Path

from mauve.diagnostics.diagnostic import Report
from mauve.lower.codels import choose_times, plan_codels
from mauve.lower.machines import Machine, build_machines
from mauve.lower.placed import NodeTasks
from mauve.lower.tasks import task_sets
from mauve.model.model import CodelId, Deployment, Model
from mauve.model.resolve import resolve
from mauve.source import SourceFile
from mauve.syntax.load import standard_module
from mauve.syntax.parse import parse
from mauve.units import US

MODELS = Path(__file__).parent / "model" / "models"

BOARD = """
board desk {
  cpu "arm926ej-s" at 200MHz
}
"""


def resolved(text: str, *others: str) -> tuple[Model, Report]:
    """The model of a text without its first line, and of the texts that it imports besides the standard library."""
    report = Report()
    names = ["robot.mauve", *(f"other{n}.mauve" for n, _ in enumerate(others))]
    modules = [
        parse(SourceFile(name, f"mauve 1\n{body}"), report) for name, body in zip(names, (text, *others), strict=True)
    ]
    standard = [module for name in ("lifecycle", "boards") if (module := standard_module(name, report)) is not None]
    assert not report.has_errors, [d.message for d in report]
    return resolve((*modules, standard[0]), (standard[1],), report), report


def model_of(text: str, *others: str) -> Model:
    """The model of a text that is free of errors."""
    model, report = resolved(text, *others)
    assert not report.has_errors, [d.message for d in report]
    return model


def codes(report: Report) -> list[str]:
    """The codes reported, in order, without the notes about defaults."""
    return [d.code for d in report if d.code != "MV420"]


def times(deployment: Deployment, report: Report | None = None) -> dict[CodelId, int]:
    """The times of a deployment's codels, none of them derived from a binary."""
    chosen = choose_times(plan_codels(deployment), deployment, {}, report or Report())
    return {codel.plan.id: codel.time for codel in chosen if codel.time is not None}


def machines_of(model: Model, deployment: int = 0) -> dict[str, tuple[Machine, ...] | None]:
    """The machines of a deployment's instances."""
    chosen = model.deployments[deployment]
    return build_machines(chosen, times(chosen))


def arcs(machine: Machine) -> dict[tuple[str, str], int]:
    """The transitions of a machine with their costs in microseconds."""
    return {(t.source, t.target): t.cost // US for t in machine.psm.transitions}


def tasks_of(model: Model, report: Report | None = None) -> tuple[NodeTasks, ...]:
    """The tasks of the first deployment."""
    chosen = model.deployments[0]
    found = report or Report()
    return task_sets(chosen, build_machines(chosen, times(chosen)), times(chosen), found)
