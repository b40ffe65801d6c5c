"""Nets and alternatives graphs as DOT, for Graphviz: drawings that a person can read."""

from __future__ import annotations

from collections.abc import Iterable

from mauve.mission.graph import AlternativesGraph, StateView
from mauve.mission.net import EventKind, Level, Net

__all__ = ["graph_dot", "net_dot"]

LEVELS = {
    Level.EVENT: "white",
    Level.MISSION: "#dbe9d8",
    Level.STOP: "#f6e3c5",
    Level.CHOICE: "#d7e3f4",
    Level.RESOURCE: "#dddddd",
}
OUTCOMES = {"success": "#b7dfb0", "failure": "#f2b8b0", "": "white"}


def net_dot(net: Net) -> str:
    """The net: places as ellipses (a dot: it holds a token at the start), transitions as boxes, shaded by level.

    What belongs to one resource, activity or objective is framed; an event is written under its transition. Places that
    are only read have an arrow without a head.
    """
    lines = ["digraph net {", f"  label={_text(net.name)} rankdir=LR fontname=Helvetica;"]
    lines += ["  node [fontname=Helvetica fontsize=10]; edge [arrowsize=0.6];"]
    marked = set(net.initial)
    groups: dict[str, list[str]] = {}
    for at, name in enumerate(net.places):
        group = net.groups[at] if net.groups else ""
        token = "\u2022 " if at in marked else ""
        ellipse = f"p{at} [shape=ellipse height=0.3 label={_text(token + name.removeprefix(f'{group}.'))}];"
        groups.setdefault(group, []).append(ellipse)
    for at, (group, ellipses) in enumerate(groups.items()):
        if not group:
            lines += [f"  {ellipse}" for ellipse in ellipses]
            continue
        lines += [f"  subgraph cluster{at} {{", f"    label={_text(group)} color=gray;"]
        lines += [*(f"    {ellipse}" for ellipse in ellipses), "  }"]
    for at, one in enumerate(net.transitions):
        label = f"{one.name}\n{one.event}" if one.event else one.name
        lines.append(
            f"  t{at} [shape=box height=0.2 style=filled fillcolor={_text(LEVELS[one.level])} label={_text(label)}];"
        )
        read = set(one.before) & set(one.after)
        lines += [f"  p{place} -> t{at}{' [dir=none style=dashed]' if place in read else ''};" for place in one.before]
        lines += [f"  t{at} -> p{place};" for place in one.after if place not in read]
    return "\n".join([*lines, "}", ""])


def graph_dot(graph: AlternativesGraph, only_in_service: bool = False) -> str:
    """The alternatives graph: a box per stable state, framed with those in which the same objectives are pursued.

    Arrows between the same states share one line of text; the coming and going of hardware is dashed, success is thick.
    `only_in_service` leaves out states in which hardware is out of service: the mission as it should go.
    """
    views = [graph.view(state) for state in range(len(graph.markings))]
    shown = [state for state, seen in enumerate(views) if not (only_in_service and seen.lost)]
    lines = ["digraph alternatives {", f"  label={_text(graph.net.name)} fontname=Helvetica;"]
    lines += ["  node [shape=box style=filled fontname=Helvetica fontsize=10];"]
    lines += ["  edge [fontname=Helvetica fontsize=9 arrowsize=0.6];"]
    frames: dict[tuple[tuple[str, ...], str], list[int]] = {}
    for state in shown:
        frames.setdefault((views[state].objectives, views[state].outcome), []).append(state)
    for at, ((objectives, outcome), states) in enumerate(frames.items()):
        title = ", ".join(objectives) or outcome or "not started"
        lines += [f"  subgraph cluster{at} {{", f"    label={_text(title)} color=gray;"]
        lines += [f"    {_state(state, views[state])}" for state in states]
        lines += ["  }"]
    return "\n".join([*lines, *_arrows(graph, set(shown)), "}", ""])


def _state(state: int, seen: StateView) -> str:
    words = [activity if one == "only" else f"{activity}: {one}" for activity, one in seen.running]
    words += [f"{activity} FAILED" for activity in seen.failed]
    words += [f"{name} out of service" for name in seen.lost]
    colour = "#f6e3c5" if seen.failed else OUTCOMES[seen.outcome]
    return f"s{state} [label={_text(chr(10).join([str(state), *words]))} fillcolor={_text(colour)}];"


def _arrows(graph: AlternativesGraph, shown: set[int]) -> Iterable[str]:
    for source in sorted(shown):
        ways: dict[tuple[int, str], list[str]] = {}
        for event, target in graph.successors(source):
            kind = graph.net.events[event].kind
            hardware = kind in (EventKind.LOST, EventKind.RECOVERED)
            style = " style=dashed" if hardware else " penwidth=2" if kind is EventKind.OK else ""
            if target in shown:
                ways.setdefault((target, style), []).append(graph.net.events[event].name)
        for (target, style), names in ways.items():
            yield f"  s{source} -> s{target} [label={_text(chr(10).join(names))}{style}];"


def _text(text: str) -> str:
    """A quoted string; line ends become those of DOT."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n") + '"'
