"""The stack of a task is that of the deepest codel it executes; unknown where one of them is."""

from __future__ import annotations

from pathlib import Path

from mauve.diagnostics.diagnostic import Report
from mauve.pipeline import Options, check
from mauve.records import changed
from mauve.verdict.stack import StackUse, stack_use

ROBOT = Path(__file__).resolve().parents[2] / "examples" / "ttrk" / "ttrk.mauve"


def test_the_deepest_codel_counts_and_what_is_unknown_stays_so() -> None:
    (result,) = check(str(ROBOT), Options(deployment="on_robot"), Report()).deployments
    (node,) = result.nodes
    tasks = {placed.task.name: placed for placed in node.tasks.tasks}
    depths = {str(codel.plan.id): codel.result.stack for codel in result.codels if codel.result is not None}
    use = stack_use(tasks["command"], result.codels)
    assert use is not None and use.size is not None
    # The operation that runs in the caller needs the caller's stack.
    executed = [depth for name, depth in depths.items() if name.startswith(("Command.", "CICAS."))]
    assert use.size == max(depth for depth in executed if depth is not None)
    assert depths[use.codel] == use.size
    other = [codel if str(codel.plan.id) != "Command.halt" else changed(codel, result=None) for codel in result.codels]
    assert stack_use(tasks["command"], other) == StackUse(None, "Command.halt")
    assert stack_use(tasks["fusion"], other) == stack_use(tasks["fusion"], result.codels)
    assert stack_use(tasks["fusion"], ()) is None
