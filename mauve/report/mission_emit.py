"""`mauvec mission --emit FORM`: a mission's stages, its net for other tools, its controller.

`dot` and `json` are the alternatives graph; `c` is the source of the controller, `c-header` its header.
"""

from __future__ import annotations

from mauve.verdict.missions import MissionResult

OF_GRAPH = ("alternatives", "dot", "json")
"""Forms of the alternatives graph, which a mission may be too large for."""


def emit_mission(form: str, result: MissionResult, stem: str | None = None) -> str:
    """The text of a form; `stem` names the files and functions of the controller in C. ValueError for a form of a graph
    that was not built."""
    if form in OF_GRAPH:
        return _of_graph(form, result)
    match form:
        case "objectives":
            from mauve.report.mission_graphs import format_objectives

            return format_objectives(result.plan)
        case "net" | "net-dot":
            from mauve.mission.dot import net_dot
            from mauve.mission.printing import net_text

            return net_text(result.net) if form == "net" else net_dot(result.net)
        case "pnml":
            from mauve.mission.pnml import pnml

            return pnml(result.net)
        case "tina":
            from mauve.mission.tina import tina

            return tina(result.net)
        case "lola":
            from mauve.mission.lola import lola

            return lola(result.net)
        case _:
            return _controller(form, result, stem)


def _of_graph(form: str, result: MissionResult) -> str:
    if result.graph is None:
        raise ValueError(f"the mission {result.mission.name} has too many states for one graph")
    match form:
        case "dot":
            from mauve.mission.dot import graph_dot

            return graph_dot(result.graph)
        case "json":
            import json

            from mauve.mission.graph_json import graph_document

            return json.dumps(graph_document(result.graph), indent=1) + "\n"
        case _:
            from mauve.report.mission_graphs import format_alternatives

            return format_alternatives(result.graph)


def _controller(form: str, result: MissionResult, stem: str | None) -> str:
    """The controller: rules where the graph is known, else the net itself, which it then runs."""
    from mauve.mission.controller import longest_of_parts, net_controller, rule_controller

    if result.graph is not None:
        controller = rule_controller(result.graph)
    else:
        parts = [one.graph for one in result.local]
        controller = net_controller(result.net, longest_of_parts(result.net, parts) if parts else None)
    if form == "python":
        from mauve.mission.controller_python import python_twin

        return python_twin(controller)
    from mauve.mission.controller_c import c_files

    files = c_files(controller, stem)
    return files.header if form == "c-header" else files.source
