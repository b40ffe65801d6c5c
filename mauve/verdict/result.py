"""What a check found, as data: codels, tasks and responses of each deployment, and the verdict.

The pipeline makes these, the reports show them.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from mauve.diagnostics.diagnostic import Diagnostic, Report
from mauve.lower.codels import CodelTime
from mauve.lower.machines import Machine
from mauve.lower.placed import NodeTasks, PlacedTask
from mauve.model.model import Deployment, Model
from mauve.records import changed, record
from mauve.syntax.ast import Module
from mauve.timing.response import Analysis, as_seen
from mauve.timing.task import Task
from mauve.verdict.flows import FlowResult

if TYPE_CHECKING:
    from mauve.verdict.missions import MissionResult
    from mauve.verdict.modes import ModesResult
    from mauve.verdict.sensitivity import NodeSensitivity, Proposal


@record
class NodeResult:
    """One processor: its tasks and their responses (None where a task is missing)."""

    tasks: NodeTasks
    analysis: Analysis | None


def executed(placed: PlacedTask, analysis: Analysis) -> Task:
    """A task as analysed, without what it waits for: its trace and its load are what the processor does for it."""
    analysed = analysis.task(placed.task.name)
    if analysed.outside is None:
        return analysed
    plain = changed(placed.task, overhead=analysed.overhead, blocking=analysed.blocking)
    return as_seen([plain], analysis.method)[0]


@record
class DeploymentResult:
    """One deployment. `complete` says that every codel has a time and every task a place; `holds` that it is complete
    and every deadline, flow and queue is proven. Where it is not complete, the responses leave the missing work out:
    they are not bounds yet, and can only grow. `modes` has the missions whose activities it runs: then the deadlines of
    each mode and of each switch decide, not those of all tasks together. `overflows` are queues that may overflow;
    `sensitivity` and `proposals` are there, one per node, where somebody asked."""

    deployment: Deployment
    codels: tuple[CodelTime, ...]
    machines: Mapping[str, tuple[Machine, ...] | None]
    nodes: tuple[NodeResult, ...]
    complete: bool
    holds: bool
    flows: tuple[FlowResult, ...] = ()
    modes: tuple[ModesResult, ...] = ()
    overflows: tuple[Diagnostic, ...] = ()
    sensitivity: tuple[NodeSensitivity, ...] = ()
    proposals: tuple[Proposal, ...] = ()

    @property
    def schedulable(self) -> bool:
        """Whether it is complete and every deadline is proven, whatever is asked of flows."""
        if self.modes:
            return self.complete and all(mode.holds for mode in self.modes)
        return self.complete and all(n.analysis is not None and n.analysis.schedulable for n in self.nodes)

    @property
    def as_expected(self) -> bool:
        """Whether the verdict is the one that the model asks for."""
        return self.complete and self.holds == (self.deployment.expect_unschedulable is None)


@record
class CheckResult:
    """Everything a check produced, stage by stage. `deployments` is empty when the model is in error."""

    path: str
    modules: tuple[Module, ...]
    model: Model | None
    deployments: tuple[DeploymentResult, ...]
    missions: tuple[MissionResult, ...] = ()

    def passes(self, report: Report) -> bool:
        """Whether the input is free of errors and every deployment has the verdict it asks for."""
        deployed = all(deployment.as_expected for deployment in self.deployments)
        return not report.has_errors and deployed and all(mission.holds for mission in self.missions)
