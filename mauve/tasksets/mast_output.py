"""A task set as MAST text: what MAST cannot say is an error at the task, nothing is left out."""

from __future__ import annotations

import re
from collections.abc import Iterator
from fractions import Fraction

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report
from mauve.tasksets.numbers import format_number
from mauve.tasksets.taskset import Document, Entry, Path, Scheduler, TaskSet, priorities

LEAST, GREATEST = 1, 32767
"""MAST's priorities. Others are replaced by their ranks: only their order matters."""

_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_.]*")


def format_mast(document: Document, report: Report) -> str | None:
    """The one set of a document as MAST text; None after reporting what keeps it from that (MV627)."""
    if len(document.sets) != 1 or document.sets[0] is None:
        if all(one is not None for one in document.sets):
            report.add(Diagnostic("MV627", "a MAST model holds one task set, and the file has a list of them"))
        return None
    taskset = document.sets[0]
    faults = list(_faults(taskset))
    for message, path in faults:
        report.add(Diagnostic("MV627", message, Label(taskset.spans.of(path))))
    return None if faults else "\n".join(_model(taskset))


def _faults(taskset: TaskSet) -> Iterator[tuple[str, Path]]:
    """What MAST has no place for, and where it stands."""
    if taskset.interrupts:
        yield "interrupts are not written as MAST text", (*taskset.path, "interrupts")
    seen: dict[str, str] = {}
    for entry in taskset.tasks:
        name, path = entry.name, entry.path
        names = [name, *(resource for resource, _ in entry.sections)]
        for one in names:
            if not _NAME.fullmatch(one):
                yield f"`{one}` is no name in MAST: letters, digits, `_` and `.`", path
        if seen.setdefault(name.lower(), name) != name:
            yield f"`{name}` and `{seen[name.lower()]}` are one name in MAST", path
        if entry.work.constant is None:
            yield f"MAST has no place for the varying costs of `{name}`", path
        if entry.blocking:
            yield f"MAST has no place for the blocking given for `{name}`: it derives blocking", (*path, "B")
        if entry.tail or entry.unpreempted:
            yield f"MAST has no place for the sections of `{name}` that nothing preempts", path
        if sum((length for _, length in entry.sections), Fraction(0)) > (entry.work.constant or 0):
            yield f"the sections of `{name}` are longer than its cost together", (*path, "cs")


def _model(taskset: TaskSet) -> Iterator[str]:
    show = format_number
    yield "Processing_Resource ("
    yield "   Type                   => Regular_Processor,"
    yield "   Name                   => processor,"
    yield "   Max_Interrupt_Priority => 32768,"
    yield "   Min_Interrupt_Priority => 32768,"
    yield "   Speed_Factor           => 1.0);"
    yield ""
    yield "Scheduler ("
    yield "   Type   => Primary_Scheduler,"
    yield "   Name   => scheduler,"
    yield "   Host   => processor,"
    yield "   Policy =>"
    yield "      (Type                 => Fixed_Priority,"
    yield f"       Worst_Context_Switch => {show(taskset.context_switch)},"
    yield f"       Max_Priority         => {GREATEST},"
    yield f"       Min_Priority         => {LEAST}));"
    yield ""
    resources = dict.fromkeys(resource for entry in taskset.tasks for resource, _ in entry.sections)
    for resource in resources:
        yield "Shared_Resource ("
        yield "   Type        => Immediate_Ceiling_Resource,"
        yield f"   Name        => {resource},"
        yield "   Preassigned => NO);"
        yield ""
    for entry, priority in zip(taskset.tasks, _ranks(priorities(taskset)), strict=True):
        yield from _task(entry, priority, entry.preemptive and taskset.scheduler is Scheduler.PREEMPTIVE)


def _ranks(given: tuple[int, ...]) -> list[int]:
    if all(LEAST <= priority <= GREATEST for priority in given):
        return list(given)
    rank = {priority: place for place, priority in enumerate(sorted(set(given)), LEAST)}
    return [rank[priority] for priority in given]


def _task(entry: Entry, priority: int, preemptive: bool) -> Iterator[str]:
    name, show = entry.name, format_number
    yield "Scheduling_Server ("
    yield "   Type                    => Regular,"
    yield f"   Name                    => {name},"
    yield "   Server_Sched_Parameters =>"
    yield f"      (Type         => {'Fixed_Priority_Policy' if preemptive else 'Non_Preemptible_FP_Policy'},"
    yield f"       The_Priority => {priority},"
    yield "       Preassigned  => YES),"
    yield "   Scheduler               => scheduler);"
    yield ""
    yield from _operations(entry)
    yield "Transaction ("
    yield "   Type            => Regular,"
    yield f"   Name            => {name},"
    yield "   External_Events =>"
    yield "      ((Type       => Periodic,"
    yield f"        Name       => {name}.arrival,"
    yield f"        Period     => {show(entry.period)},"
    yield f"        Max_Jitter => {show(entry.jitter)})),"
    yield "   Internal_Events =>"
    yield "      ((Type                => Regular,"
    yield f"        Name                => {name}.end,"
    yield "        Timing_Requirements =>"
    yield "           (Type             => Hard_Global_Deadline,"
    yield f"            Deadline         => {show(entry.period if entry.deadline is None else entry.deadline)},"
    yield f"            Referenced_Event => {name}.arrival))),"
    yield "   Event_Handlers  =>"
    yield "      ((Type               => Activity,"
    yield f"        Input_Event        => {name}.arrival,"
    yield f"        Output_Event       => {name}.end,"
    yield f"        Activity_Operation => {name},"
    yield f"        Activity_Server    => {name})));"
    yield ""


def _operations(entry: Entry) -> Iterator[str]:
    """A simple operation; with sections, one for each and one for the rest, and a composite of them."""
    cost = entry.work.constant or Fraction(0)
    if not entry.sections:
        yield from _simple(entry.name, cost, "")
        return
    parts = [f"{entry.name}.section{number}" for number in range(1, len(entry.sections) + 1)]
    for part, (resource, length) in zip(parts, entry.sections, strict=True):
        yield from _simple(part, length, resource)
    rest = cost - sum((length for _, length in entry.sections), Fraction(0))
    if rest:
        parts.append(f"{entry.name}.rest")
        yield from _simple(parts[-1], rest, "")
    yield "Operation ("
    yield "   Type                     => Composite,"
    yield f"   Name                     => {entry.name},"
    yield f"   Composite_Operation_List => ({', '.join(parts)}));"
    yield ""


def _simple(name: str, cost: Fraction, resource: str) -> Iterator[str]:
    yield "Operation ("
    yield "   Type                      => Simple,"
    yield f"   Name                      => {name},"
    if resource:
        yield f"   Shared_Resources_List     => ({resource}),"
    yield f"   Worst_Case_Execution_Time => {format_number(cost)});"
    yield ""
