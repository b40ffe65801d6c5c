"""`--emit STAGE`: any intermediate representation of a check as text."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from mauve.model.print import format_model
from mauve.syntax.print import format_ast
from mauve.timing.psm import format_psm
from mauve.timing.task import trace_length
from mauve.units import format_time
from mauve.verdict.result import CheckResult, DeploymentResult, executed


def emit(stage: str, result: CheckResult) -> str:
    """The text of a stage; empty where the check did not come that far. ValueError for a stage that does not exist."""
    match stage:
        case "ast":
            lines = [format_ast(module) for module in result.modules]
        case "model":
            lines = [format_model(result.model)] if result.model else []
        case "cfg":
            lines = list(_graphs(result))
        case "psm":
            lines = [line for deployment in result.deployments for line in _machines(deployment)]
        case "traces":
            lines = [line for deployment in result.deployments for line in _traces(deployment)]
        case "tasks":
            lines = [line for deployment in result.deployments for line in _tasks(deployment)]
        case "objectives" | "net" | "alternatives":
            from mauve.report.mission_emit import OF_GRAPH, emit_mission

            known = [one for one in result.missions if one.graph is not None or stage not in OF_GRAPH]
            lines = [emit_mission(stage, one).rstrip("\n") for one in known]
        case _:
            raise ValueError(f"there is no stage {stage}")
    return "".join(line + "\n" for line in lines)


def _machines(result: DeploymentResult) -> Iterator[str]:
    yield f"deployment {result.deployment.name}"
    for machines in result.machines.values():
        for machine in machines or ():
            yield format_psm(machine.psm, format_time)


def _traces(result: DeploymentResult) -> Iterator[str]:
    yield f"deployment {result.deployment.name}"
    for node in result.nodes:
        if node.analysis is None:
            continue
        tasks = [executed(placed, node.analysis) for placed in node.tasks.tasks]
        for task in tasks:
            trace = task.trace(min(64, trace_length(task, tasks)))
            yield f"  {task.name}: " + ", ".join(format_time(e) for e in trace)


def _tasks(result: DeploymentResult) -> Iterator[str]:
    yield f"deployment {result.deployment.name}"
    for node in result.nodes:
        yield f"  node {node.tasks.node.name}"
        for task in node.analysis.tasks if node.analysis else [placed.task for placed in node.tasks.tasks]:
            extra = f" jitter {format_time(task.jitter)}" if task.jitter else ""
            extra += f" blocking {format_time(task.blocking)}" if task.blocking else ""
            extra += f" overhead {format_time(task.overhead)}" if task.overhead else ""
            yield (
                f"    {task.kind.value} {task.name} priority {task.priority} period {format_time(task.period)} "
                f"deadline {format_time(task.deadline)} e1 {format_time(task.demand(1))}{extra}"
            )


def _graphs(result: CheckResult) -> Iterator[str]:
    """The control flow graph of every codel derived from a binary, and of what it calls, each once."""
    codels: dict[str, list[str | int]] = {}
    for deployment in result.deployments:
        for codel in deployment.codels:
            if codel.binary and codel.result is not None and codel.result.address is not None:
                codels.setdefault(codel.binary, []).append(codel.result.address)
    for path, addresses in codels.items():
        yield from function_graphs(path, addresses)[0]


def function_graphs(path: str, functions: Sequence[str | int]) -> tuple[list[str], list[str]]:
    """The texts of the graphs of functions and of what they call, each once; and why some have none."""
    from mauve.wcet.binary.callgraph import build_program
    from mauve.wcet.binary.elf import ElfProblem, load
    from mauve.wcet.binary.graph import format_cfg

    binary = load(path)
    if isinstance(binary, ElfProblem):
        return [], [binary.message]
    texts: dict[int, str] = {}
    problems: list[str] = []
    for function in functions:
        symbol = binary.function(function if isinstance(function, str) else f"{function:#x}")
        if isinstance(symbol, ElfProblem):
            problems.append(symbol.message)
            continue
        for key, cfg in build_program(binary, symbol.key).items():
            if key not in texts:
                texts[key] = format_cfg(cfg)
    return list(texts.values()), problems
