"""Missions as JSON, schema mauve.mission/1 (docs/schema/mission-1.schema.json)."""

from __future__ import annotations

from collections.abc import Sequence

from mauve.mission.graph import AlternativesGraph, MarkingsGraph
from mauve.verdict.missions import MissionResult

SCHEMA = "mauve.mission/1"


def mission_document(results: Sequence[MissionResult]) -> dict[str, object]:
    """The document; empty of missions where the file is in error."""
    return {"schema": SCHEMA, "missions": [_mission(result) for result in results]}


def _mission(result: MissionResult) -> dict[str, object]:
    """Sizes are null where a graph is larger than its budget; then `local_graphs` has those of the objectives."""
    document: dict[str, object] = {
        "name": result.mission.name,
        "net": {"places": len(result.net.places), "transitions": len(result.net.transitions)},
        "alternatives_graph": _sizes(result.graph),
    }
    if result.markings is not None:
        full = result.markings if isinstance(result.markings, MarkingsGraph) else None
        document["markings_graph"] = {
            "states": full.states if full else None,
            "transitions": full.edges if full else None,
        }
    if result.local:
        document["local_graphs"] = [{"objective": one.path, **_sizes(one.graph)} for one in result.local]
    document["properties"] = [
        {"name": verdict.name, "holds": verdict.holds, "witness": list(verdict.witness), "note": verdict.note}
        for verdict in result.verdicts
    ]
    document["cuts"] = [list(cut) for cut in result.cuts]
    document["seconds"] = round(result.seconds, 6)
    return document


def _sizes(graph: AlternativesGraph | None) -> dict[str, object]:
    if graph is None:
        return {"states": None, "transitions": None}
    return {"states": len(graph.markings), "transitions": len(graph.events)}
