"""The answer to a task set as text: a row per task, the verdict, and what may change."""

from __future__ import annotations

from collections.abc import Sequence

from mauve.diagnostics.style import Role, Style
from mauve.report.schedule_json import rounded_up
from mauve.report.table import Align, Cell, Column, Row, format_table, percent
from mauve.tasksets.answer import Answer, TaskAnswer
from mauve.tasksets.numbers import format_number
from mauve.timing.priorities import Policy, PriorityRange
from mauve.timing.response import Method
from mauve.timing.shrink import What
from mauve.timing.transitions import state_responses, transition_responses

TASKS = (
    Column("task", elastic=True),
    Column("period", Align.RIGHT),
    Column("priority", Align.RIGHT),
    Column("cost", Align.RIGHT),
    Column("jitter", Align.RIGHT),
    Column("blocking", Align.RIGHT),
    Column("by", elastic=True),
    Column("load", Align.RIGHT),
    Column("WCRT", Align.RIGHT),
    Column("deadline", Align.RIGHT),
    Column("slack", Align.RIGHT),
    Column("verdict"),
)

SLACKS = (
    Column("task", elastic=True),
    Column("cost", Align.RIGHT),
    Column("may be", Align.RIGHT),
    Column("period", Align.RIGHT),
    Column("may be", Align.RIGHT),
    Column("priority", Align.RIGHT),
    Column("may be"),
)

STATES = (Column("machine of", elastic=True), Column("state", elastic=True), Column("WCRT", Align.RIGHT))

POLICIES = {
    Policy.GIVEN: "",
    Policy.RATE_MONOTONIC: ", rate monotonic priorities",
    Policy.DEADLINE_MONOTONIC: ", deadline monotonic priorities",
    Policy.OPTIMAL: ", optimal priorities (Audsley)",
}


def format_schedule(answers: Sequence[Answer | None], style: Style, limit: int | None = None) -> str:
    """The sets one after the other, each with a title where there are several."""
    blocks = []
    for index, answer in enumerate(answers):
        if answer is None:
            if len(answers) > 1:
                blocks.append([style.paint(Role.ERROR, f"task set {index + 1}: in error")])
        else:
            title = answer.taskset.name or (f"task set {index + 1}" if len(answers) > 1 else "")
            blocks.append(_answer(answer, title, style, limit))
    return "\n".join("".join(line + "\n" for line in block) for block in blocks)


def _answer(answer: Answer, title: str, style: Style, limit: int | None) -> list[str]:
    unit = answer.taskset.unit
    words = f"{title}: " if title else ""
    words += f"{answer.taskset.scheduler.value} fixed priorities, times in {unit}" if unit not in ("", "1") else (
        f"{answer.taskset.scheduler.value} fixed priorities"
    )
    lines = [style.paint(Role.MESSAGE, words), ""]
    rows = [_task(answer, one) for one in answer.tasks]
    rows += [_handler(answer, index) for index in range(len(answer.handlers))]
    total: list[Cell | str] = [""] * len(TASKS)
    total[0], total[7] = Cell("load", Role.MESSAGE), Cell(percent(float(answer.load)), Role.MESSAGE)
    lines += format_table(TASKS, [*rows, total], style, limit=limit)
    if any(one.entry.priority is None for one in answer.tasks) and answer.policy is Policy.GIVEN:
        lines.append("  * by default: the shorter period is more urgent")
    policy = POLICIES[answer.policy] if answer.assignment.priorities is not None else ""
    lines.append(f"  responses from the nominal arrival, by the {answer.method.value} method{policy}")
    lines += _states(answer, style, limit)
    lines += _slacks(answer, style, limit)
    return [*lines, "", _verdict(answer, style)]


def _number(answer: Answer, ticks: int | None) -> str:
    return "" if ticks is None else format_number(answer.time(ticks))


def _task(answer: Answer, one: TaskAnswer) -> Row:
    task, result = one.task, one.result
    blocker = ""
    if one.blocker is not None:
        resource = one.blocker.resource
        blocker = f"{one.blocker.holder} in {resource}" if resource else one.blocker.holder
    default = "*" if one.entry.priority is None and answer.policy is Policy.GIVEN else ""
    return (
        task.name,
        _number(answer, task.period),
        f"{task.priority}{default}",
        _number(answer, task.demand(1)),
        _number(answer, task.jitter) if task.jitter else "",
        _number(answer, task.blocking) if task.blocking else "",
        blocker,
        percent(float(task.load)),
        "no bound" if result.wcrt is None else _number(answer, result.wcrt),
        _number(answer, task.deadline),
        _number(answer, result.slack),
        Cell("holds", Role.HELP) if result.schedulable else Cell("missed", Role.ERROR),
    )


def _handler(answer: Answer, index: int) -> Row:
    task = answer.handlers[index]
    row: list[Cell | str] = [""] * len(TASKS)
    row[0], row[1], row[3] = f"({task.name})", _number(answer, task.period), _number(answer, task.demand(1))
    row[7] = percent(float(task.load))
    return row


def _states(answer: Answer, style: Style, limit: int | None) -> list[str]:
    """The responses per state of the machines."""
    rows: list[Row] = []
    for one in answer.tasks:
        if one.entry.work.machine is not None:
            for state in state_responses(transition_responses(answer.analysis, one.entry.name)):
                rows.append((one.entry.name, state.state, _number(answer, state.wcrt)))
    return ["", *format_table(STATES, rows, style, limit=limit)] if rows else []


def _slacks(answer: Answer, style: Style, limit: int | None) -> list[str]:
    found = answer.sensitivity
    if found is None:
        return []
    costs = {one.task: one for one in found.costs if one.what is What.WORK}
    periods = {one.task: one for one in found.periods}
    rows: list[Row] = []
    for one in answer.tasks:
        name = one.entry.name
        cost, period = costs.get(name), periods.get(name)
        rows.append(
            (
                name,
                _number(answer, one.task.demand(1)),
                _at(answer, "up to", cost.at_most if cost else None),
                _number(answer, one.task.period),
                _at(answer, "down to", period.at_least if period else None),
                str(one.task.priority),
                _ranges(one.range) if one.range else "",
            )
        )
    lines = ["", *format_table(SLACKS, rows, style, limit=limit)] if found.costs else [""]
    switches = next((one for one in found.costs if one.what is What.OVERHEAD), None)
    if switches is not None:
        per = switches.at_most // 2 if switches.at_most is not None else None
        lines.append(f"  a context switch may take {_at(answer, 'up to', per)}")
    factor = found.speed.factor
    if factor is None:
        lines.append("  no speed of the processor is enough")
    else:
        lines.append(f"  lowest speed of the processor: {format_number(rounded_up(factor))} of what it is")
    return lines


def _at(answer: Answer, word: str, ticks: int | None) -> str:
    return "no value holds" if ticks is None else f"{word} {format_number(answer.varied(ticks))}"


def _ranges(found: PriorityRange) -> str:
    """The ranges as text: `3 to 8, from 10`."""
    words = []
    for low, high in found.ranges:
        match low, high:
            case None, None:
                words.append("any")
            case None, _:
                words.append(f"up to {high}")
            case _, None:
                words.append(f"from {low}")
            case _:
                words.append(str(low) if low == high else f"{low} to {high}")
    return ", ".join(words) or "none"


def _verdict(answer: Answer, style: Style) -> str:
    count = len(answer.tasks)
    missed = sum(not one.result.schedulable for one in answer.tasks)
    if missed:
        return style.paint(Role.ERROR, f"{missed} of {count} deadlines missed")
    every = "the deadline holds" if count == 1 else f"all {count} deadlines hold"
    certainty = "by the paper's method" if answer.method is Method.PAPER else "always"
    return style.paint(Role.HELP, f"{every}, {certainty}")
