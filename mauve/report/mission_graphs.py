"""The stages of a mission as text: flattened objectives, alternatives graph."""

from __future__ import annotations

from collections.abc import Iterator

from mauve.mission.flatten import Fork, Leaf, Link, Node, Series, flatten
from mauve.mission.graph import AlternativesGraph
from mauve.mission.plan import Continue, Mission, Recover, Retry
from mauve.units import format_time


# ------------------------------------------------------------------------------------------------ objectives
def format_objectives(mission: Mission) -> str:
    """The objectives graph (mission paper, figure 5): every elementary objective at its place, in order, with what
    its success and its failure lead to. `=>` starts several at once, `<=` waits for them."""
    lines = [f"mission {mission.name}", "  start"]
    lines += _node(flatten(mission), "  ")
    lines += ["  success"]
    return "".join(line + "\n" for line in lines)


def _node(node: Node, indent: str) -> Iterator[str]:
    match node:
        case Leaf(path, objective):
            timeout = f"  timeout {format_time(objective.timeout)} -> failure" if objective.timeout is not None else ""
            yield f"{indent}-> {path}  does {', '.join(objective.activities)}{timeout}"
        case Series(_, links):
            for link in links:
                yield from _link(link, indent)
        case Fork(path, children):
            yield f"{indent}=> {path}"
            for link, mandatory in children:
                yield f"{indent}  {'mandatory' if mandatory else 'optional'}"
                yield from _link(link, indent + "    ")
            yield f"{indent}<= {path}"


def _link(link: Link, indent: str) -> Iterator[str]:
    yield from _node(link.node, indent)
    match link.step.on_failure:
        case Continue():
            yield f"{indent}   on failure: goes on"
        case Retry(times):
            yield f"{indent}   on failure: again, at most {times} time{'' if times == 1 else 's'}"
        case Recover(_, resume) if link.recovery is not None:
            yield f"{indent}   on failure:"
            yield from _node(link.recovery, indent + "     ")
            yield f"{indent}     then {'goes on' if resume else 'fails'}"
        case _:
            pass


# ------------------------------------------------------------------------------------------------ alternatives
def format_alternatives(graph: AlternativesGraph) -> str:
    """Each stable state with what a person sees of it, and where its events lead."""
    lines = [f"alternatives graph {graph.net.name}: {len(graph.markings)} states, {len(graph.events)} transitions"]
    for state in range(len(graph.markings)):
        seen = graph.view(state)
        running = [name if way == "only" else f"{name}.{way}" for name, way in seen.running]
        words = [seen.outcome] if seen.outcome else [", ".join(seen.objectives) or "not started"]
        words += [f"running {', '.join(running)}"] if running else []
        words += [f"failed {', '.join(seen.failed)}"] if seen.failed else []
        words += [f"out of service {', '.join(seen.lost)}"] if seen.lost else []
        lines.append(f"  {state}: {'; '.join(words)}")
        lines += [f"    {graph.net.events[event].name} -> {target}" for event, target in graph.successors(state)]
    return "".join(line + "\n" for line in lines)
