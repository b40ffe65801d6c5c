"""The answer to a task set as JSON, schema mauve.schedule/1 (docs/schema/schedule-1.schema.json). Times in its unit."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

from mauve.diagnostics.diagnostic import Diagnostic
from mauve.diagnostics.render_json import to_plain
from mauve.tasksets.answer import Answer, TaskAnswer
from mauve.timing.bill import BillLine, BillWork, worst_bill
from mauve.timing.transitions import state_responses, transition_responses

SCHEMA = "mauve.schedule/1"

MOST_BREAKDOWNS = 500
"""Larger sets come without breakdowns: with n tasks these have up to n^2 lines."""


def schedule_document(
    answers: Sequence[Answer | None], listed: bool, diagnostics: Sequence[Diagnostic], version: str
) -> object:
    """One answer, or a list of them for a list of sets; messages are in the first that they can belong to.

    A set that is in error has no tasks, and null where an answer would be.
    """
    split = _by_set(answers, listed, diagnostics)
    documents = [_answer(one, messages, version) for one, messages in zip(answers, split, strict=True)]
    return documents if listed else documents[0]


def _by_set(
    answers: Sequence[Answer | None], listed: bool, diagnostics: Sequence[Diagnostic]
) -> list[list[Diagnostic]]:
    """Each message with the set that its place lies in."""
    found: list[list[Diagnostic]] = [[] for _ in answers]
    if not listed or not answers:
        return [list(diagnostics)] if answers else []
    spans = next((one.taskset.spans for one in answers if one is not None), None)
    starts = [spans.of((index,)).start if spans else 0 for index in range(len(answers))]
    for diagnostic in diagnostics:
        at = diagnostic.primary.span.start if diagnostic.primary else 0
        index = max((i for i, start in enumerate(starts) if start <= at), default=0)
        found[index].append(diagnostic)
    return found


def _answer(answer: Answer | None, diagnostics: Sequence[Diagnostic], version: str) -> dict[str, object]:
    document: dict[str, object] = {"schema": SCHEMA, "tool": {"name": "mauvec", "version": version}}
    if answer is None:
        document |= {"name": None, "scheduler": None, "unit": None, "method": None, "priorities": None}
        document |= {"schedulable": None, "utilisation": None, "tasks": [], "interrupts": [], "sensitivity": None}
    else:
        taskset = answer.taskset
        detailed = len(answer.tasks) <= MOST_BREAKDOWNS
        document |= {
            "name": taskset.name or None,
            "scheduler": taskset.scheduler.value,
            "unit": taskset.unit,
            "method": answer.method.value,
            "priorities": answer.policy.value if answer.assignment.priorities is not None else "given",
            "schedulable": answer.holds,
            "utilisation": float(answer.load),
            "tasks": [_task(answer, one, detailed) for one in answer.tasks],
            "interrupts": [
                {"name": task.name, "T": answer.time(task.period), "C": answer.time(task.demand(1))}
                for task in answer.handlers
            ],
            "sensitivity": _sensitivity(answer),
        }
    document["diagnostics"] = [to_plain(diagnostic) for diagnostic in diagnostics]
    return document


def _task(answer: Answer, one: TaskAnswer, detailed: bool) -> dict[str, object]:
    result, task, time = one.result, one.task, answer.time
    blocker = one.blocker
    return {
        "name": task.name,
        "wcrt": None if result.wcrt is None else time(result.wcrt),
        "deadline": time(result.deadline),
        "schedulable": result.schedulable,
        "blocking": time(task.blocking),
        "blocked_by": None
        if blocker is None
        else {"task": blocker.holder, "resource": blocker.resource or None, "length": time(blocker.length)},
        "utilisation": float(task.load),
        "slack": None if result.slack is None else time(result.slack),
        "priority": task.priority,
        "period": time(task.period),
        "jitter": time(task.jitter),
        "cost": time(task.demand(1)),
        "method": result.method.value,
        "reason": result.reason.value if result.reason else None,
        "responsible": list(result.responsible),
        "caveats": [caveat.value for caveat in result.caveats],
        "busy_period": None if result.busy_period is None else time(result.busy_period),
        "breakdown": _breakdown(answer, one) if detailed else None,
        "transitions": _transitions(answer, one) if detailed else None,
    }


def _breakdown(answer: Answer, one: TaskAnswer) -> dict[str, object] | None:
    """The window of the job that attains the response: wcrt = jitter + window - (job - 1) x period."""
    bill = worst_bill(answer.analysis, one.entry.name)
    if bill is None:
        return None
    return {
        "job": bill.job,
        "window": answer.time(bill.window),
        "jitter": answer.time(one.task.jitter),
        "blocking": answer.time(bill.blocking),
        "own": _line(answer, bill.own),
        "interference": [_line(answer, line) for line in bill.others],
    }


def _line(answer: Answer, line: BillLine) -> dict[str, object]:
    return {
        "task": line.task,
        "kind": line.kind.value,
        "jobs": line.jobs,
        "cost": answer.time(line.cost),
        "switches": answer.time(line.overhead),
        "run": _run(answer, line.work[0]) if line.work else None,
    }


def _run(answer: Answer, work: BillWork) -> list[dict[str, object]] | None:
    """The transitions of a machine that cost it."""
    if not work.run:
        return None
    return [{"src": one.source, "dst": one.target, "cost": answer.time(one.cost)} for one in work.run]


def _transitions(answer: Answer, one: TaskAnswer) -> dict[str, object] | None:
    """Of a machine: the response of a job by the transition that it takes, and by the state that it starts in."""
    if one.entry.work.machine is None:
        return None
    found = transition_responses(answer.analysis, one.entry.name)
    edges = [
        {
            "src": each.transition.source,
            "dst": each.transition.target,
            "cost": answer.time(each.transition.cost),
            "wcrt": answer.time(each.wcrt),
        }
        for each in found
    ]
    states = [{"state": each.state, "wcrt": answer.time(each.wcrt)} for each in state_responses(found)]
    return {"edges": edges, "states": states}


def _sensitivity(answer: Answer) -> dict[str, object] | None:
    found = answer.sensitivity
    if found is None:
        return None

    def time(ticks: int | None) -> Fraction | None:
        return None if ticks is None else answer.varied(ticks)

    factor = found.speed.factor
    return {
        "speed": None if factor is None else float(rounded_up(factor)),
        "speed_exact": str(factor) if factor is not None and found.speed.exact else None,
        "costs": [
            {
                "what": one.what.value,
                "name": one.name,
                "task": one.task or None,
                "now": time(one.now),
                "at_most": time(one.at_most),
            }
            for one in found.costs
        ],
        "periods": [{"task": one.task, "now": time(one.now), "at_least": time(one.at_least)} for one in found.periods],
        "priorities": [
            {"task": one.range.task, "now": one.range.now, "ranges": [list(each) for each in one.range.ranges]}
            for one in answer.tasks
            if one.range is not None
        ],
    }


def rounded_up(factor: Fraction) -> Fraction:
    """A speed with six decimals, never below the truth."""
    return Fraction(-(-factor * 10**6 // 1), 10**6)
