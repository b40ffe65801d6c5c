"""The resolved model as text, for `--emit model`: one line a fact, defaults marked."""

from __future__ import annotations

from collections.abc import Iterator

from mauve.model.model import (
    Architecture,
    Board,
    CallMethod,
    Component,
    Deployment,
    Instance,
    Model,
    Region,
    RunCodel,
    Setting,
    State,
    Step,
    Transition,
    Wait,
)
from mauve.units import format_time


def format_model(model: Model) -> str:
    """The whole model, in the order: components, architectures, boards, deployments, missions."""
    lines: list[str] = []
    for component in model.components:
        lines += _component(component)
    for architecture in model.architectures:
        lines += _architecture(architecture)
    for board in model.boards:
        lines += _board(board)
    for deployment in model.deployments:
        lines += _deployment(deployment)
    if model.missions is not None:
        from mauve.model.mission_print import format_missions

        lines += format_missions(model.missions)
    return "\n".join(lines)


def _component(component: Component) -> Iterator[str]:
    yield f"{component.kind.value} component {component.name}"
    for port in component.ports:
        yield f"  {port.kind.value} port {port.name}: {port.type}"
    for datum in component.data:
        yield f"  {'property' if datum.is_property else 'var'} {datum.name}: {datum.type}"
    if component.events:
        yield f"  event {', '.join(component.events)}"
    for method in component.methods:
        yield f"  method {method.name}({_parameters(method.parameters)})" + (
            f": {method.result}" if method.result else ""
        )
    for operation in component.operations:
        result = f": {operation.result}" if operation.result else ""
        signature = f"{operation.name}({_parameters(operation.parameters)}){result}"
        yield f"  operation {signature} = {operation.codel} runs in {operation.runs.value}"
    for codel in component.codels:
        parts = [f"  {'init ' if codel.init else ''}codel {codel.name}"]
        parts += [f"reads {', '.join(codel.reads)}"] if codel.reads else []
        parts += [f"writes {', '.join(codel.writes)}"] if codel.writes else []
        parts += [f"returns {codel.returns}"] if codel.returns else []
        parts += [f"wcet {format_time(codel.wcet)}"] if codel.wcet is not None else []
        parts += [f'symbol "{codel.symbol}"'] if codel.symbol else []
        yield " ".join(parts)
    for region in component.regions:
        yield from _region(region, "  ")


def _parameters(parameters: tuple[tuple[str, object], ...]) -> str:
    return ", ".join(f"{name}: {type_}" for name, type_ in parameters)


def _region(region: Region, indent: str) -> Iterator[str]:
    yield f"{indent}region {region.name or '(only)'} initial {region.initial}"
    for state in region.states:
        yield from _state(state, indent + "  ")


def _state(state: State, indent: str) -> Iterator[str]:
    yield f"{indent}{'final ' if state.final else ''}state {state.name}"
    for activity in state.activities:
        timing = f" every {format_time(activity.every)}" if activity.every else ""
        if activity.apart is not None:
            timing = " once" + (f" at least {format_time(activity.apart)} apart" if activity.apart else "")
        yield f"{indent}  {activity.role.value} {_steps(activity.steps)}{timing}"
    for region in state.regions:
        yield from _region(region, indent + "  ")
    for transition in state.transitions:
        yield f"{indent}  {_transition(transition)}"


def _transition(transition: Transition) -> str:
    parts = [f"-> {transition.target}"]
    parts += [f"on {transition.event}"] if transition.event else []
    parts += [f"when {', '.join(guard.codel for guard in transition.guards)}"] if transition.guards else []
    parts += [f"after {format_time(transition.after)}"] if transition.after is not None else []
    parts += [f"do {_steps(transition.do)}"] if transition.do else []
    parts += [f"emit {', '.join(transition.emit)}"] if transition.emit else []
    return " ".join(parts)


def _steps(steps: tuple[Step, ...]) -> str:
    return " then ".join(_step(step) for step in steps) or "(nothing)"


def _step(step: Step) -> str:
    match step:
        case RunCodel(codel=codel):
            return codel
        case CallMethod(method=method, arguments=arguments, result=result):
            return f"{result} = {method}({', '.join(arguments)})" if result else f"{method}({', '.join(arguments)})"


def _architecture(architecture: Architecture) -> Iterator[str]:
    yield f"architecture {architecture.name}"
    for instance in architecture.instances:
        yield "  " + _instance(instance)
    for data in architecture.data:
        policy = f" buffered size {data.size}" if data.size is not None else ""
        overflow = f" {data.overflow.value}" if data.overflow else ""
        yield f"  connect {data.source} -> {data.target}{policy}{overflow}"
    for service in architecture.services:
        yield f"  connect {service.caller} -> {service.provider}"
    for endpoint in architecture.external:
        yield f"  external {endpoint}"
    for flow in architecture.flows:
        steps = " -> ".join(step.instance for step in flow.steps)
        within = f" within {format_time(flow.within.value)} {flow.latency.value}" if flow.within is not None else ""
        yield f"  flow {flow.name}: {steps}{within}"


def _instance(instance: Instance) -> str:
    parts = [f"instance {instance.name}: {instance.component.name}"]
    if instance.period is not None:
        parts.append(_time_setting("sporadic" if instance.sporadic else "period", instance.period))
    if instance.deadline is not None:
        parts.append(_time_setting("deadline", instance.deadline))
    if instance.priority is not None:
        parts.append(f"priority {instance.priority.value}{_default(instance.priority)}")
    parts += [f"offset {format_time(instance.offset)}"] if instance.offset else []
    parts += [f"jitter {format_time(instance.jitter)}"] if instance.jitter else []
    return " ".join(parts)


def _time_setting(name: str, setting: Setting) -> str:
    return f"{name} {format_time(setting.value)}{_default(setting)}"


def _default(setting: Setting) -> str:
    return f" (default: {setting.default})" if setting.default else ""


def _board(board: Board) -> Iterator[str]:
    yield f'board {board.name} cpu "{board.core}" at {board.hertz}Hz'
    for memory in board.memories:
        write = f" write wait {_wait(memory.write_wait)}" if memory.write_wait else ""
        yield f"  memory {memory.name} at {memory.start:#010x} size {memory.size:#x} wait {_wait(memory.wait)}{write}"
    for feature in board.features:
        yield f"  {feature.name} {' '.join(feature.settings) or 'on'}"
    if board.context_switch:
        yield f"  context_switch {format_time(board.context_switch)}"
    if board.tick_every is not None:
        yield f"  tick every {format_time(board.tick_every)} cost {format_time(board.tick_cost)}"


def _wait(wait: Wait) -> str:
    return f"{wait.amount}cycles" if wait.in_cycles else format_time(wait.amount)


def _deployment(deployment: Deployment) -> Iterator[str]:
    kind = "abstract deployment" if deployment.abstract else "deployment"
    expect = " expect unschedulable" if deployment.expect_unschedulable else ""
    yield f"{kind} {deployment.name} of {deployment.architecture.name}{expect}"
    for node in deployment.nodes:
        yield f"  node {node.name} on {node.board.name}"
        for binary in node.binaries:
            yield f'    binary "{binary.path}"'
            for codel, symbol, _ in binary.symbols:
                yield f'      {codel} = "{symbol}"'
            for fact in binary.facts:
                yield f"      {fact.span.text}"
            for path, _ in binary.fact_files:
                yield f'      facts "{path}"'
        for assumption in node.assumptions:
            yield f"    assume {assumption.codel or 'others'} wcet {format_time(assumption.wcet)}"
        for interrupt in node.interrupts:
            cost = format_time(interrupt.wcet) if interrupt.wcet is not None else f'symbol "{interrupt.symbol}"'
            yield f"    interrupt {interrupt.name} every {format_time(interrupt.every)} {cost}"
        for thread in node.threads:
            yield f"    thread {thread.name} {{ {' '.join(str(member) for member, _ in thread.members)} }}"
        for target, cost_, _ in node.exchanges:
            yield f"    exchange {target + '.ports' if target else 'ports'} {format_time(cost_)}"
