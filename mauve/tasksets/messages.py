"""What the analysis of a task set found, told as messages at the tasks' places in the file."""

from __future__ import annotations

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Report, Severity
from mauve.tasksets.answer import MOST_VARIED, Answer, TaskAnswer
from mauve.timing.bill import Bill, BillLine, deadline_bill
from mauve.timing.priorities import Policy
from mauve.timing.response import UNSOUND, Caveat, Reason
from mauve.timing.task import Kind

MOST_MESSAGES = 20
"""So many missed deadlines of one set are told; the table shows the others."""


def report_answer(answer: Answer, report: Report) -> None:
    """MV601 for each missed deadline, MV602 for an overload, MV603 where the method is not sound or fell back, MV605
    for responses without a bound, MV420 for what was not written, MV625 where no priorities were found."""
    _report_defaults(answer, report)
    if answer.assignment.priorities is None:
        _report_stuck(answer, report)
    overloaded = [one for one in answer.tasks if one.result.reason is Reason.OVERLOAD]
    if overloaded:
        report.add(_overload(answer, overloaded[0]))
    told = 0
    for one in answer.tasks:
        if one.result.reason in (Reason.FULL_LOAD, Reason.LIMIT):
            message = f"the response of `{one.entry.name}` has no bound: {one.result.reason.value}"
            report.add(Diagnostic("MV605", message, _label(answer, one)))
        elif not one.result.schedulable and told < MOST_MESSAGES:
            told += 1
            report.add(_missed(answer, one))
    if answer.sensitivity is not None and len(answer.tasks) > MOST_VARIED:
        message = f"costs, periods and priorities are varied for up to {MOST_VARIED} tasks, not for {len(answer.tasks)}"
        place = Label(answer.taskset.spans.of(answer.taskset.path))
        report.add(Diagnostic("MV626", message, place, Severity.NOTE))
    for caveat in dict.fromkeys(c for one in answer.tasks for c in one.result.caveats):
        _report_caveat(answer, caveat, report)


def _label(answer: Answer, one: TaskAnswer, text: str = "") -> Label:
    return Label(answer.taskset.spans.of((*one.entry.path, "name")), text)


def _names(tasks: list[str]) -> str:
    shown = ", ".join(f"`{name}`" for name in tasks[:5])
    return f"{shown} and {len(tasks) - 5} more" if len(tasks) > 5 else shown


def _report_defaults(answer: Answer, report: Report) -> None:
    if answer.policy is not Policy.GIVEN:
        return
    missing = [one for one in answer.tasks if one.entry.priority is None]
    if missing:
        verb = "has" if len(missing) == 1 else "have"
        names = _names([one.entry.name for one in missing])
        message = f"{names} {verb} no priority: rate monotonic, the shorter period is more urgent"
        report.add(Diagnostic("MV420", message, _label(answer, missing[0]), Severity.NOTE))


def _report_stuck(answer: Answer, report: Report) -> None:
    stuck = list(answer.assignment.stuck)
    message = f"no priorities were found with which every deadline holds: none of {_names(stuck)} can be the lowest"
    place = Label(answer.taskset.spans.of(answer.taskset.path))
    notes = ("the set is analysed with the priorities it came with",)
    report.add(Diagnostic("MV625", message, place, Severity.WARNING, notes=notes))


def _overload(answer: Answer, one: TaskAnswer) -> Diagnostic:
    loads = {task.name: float(task.load) for task in answer.analysis.tasks}
    total = sum(loads[name] for name in one.result.responsible)
    message = f"the processor is overloaded: `{one.entry.name}` and those above it need {100 * total:.1f} % of its time"
    lines = [f"{100 * loads[name]:6.1f} %  {name}" for name in one.result.responsible[:20]]
    notes = ("in the long run:\n" + "\n".join(lines),)
    help_ = Fix("lengthen a period, shorten a task, or take one away")
    return Diagnostic("MV602", message, _label(answer, one), notes=notes, help=help_)


def _missed(answer: Answer, one: TaskAnswer) -> Diagnostic:
    name, result, show = one.entry.name, one.result, answer.show
    deadline = f"its deadline is {show(result.deadline)}"
    if result.wcrt is None:
        message = f"`{name}` has no bound on its response, {deadline}"
    else:
        message = f"`{name}` responds within {show(result.wcrt)}, {deadline}"
    bill = deadline_bill(answer.analysis, name)
    notes = (_bill_text(answer, one, bill),) if bill is not None else ()
    return Diagnostic("MV601", message, _label(answer, one), notes=notes)


def _bill_text(answer: Answer, one: TaskAnswer, bill: Bill) -> str:
    """The work due by the deadline, line by line, the dearest interferer first, the task's own last."""
    show = answer.show
    which = "" if bill.job == 1 else f" of its job {bill.job}"
    rows = [(show(line.cost), _line(answer, line)) for line in bill.others[:20]]
    if len(bill.others) > 20:
        rows.append((show(sum(line.cost for line in bill.others[20:])), f"{len(bill.others) - 20} more tasks"))
    if bill.blocking:
        holder = f"  `{one.blocker.holder}` in {one.blocker.what}" if one.blocker else ""
        rows.append((show(bill.blocking), f"blocking{holder}"))
    rows.append((show(bill.own.cost), "of its own"))
    width = max(len(cost) for cost, _ in rows)
    head = f"by {show(bill.window)}{which}, {show(bill.due)} of work is due:"
    return "\n".join([head, *(f"{cost:>{width}}  {text}" for cost, text in rows)])


def _line(answer: Answer, line: BillLine) -> str:
    kind = f"priority {line.priority}" if line.kind is Kind.TASK else line.kind.value
    each = line.cost // line.jobs if line.jobs else 0
    count = f"{line.jobs} x {answer.show(each)}" if each * line.jobs == line.cost else f"{line.jobs} jobs"
    return f"{line.task}  {count} ({kind})"


def _report_caveat(answer: Answer, caveat: Caveat, report: Report) -> None:
    concerned = [one for one in answer.tasks if caveat in one.result.caveats]
    names = _names([one.entry.name for one in concerned])
    place = _label(answer, concerned[0])
    if caveat in UNSOUND:
        message = f"by the paper's method the response of {names} may be too small: {caveat.value}"
        help_ = Fix("use `--method trace`, which covers this")
        report.add(Diagnostic("MV603", message, place, Severity.WARNING, help=help_))
    else:
        report.add(Diagnostic("MV626", f"{names}: {caveat.value}", place, Severity.NOTE))
