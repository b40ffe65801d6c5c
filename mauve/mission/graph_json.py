"""The alternatives graph as JSON, schema mauve.alternatives/1 (docs/schema/alternatives-1.schema.json)."""

from __future__ import annotations

from mauve.mission.graph import AlternativesGraph

__all__ = ["SCHEMA", "graph_document"]

SCHEMA = "mauve.alternatives/1"


def graph_document(graph: AlternativesGraph) -> dict[str, object]:
    """What `json.dumps` takes: events, states as a person sees them, and edges; states are numbered from 0, initial."""
    return {
        "schema": SCHEMA,
        "mission": graph.net.name,
        "initial": graph.initial,
        "events": [
            {"name": event.name, "kind": event.kind.name.lower(), "subject": event.subject}
            for event in graph.net.events
        ],
        "states": [_state(graph, state) for state in range(len(graph.markings))],
        "edges": [{"source": edge.source, "event": edge.event, "target": edge.target} for edge in graph.edges()],
    }


def _state(graph: AlternativesGraph, state: int) -> dict[str, object]:
    seen = graph.view(state)
    return {
        "objectives": list(seen.objectives),
        "running": [{"activity": activity, "alternative": alternative} for activity, alternative in seen.running],
        "failed": list(seen.failed),
        "out_of_service": list(seen.lost),
        "outcome": seen.outcome or None,
    }
