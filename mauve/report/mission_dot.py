"""Graphs of a mission for other tools: DOT, and the alternatives graph as JSON."""

from __future__ import annotations

import json

from mauve.mission.graph import AlternativesGraph, StateView
from mauve.mission.net import Level, Net

GRAPH_SCHEMA = "mauve.alternatives/1"


def alternatives_dot(graph: AlternativesGraph) -> str:
    """The alternatives graph in the language of Graphviz; edges between the same states share an arrow."""
    lines = [f"digraph {_quoted(graph.net.name)} {{", "  node [shape=box, fontsize=10];"]
    for state in range(len(graph.markings)):
        seen = graph.view(state)
        shape = {"success": ", peripheries=2, color=darkgreen", "failure": ", peripheries=2, color=red"}
        lines.append(f"  s{state} [label={_quoted(_label(state, seen))}{shape.get(seen.outcome, '')}];")
    for state in range(len(graph.markings)):
        arrows: dict[int, list[str]] = {}
        for event, target in graph.successors(state):
            arrows.setdefault(target, []).append(graph.net.events[event].name)
        for target, names in arrows.items():
            lines.append(f"  s{state} -> s{target} [label={_quoted(chr(10).join(names))}];")
    return "\n".join([*lines, "}"]) + "\n"


def net_dot(net: Net) -> str:
    """A net in the language of Graphviz: places are circles, transitions bars, events bold."""
    lines = [f"digraph {_quoted(net.name)} {{"]
    marked = set(net.initial)
    for index, place in enumerate(net.places):
        style = ", style=filled, fillcolor=lightgrey" if index in marked else ""
        lines.append(f"  p{index} [shape=ellipse, label={_quoted(place)}{style}];")
    for index, one in enumerate(net.transitions):
        style = ", style=bold" if one.level is Level.EVENT else ""
        lines.append(f"  t{index} [shape=box, label={_quoted(one.name)}{style}];")
        lines += [f"  p{place} -> t{index};" for place in one.before]
        lines += [f"  t{index} -> p{place};" for place in one.after]
    return "\n".join([*lines, "}"]) + "\n"


def _label(state: int, seen: StateView) -> str:
    lines = [f"{state}: {seen.outcome or ', '.join(path.rpartition('.')[2] for path in seen.objectives)}"]
    lines += [name if way == "only" else f"{name}.{way}" for name, way in seen.running]
    lines += [f"{name} failed" for name in seen.failed]
    lines += [f"{name} out of service" for name in seen.lost]
    return "\n".join(lines)


def _quoted(text: str) -> str:
    escaped = text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n")
    return f'"{escaped}"'


def alternatives_json(graph: AlternativesGraph) -> str:
    """The alternatives graph as a JSON document: events, states with what is seen of them, edges [from, event, to]."""
    states = []
    for state in range(len(graph.markings)):
        seen = graph.view(state)
        states.append(
            {
                "objectives": list(seen.objectives),
                "running": [{"activity": activity, "alternative": one} for activity, one in seen.running],
                "failed": list(seen.failed),
                "out_of_service": list(seen.lost),
                "outcome": seen.outcome or None,
            }
        )
    document = {
        "schema": GRAPH_SCHEMA,
        "mission": graph.net.name,
        "events": [{"name": e.name, "kind": e.kind.value, "subject": e.subject} for e in graph.net.events],
        "initial": graph.initial,
        "states": states,
        "edges": [[s, event, target] for s in range(len(graph.markings)) for event, target in graph.successors(s)],
    }
    return json.dumps(document, indent=1) + "\n"
