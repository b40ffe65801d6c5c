"""Threads: which regions each one executes, and that every region is executed by exactly one (seed 000, FraCC)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report
from mauve.model.execution import execution_settings
from mauve.model.model import Architecture, Deployment, Instance, Region, RegionId, Setting, Thread
from mauve.model.names import unknown
from mauve.model.periods import region_periods
from mauve.records import changed
from mauve.source import Span
from mauve.syntax import ast

PORTS = "ports"
"""The member of an instance that stands for its port exchange."""


def resolve_thread(
    item: ast.ThreadDecl, process: str, locked: bool, architecture: Architecture, report: Report
) -> Thread:
    """A thread with its members bound."""
    instances = {instance.name: instance for instance in architecture.instances}
    members = tuple(
        (member, path.span)
        for path in item.members
        if (architecture.complete or path.parts[0].text in instances)
        and (member := _member(path, instances, report)) is not None
    )
    settings = execution_settings(item.attributes, report)
    for kind in (ast.Execution.SPORADIC, ast.Execution.OFFSET):
        if kind in settings:
            message = f"a thread has no {kind.value}: it runs as often as its regions ask for"
            report.add(Diagnostic("MV407", message, Label(settings[kind].span or item.name.span)))
    jitter = settings.get(ast.Execution.JITTER)
    return Thread(
        item.name.text, members, settings.get(ast.Execution.PERIOD), settings.get(ast.Execution.DEADLINE),
        settings.get(ast.Execution.PRIORITY), jitter.value if jitter else 0, process, locked, item.name.span,
    )  # fmt: skip


def _member(path: ast.Path, instances: Mapping[str, Instance], report: Report) -> RegionId | None:
    first = path.parts[0]
    instance = instances.get(first.text)
    if instance is None:
        known = {name: i.span for name, i in instances.items()}
        message = f"there is no instance `{first}`"
        report.add(
            unknown("MV106", message, "a thread executes instances and regions", first.span, known, "an instance")
        )
        return None
    if not instance.active:
        message = f"`{first}` has nothing that a thread could execute"
        labels = (Label(instance.component.span, f"a {instance.component.kind.value} component"),)
        report.add(Diagnostic("MV407", message, Label(first.span), labels=labels))
        return None
    names = tuple(part.text for part in path.parts[1:])
    if names == (PORTS,):
        return RegionId(instance.name, names)
    regions = instance.component.regions
    for part in path.parts[1:]:
        region = next((r for r in regions if r.name == part.text), None)
        if region is None:
            known_regions = {r.name: r.span for r in regions if r.name}
            label = "its regions are " + ", ".join(f"`{n}`" for n in known_regions) if known_regions else "it has none"
            message = f"`{instance.component.name}` has no region `{part}`"
            report.add(unknown("MV100", message, label, part.span, list(known_regions), "a region"))
            return None
        regions = tuple(nested for state in region.states for nested in state.regions)
    return RegionId(instance.name, names)


def region_ids(instance: Instance) -> Iterator[tuple[RegionId, Region]]:
    """Every region of an instance, outer ones before inner ones; one without a name has the instance's path."""
    yield from _nested(instance.name, (), instance.component.regions)


def _nested(instance: str, path: tuple[str, ...], regions: tuple[Region, ...]) -> Iterator[tuple[RegionId, Region]]:
    for region in regions:
        here = (*path, region.name) if region.name else path
        yield RegionId(instance, here), region
        for state in region.states:
            yield from _nested(instance, here, state.regions)


def placement(deployment: Deployment) -> dict[RegionId, Thread]:
    """The thread that executes each region: that of the nearest member around it."""
    at = {member: thread for node in deployment.nodes for thread in node.threads for member, _ in thread.members}
    placed: dict[RegionId, Thread] = {}
    for instance in deployment.architecture.instances:
        for region, _ in region_ids(instance):
            around = (RegionId(instance.name, region.path[:n]) for n in range(len(region.path), -1, -1))
            thread = next((at[member] for member in around if member in at), None)
            if thread is not None:
                placed[region] = thread
    return placed


def in_threads(
    instance: Instance, placed: Mapping[RegionId, Thread], instances: Mapping[str, Instance]
) -> tuple[Instance, ...]:
    """An instance as each of the threads executes it that have a region of it, with the jitter of the thread and the
    deadline by which its jobs end. The instance itself where there are no threads."""
    threads = {id(thread): thread for region, thread in placed.items() if region.instance == instance.name}
    return tuple(_executed(instance, thread, instances) for thread in threads.values()) or (instance,)


def _executed(instance: Instance, thread: Thread, instances: Mapping[str, Instance]) -> Instance:
    members = [instances[name] for name in {member.instance for member, _ in thread.members}]
    written = [thread.deadline, *(member.deadline for member in members)]
    known = [setting for setting in written if setting is not None and not setting.default]
    # Without a deadline the period of the thread counts, which divides those of its regions.
    default = Setting(max(region_periods(instance), default=0), None, "the period")
    deadline = min(known, key=lambda setting: setting.value, default=default)
    return changed(instance, jitter=max([thread.jitter, *(member.jitter for member in members)]), deadline=deadline)


def check_placement(deployment: Deployment, report: Report) -> None:
    """MV402 for a region that two threads execute, MV403 for one that none executes while threads are declared."""
    threads = [thread for node in deployment.nodes for thread in node.threads]
    if not threads:
        return
    _check_twice(threads, report)
    placed = placement(deployment)
    for instance in deployment.architecture.instances:
        if not instance.active:
            continue
        missing = [region for region, _ in region_ids(instance) if region not in placed]
        whole = len(missing) == len(list(region_ids(instance)))
        for region in missing[:1] if whole else missing:
            name = instance.name if whole else str(region)
            message = f"no thread of `{deployment.name}` executes `{name}`"
            labels = (Label(instance.span, "the instance"),)
            help_ = Fix(f"name it in a thread: `thread NAME {{ {name} }}`")
            report.add(Diagnostic("MV403", message, Label(deployment.span), labels=labels, help=help_))


def _check_twice(threads: list[Thread], report: Report) -> None:
    first: dict[RegionId, tuple[Thread, Span]] = {}
    for thread in threads:
        for member, span in thread.members:
            if member in first:
                other, earlier = first[member]
                what = "region" if member.path else "instance"
                where = "two threads" if other is not thread else f"the thread `{thread.name}` twice"
                message = f"{what} `{member}` runs in {where}"
                labels = (Label(earlier, "first here"),)
                report.add(Diagnostic("MV402", message, Label(span, "and here"), labels=labels))
            else:
                first[member] = (thread, span)
