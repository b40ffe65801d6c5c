"""The composition of the stages, in the order of figure 3 of the MAUVE paper:

    text -> AST -> model -> [per deployment] codels -> WCETs -> PSMs -> tasks -> response times -> verdict

Each stage is a function from one intermediate representation to the next; user errors go to the report. What a stage
produced stays in the result, so that `--emit` can print it and a person can follow a number back to its instruction.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from mauve.diagnostics.diagnostic import Diagnostic, Report
from mauve.diagnostics.suggest import closest
from mauve.lower.activation import settle
from mauve.lower.codels import CodelPlan, CodelTime, choose_times, plan_codels
from mauve.lower.machines import build_machines
from mauve.lower.placed import NodeTasks
from mauve.lower.platform import timing_platform, wcet_board
from mauve.lower.queues import check_overflow
from mauve.lower.tasks import task_sets
from mauve.model.boards import resolve_board
from mauve.model.model import Deployment, Model
from mauve.model.resolve import resolve
from mauve.records import changed, record
from mauve.syntax.ast import BoardDecl, DeploymentDecl, Module, String
from mauve.syntax.load import load_modules, standard_module
from mauve.timing.response import Method
from mauve.verdict.deadlines import report_expectation, report_node
from mauve.verdict.derivation import Derivation, declared_handlers
from mauve.verdict.flows import check_flows, report_flows
from mauve.verdict.globals import check_globals
from mauve.verdict.result import CheckResult, DeploymentResult, NodeResult

if TYPE_CHECKING:
    from mauve.timing.priorities import Policy
    from mauve.timing.response import Analysis
    from mauve.timing.simulation.horizon import Asked
    from mauve.timing.simulation.outcome import Simulated
    from mauve.timing.simulation.system import Settings as SimulationSettings
    from mauve.verdict.missions import MissionOptions, MissionResult
    from mauve.verdict.modes import ModesResult
    from mauve.wcet.batch import Progress, Settings
    from mauve.wcet.flow.facts import Fact
    from mauve.wcet.hardware.board import Board
    from mauve.wcet.missing import MissingIn
    from mauve.wcet.result import WcetResult


@record
class Options:
    """What a check was asked to do. `sensitivity` asks how much may change, `priorities` for those of a policy.
    `deployment` None means all that are not abstract; `cache` whether results of
    earlier runs may be used and kept; `workers` how many processes may analyse binaries; `progress` is told how far
    they are."""

    deployment: str | None = None
    method: Method = Method.TRACE
    cache: bool = True
    workers: int = 1
    progress: Progress | None = None
    sensitivity: bool = False
    priorities: Policy | None = None


def read_model(path: str, report: Report) -> tuple[tuple[Module, ...], Model | None]:
    """Text -> AST -> model, of a file and its imports. None where there is a syntax error."""
    modules = load_modules(Path(path), report)
    if not modules or report.has_errors:
        return modules, None
    return modules, resolve(modules, _standard_boards(modules, report), report)


def _standard_boards(modules: tuple[Module, ...], report: Report) -> tuple[Module, ...]:
    """The module of the boards that a node may name by a string; read only where some node does."""
    if not any(_names_board(module) for module in modules):
        return ()
    module = standard_module("boards", report)
    if module is None:
        return ()
    imported = (m for m in modules if m == module)  # `import std.boards` has read it: its boards are declared once
    return (next(imported, module),)


def _names_board(module: Module) -> bool:
    return any(
        isinstance(node.board, String)
        for declaration in module.declarations
        if isinstance(declaration, DeploymentDecl)
        for node in declaration.nodes
    )


def check(path: str, options: Options, report: Report) -> CheckResult:
    """The main job: does every deadline of the file's deployments hold. Analyses run on models without errors only."""
    modules, model = read_model(path, report)
    if model is None or report.has_errors:
        return CheckResult(path, modules, model, ())
    wanted = _wanted(model, options.deployment)
    missions = check_missions(model, None, report)
    results = tuple(check_deployment(deployment, options, report, missions) for deployment in wanted)
    return CheckResult(path, modules, model, results, missions)


def check_missions(
    model: Model, options: MissionOptions | None, report: Report, names: Sequence[str] | None = None
) -> tuple[MissionResult, ...]:
    """Missions -> nets -> alternatives graphs -> properties -> verdicts; imported only where there are missions.

    `options` None looks at as much as a check has time for, `names` None means all missions.
    """
    if model.missions is None or not model.missions.missions:
        return ()
    from mauve.verdict.mission_messages import report_mission
    from mauve.verdict.missions import CHECKED, check_mission

    chosen = [mission for mission in model.missions.missions if names is None or mission.name in names]
    results = tuple(check_mission(mission, options or CHECKED) for mission in chosen)
    for result in results:
        report_mission(result, report)
    return results


def _wanted(model: Model, name: str | None) -> list[Deployment]:
    """The deployment of this name, else all that are not abstract."""
    chosen = [d for d in model.deployments if name in (None, d.name)]
    return [d for d in chosen if not d.abstract or d.name == name]


def check_deployment(
    deployment: Deployment, options: Options, report: Report, missions: Sequence[MissionResult] = ()
) -> DeploymentResult:
    """Codels -> WCETs -> PSMs -> tasks -> response times -> verdict, of one deployment and the missions it carries."""
    result = analyse_deployment(deployment, options, report, missions)
    for node in result.nodes:
        if node.analysis is not None and not result.modes:
            report_node(deployment, node.tasks, node.analysis, report)
    for overflow in result.overflows:
        report.add(overflow)
    check_globals([node.tasks for node in result.nodes], result.codels, report)
    report_flows(deployment, result.flows, report)
    for modes in result.modes:
        from mauve.verdict.mode_messages import report_modes

        report_modes(modes, deployment, report)
    if result.proposals:
        from mauve.verdict.sensitivity import report_proposal

        for node, proposal in zip(result.nodes, result.proposals, strict=True):
            report_proposal(deployment, node.tasks, proposal, report)
    report_expectation(deployment, result.holds, result.complete, report)
    return result


def analyse_deployment(
    deployment: Deployment, options: Options, report: Report, missions: Sequence[MissionResult] = ()
) -> DeploymentResult:
    """Codels -> WCETs -> PSMs -> tasks -> response times; missed deadlines are in the result, not in the report."""
    plans = plan_codels(deployment)
    derivation = _derive(deployment, plans, options, report)
    codels = choose_times(plans, deployment, derivation.codels, report)
    times = {codel.plan.id: codel.time for codel in codels if codel.time is not None}
    built = build_machines(deployment, times)
    placed = task_sets(deployment, built, times, report)
    if missions:
        from mauve.lower.modes import with_controllers

        placed = with_controllers(placed, [result.mission for result in missions], report)
    nodes = _respond(deployment, placed, derivation, options.method)
    complete = derivation.complete and _complete(codels, nodes)
    modes = _modes(deployment, missions, placed, derivation, options.method, report) if complete else ()
    analysed = [(node.tasks, node.analysis) for node in nodes] if complete else []
    if modes:
        from mauve.verdict.modes import in_modes

        analysed = in_modes(analysed, modes)
    flows = check_flows(deployment, analysed) if complete else ()
    overflows = check_overflow(deployment, analysed)
    met = all(node.analysis is not None and node.analysis.schedulable for node in nodes)
    if modes:
        met = all(mode.holds for mode in modes)
    holds = complete and met and not overflows and all(flow.holds for flow in flows)
    result = DeploymentResult(deployment, codels, built, nodes, complete, holds, flows, modes, overflows)
    return _varied(result, placed, derivation, options) if complete else result


def _modes(
    deployment: Deployment,
    missions: Sequence[MissionResult],
    placed: Sequence[NodeTasks],
    derivation: Derivation,
    method: Method,
    report: Report,
) -> tuple[ModesResult, ...]:
    """The modes of each mission that runs instances of this deployment; empty where those of one are not known: then
    all tasks together must hold their deadlines."""
    if not missions:
        return ()
    from mauve.verdict.modes import check_modes

    def respond(nodes: Sequence[NodeTasks]) -> tuple[tuple[NodeTasks, Analysis | None], ...]:
        return tuple((node.tasks, node.analysis) for node in _respond(deployment, nodes, derivation, method))

    found = [check_modes(result, deployment, placed, respond, report) for result in missions]
    known = tuple(each for each in found if each is not None)
    return known if len(known) == len(missions) else ()


def _varied(
    result: DeploymentResult, placed: Sequence[NodeTasks], derivation: Derivation, options: Options
) -> DeploymentResult:
    """The result with what else was asked for; imported only then."""
    if not options.sensitivity and options.priorities is None:
        return result
    from mauve.verdict.sensitivity import node_sensitivity, propose

    platforms = [timing_platform(node.node, derivation.handlers) for node in placed]
    deployment, policy, places = result.deployment, options.priorities, range(len(placed))
    if options.sensitivity:
        found = tuple(node_sensitivity(deployment, placed, platforms, at) for at in places)
        result = changed(result, sensitivity=found)
    if policy is not None:
        result = changed(result, proposals=tuple(propose(deployment, placed, platforms, at, policy) for at in places))
    return result


def _derive(deployment: Deployment, plans: tuple[CodelPlan, ...], options: Options, report: Report) -> Derivation:
    """What the binaries say; the analysis of binaries is imported only where there are some."""
    if not any(node.binaries for node in deployment.nodes):
        return Derivation({}, declared_handlers(deployment), True)
    from mauve.verdict.derive import derive

    return derive(deployment, plans, options.cache, report, options.workers, options.progress)


def _respond(
    deployment: Deployment, placed: Sequence[NodeTasks], derivation: Derivation, method: Method
) -> tuple[NodeResult, ...]:
    platforms = [timing_platform(node.node, derivation.handlers) for node in placed]
    analyses = settle(deployment, placed, platforms, method)
    return tuple(NodeResult(*pair) for pair in zip(analyses.nodes, analyses.results, strict=True))


def _complete(codels: Sequence[CodelTime], nodes: Sequence[NodeResult]) -> bool:
    timed = all(codel.time is not None for codel in codels)
    return bool(nodes) and timed and all(node.tasks.complete and node.analysis is not None for node in nodes)


def simulate(
    path: str, options: Options, settings: SimulationSettings, asked: Asked, report: Report
) -> tuple[CheckResult, tuple[Simulated, ...]]:
    """One run of the schedule of each deployment that is complete, beside the analysis that it rests on."""
    modules, model = read_model(path, report)
    if model is None or report.has_errors:
        return CheckResult(path, modules, model, ()), ()
    results = tuple(
        analyse_deployment(deployment, options, report) for deployment in _wanted(model, options.deployment)
    )
    done = tuple(simulate_deployment(path, result, settings, asked) for result in results if result.complete)
    return CheckResult(path, modules, model, results), done


def simulate_deployment(path: str, result: DeploymentResult, settings: SimulationSettings, asked: Asked) -> Simulated:
    """Tasks -> one schedule per node, of one deployment."""
    from mauve.lower.simulated import simulated_processors
    from mauve.timing.simulation.engine import simulate as run
    from mauve.timing.simulation.horizon import horizon, windowed
    from mauve.timing.simulation.outcome import Simulated

    deployment = result.deployment
    times = {codel.plan.id: codel.time for codel in result.codels if codel.time is not None}
    analysed = [(node.tasks, node.analysis) for node in result.nodes if node.analysis is not None]
    processors = simulated_processors(deployment, [(tasks, found.tasks) for tasks, found in analysed], times)
    reach = horizon(processors, asked)
    outcomes = tuple(run(processor, windowed(settings, reach, asked)) for processor in processors)
    bounds = tuple({one.task: one.wcrt for one in found.results} for _, found in analysed)
    expected = deployment.expect_unschedulable is not None
    return Simulated(deployment.name, path, "ps", outcomes, bounds, reach, expected)


# ------------------------------------------------------------------------------------- functions without a model
@record
class UnknownBoard:
    """There is no such board; `message` says which ones there are."""

    message: str


def find_board(name: str, report: Report) -> Board | UnknownBoard | None:
    """The board `NAME` of the standard library, or `FILE.mauve:NAME`; None where the file or the board is in error."""
    path, separator, board = name.rpartition(":")
    found: tuple[Module, ...]
    if separator:
        found = load_modules(Path(path), report)[:1]
    else:
        standard = standard_module("boards", report)
        found = (standard,) if standard is not None else ()
    if report.has_errors or not found:
        return None
    declared = {d.name.text: d for module in found for d in module.declarations if isinstance(d, BoardDecl)}
    wanted = declared.get(board)
    if wanted is None:
        where = f"in `{path}`" if separator else "in the standard library"
        names = closest(board, declared) or tuple(declared)
        known = f"; there is {', '.join(f'`{near}`' for near in names)}" if names else ""
        example = "" if separator or closest(board, declared) else ", or name one of a model: FILE.mauve:BOARD"
        return UnknownBoard(f"there is no board `{board}` {where}{known}{example}")
    resolved = resolve_board(wanted, report)
    return wcet_board(resolved) if resolved is not None and not report.has_errors else None


def wcet(
    elf: str,
    functions: Sequence[str],
    settings: Settings,
    report: Report,
    workers: int = 1,
    progress: Progress | None = None,
) -> tuple[WcetResult, ...]:
    """The bounds of functions of an executable, of all with a symbol where none is named; no results where the
    executable cannot be read."""
    from mauve.verdict.binaries import CODES
    from mauve.verdict.functions import function_diagnostics
    from mauve.wcet.batch import all_functions, analyse_batch, near_names
    from mauve.wcet.result import Problem, ProblemKind

    wanted = functions or all_functions(elf)
    if isinstance(wanted, Problem):
        report.add(Diagnostic(CODES[wanted.kind], wanted.message, place=elf))
        return ()
    results = analyse_batch(elf, wanted, settings, workers, progress)
    unknown = {r.name: near_names(elf, r.name) for r in results for p in r.problems if p.kind is ProblemKind.SYMBOL}
    for diagnostic in function_diagnostics(elf, results, unknown):
        report.add(diagnostic)
    return results


def missing(
    elf: str,
    functions: Sequence[str],
    facts: Sequence[Fact],
    initial_data: bool,
    timeout: float | None,
    report: Report,
) -> tuple[MissingIn, ...] | None:
    """What the bounds of functions of an executable still need; what several of them need once. None where there is no
    such executable or function."""
    from mauve.verdict.functions import problem_diagnostic
    from mauve.wcet.batch import near_names
    from mauve.wcet.missing import missing_facts
    from mauve.wcet.result import Problem, ProblemKind

    found: dict[str, MissingIn] = {}
    for name in functions:
        one = missing_facts(elf, name, facts, initial_data=initial_data, timeout=timeout)
        if isinstance(one, Problem):
            near = near_names(elf, name) if one.kind is ProblemKind.SYMBOL else ()
            report.add(problem_diagnostic(elf, one, near))
            continue
        for part in one:
            found.setdefault(part.function, part)
    return None if report.has_errors else tuple(found.values())
