"""What is known of a deployment's execution times before they are chosen: the outcome of `derive`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from mauve.model.model import Binary, CodelId, Deployment
from mauve.records import record

if TYPE_CHECKING:
    from mauve.wcet.result import WcetResult


@record
class Derivation:
    """What the binaries of a deployment say: a result per codel with the binary it comes from, and the cost of each
    interrupt handler in picoseconds (one without a cost was reported and is left out)."""

    codels: Mapping[CodelId, tuple[WcetResult, Binary]]
    handlers: Mapping[str, int]
    complete: bool


def declared_handlers(deployment: Deployment) -> dict[str, int]:
    """The cost of each interrupt handler whose time is declared, in picoseconds."""
    return {i.name: i.wcet for node in deployment.nodes for i in node.interrupts if i.wcet is not None}
