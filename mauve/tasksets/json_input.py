"""mauve.taskset/1: JSON to task sets. Numbers are read exactly; every fault is told at its place."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping
from fractions import Fraction
from typing import TypeGuard

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report
from mauve.diagnostics.suggest import closest
from mauve.records import record
from mauve.source import SourceFile, Span
from mauve.tasksets.faults import Faults, not_negative, positive, too_many, unique
from mauve.tasksets.json_places import JsonSpans
from mauve.tasksets.numbers import read_number
from mauve.tasksets.taskset import (
    SCHEMA,
    UNREADABLE,
    Document,
    Edge,
    Entry,
    Handler,
    Machine,
    Path,
    Scheduler,
    TaskSet,
    Work,
)

WORKS = ("C", "frames", "curve", "psm")
FIELDS = ("name", "T", "D", "prio", "J", "B", "cs", *WORKS, "np", "tail", "preemptive")
LEAST_PRIORITY, GREATEST_PRIORITY = -(2**31), 2**31 - 1

Value = object
Object = Mapping[str, Value]


@record
class _Bad:
    """A numeral that is no number of ours, and why."""

    problem: str


@record
class _Pairs:
    """An object as it was written, with the keys that are there twice."""

    fields: dict[str, Value]
    twice: tuple[str, ...]


def read_json(file: SourceFile, report: Report) -> Document:
    """The sets of a document, one or a list of them; what is wrong with one is reported (MV621 to MV624)."""
    value = _parse(file, report)
    if value is None:
        return UNREADABLE
    faults = Faults(JsonSpans(file), report)
    listed = _is_list(value)
    sets: list[TaskSet | None] = []
    if listed and not value:
        faults.add("MV622", (), "there is no task set in the list")
        return UNREADABLE
    for path, one in [((index,), one) for index, one in enumerate(value)] if _is_list(value) else [((), value)]:
        before = faults.errors
        found = _Reader(faults, path).read(one)
        sets.append(found if faults.errors == before else None)
    faults.close()
    return Document(tuple(sets), listed)


def _parse(file: SourceFile, report: Report) -> Value:
    def numeral(text: str) -> Fraction | _Bad:
        value = read_number(text)
        return _Bad(value) if isinstance(value, str) else value

    def pairs(items: list[tuple[str, Value]]) -> _Pairs:
        fields = dict(items)
        if len(fields) == len(items):
            return _Pairs(fields, ())
        counts = Counter(key for key, _ in items)
        return _Pairs(fields, tuple(key for key, count in counts.items() if count > 1))

    problem, at = "", 0
    try:
        value: Value = json.loads(
            file.text,
            parse_int=numeral,
            parse_float=numeral,
            parse_constant=numeral,
            object_pairs_hook=pairs,
        )
        if value is None:
            problem = "there is no task set: the document is null"
    except json.JSONDecodeError as error:
        problem, at = f"this is not JSON: {_lowered(error.msg)}", error.pos
    except RecursionError:
        problem = "this is nested too deeply to be a task set"
    if problem:
        label = Label(Span(file, at, min(at + 1, len(file.text))))
        report.add(Diagnostic("MV621", problem, label))
        return None
    return value


def _lowered(text: str) -> str:
    return text[:1].lower() + text[1:]


def _is_list(value: Value) -> TypeGuard[list[Value]]:
    return isinstance(value, list)


def _said(value: Value) -> str:
    """What a value is, in words."""
    match value:
        case None:
            return "null"
        case bool():
            return "true" if value else "false"
        case str():
            return "a text"
        case list():
            return "a list"
        case _Pairs():
            return "an object"
        case _:
            return "a number"


class _Reader:
    """Reads one set; faults go to the report with the path of what they are about."""

    __slots__ = ("faults", "root")

    def __init__(self, faults: Faults, root: Path) -> None:
        self.faults, self.root = faults, root

    def read(self, value: Value) -> TaskSet | None:
        """The set, as far as it can be read; None where it is no set at all."""
        root, faults = self.root, self.faults
        fields = self._object(value, root, "a task set")
        if fields is None:
            return None
        schema = fields.get("schema")
        if "schema" not in fields:
            faults.warn("MV622", root, f'there is no `"schema": "{SCHEMA}"`; it is taken to be that')
        elif schema != SCHEMA:
            faults.add("MV622", (*root, "schema"), f'this is no task set: its schema is not "{SCHEMA}"')
            return None
        tasks = fields.get("tasks")
        if not _is_list(tasks):
            what = f"is {_said(tasks)}" if "tasks" in fields else "is missing"
            faults.add("MV622", (*root, "tasks"), f"`tasks` {what}; it is a list of tasks")
            return None
        if too_many(len(tasks), (*root, "tasks"), faults):
            return None
        if not tasks:
            faults.add("MV622", (*root, "tasks"), "there is no task in the set")
        entries = [self._entry(task, (*root, "tasks", index)) for index, task in enumerate(tasks)]
        found = tuple(entry for entry in entries if entry is not None)
        handlers = tuple(self._handlers(fields))
        names = [(entry.name, (*entry.path, "name")) for entry in found]
        unique([*names, *((one.name, (*root, "interrupts")) for one in handlers)], "tasks", faults)
        unit, name = fields.get("unit") or "", fields.get("name", fields.get("id", ""))
        if not isinstance(unit, str):
            faults.add("MV622", (*root, "unit"), f'`unit` is {_said(unit)}; it is a text, such as "ms"')
        return TaskSet(
            name=name if isinstance(name, str) else "",
            scheduler=self._scheduler(fields),
            unit=unit if isinstance(unit, str) else "",
            tasks=found,
            spans=faults.spans,
            path=root,
            context_switch=self._time(fields, "context_switch", root, "the context switch") or Fraction(0),
            interrupts=handlers,
        )

    def _scheduler(self, fields: Object) -> Scheduler:
        value = fields.get("scheduler", Scheduler.PREEMPTIVE.value)
        for scheduler in Scheduler:
            if value == scheduler.value:
                return scheduler
        known = " or ".join(f'"{one.value}"' for one in Scheduler)
        self.faults.add("MV622", (*self.root, "scheduler"), f"there is no such scheduler; it is {known}")
        return Scheduler.PREEMPTIVE

    def _object(self, value: Value, path: Path, what: str) -> dict[str, Value] | None:
        if not isinstance(value, _Pairs):
            self.faults.add("MV622", path, f"{what} is an object, not {_said(value)}")
            return None
        for key in value.twice:
            self.faults.add("MV622", (*path, key), f"`{key}` is given twice")
        return value.fields

    def _entry(self, value: Value, path: Path) -> Entry | None:
        fields = self._object(value, path, "a task")
        if fields is None:
            return None
        before = self.faults.count
        for key in fields:
            if key not in FIELDS:
                near = closest(key, FIELDS)
                help_ = f"did you mean `{near[0]}`?" if near else ""
                self.faults.warn("MV622", (*path, f"key {key}"), f"a task has no `{key}`; it is left out", help_)
        name = self._name(fields, path, "a task")
        said = f"of `{name}`" if name else "of the task"
        period = self._time(fields, "T", path, f"the period {said}", needed=True, zero=False)
        deadline = self._time(fields, "D", path, f"the deadline {said}", zero=False)
        work = self._work(fields, path, said)
        jitter = self._time(fields, "J", path, f"the jitter {said}")
        blocking = self._time(fields, "B", path, f"the blocking {said}")
        unpreempted = self._time(fields, "np", path, f"the stretch without preemption {said}")
        tail = self._time(fields, "tail", path, f"the last section {said}")
        priority = self._priority(fields, path)
        sections = tuple(self._sections(fields, path))
        preemptive = fields.get("preemptive", True)
        if not isinstance(preemptive, bool):
            self.faults.add("MV622", (*path, "preemptive"), "`preemptive` is true or false")
        if work is not None:
            lengths = [("np", unpreempted), ("tail", tail), *(("cs", length) for _, length in sections)]
            for key, length in lengths:
                if length is not None and length > work.dearest:
                    self.faults.add("MV623", (*path, key), f"a section {said} is longer than its dearest job")
        if not name or period is None or work is None:
            if self.faults.count == before:
                self.faults.add("MV622", path, "the task is not complete")
            return None
        return Entry(
            name=name,
            period=period,
            work=work,
            path=path,
            deadline=deadline,
            priority=priority,
            jitter=jitter or Fraction(0),
            blocking=blocking or Fraction(0),
            sections=sections,
            unpreempted=unpreempted or Fraction(0),
            tail=tail or Fraction(0),
            preemptive=preemptive is not False,
        )

    def _name(self, fields: Object, path: Path, what: str) -> str:
        value = fields.get("name")
        if isinstance(value, str) and value:
            return value
        problem = f"has no `name` but {_said(value)}" if "name" in fields and value != "" else "has no `name`"
        self.faults.add("MV622", (*path, "name"), f"{what} {problem}")
        return ""

    def _number(self, value: Value, path: Path, what: str) -> Fraction | None:
        if isinstance(value, Fraction):
            return value
        if isinstance(value, _Bad):
            self.faults.add("MV623", path, f"{what}: {value.problem}")
        else:
            self.faults.add("MV622", path, f"{what} is a number, not {_said(value)}")
        return None

    def _time(
        self, fields: Object, key: str, path: Path, what: str, needed: bool = False, zero: bool = True
    ) -> Fraction | None:
        """A time in a field; None where it is not there, or not one."""
        if fields.get(key) is None and not (key in fields and needed):
            if needed:
                self.faults.add("MV622", path, f"{what} is missing: there is no `{key}`")
            return None
        value = self._number(fields[key], (*path, key), what)
        if value is None:
            return None
        check = not_negative if zero else positive
        return value if check(value, what, (*path, key), self.faults) else None

    def _priority(self, fields: Object, path: Path) -> int | None:
        if fields.get("prio") is None:
            return None
        value = self._number(fields["prio"], (*path, "prio"), "a priority")
        if value is None:
            return None
        if value.denominator != 1 or not LEAST_PRIORITY <= value <= GREATEST_PRIORITY:
            message = f"a priority is a whole number from {LEAST_PRIORITY} to {GREATEST_PRIORITY}"
            self.faults.add("MV623", (*path, "prio"), message)
            return None
        return int(value)

    def _sections(self, fields: Object, path: Path) -> Iterator[tuple[str, Fraction]]:
        value = fields.get("cs")
        if value is None:
            return
        if not _is_list(value):
            self.faults.add("MV622", (*path, "cs"), '`cs` is a list of sections: [["R1", 3]]')
            return
        for index, one in enumerate(value):
            place = (*path, "cs", index)
            if not _is_list(one) or len(one) != 2 or not isinstance(one[0], str) or not one[0]:
                self.faults.add("MV622", place, 'a section is a resource and a length: ["R1", 3]')
                continue
            length = self._number(one[1], (*place, 1), "the length of a section")
            if length is not None and not_negative(length, "the length of a section", (*place, 1), self.faults):
                yield one[0], length

    def _work(self, fields: Object, path: Path, said: str) -> Work | None:
        given = [key for key in WORKS if fields.get(key) is not None]
        others = [key for key in given if key != "C"]
        if not given or len(others) > 1:
            problem = f"gives its cost twice: `{others[0]}` and `{others[1]}`" if others else "has no cost"
            name = said.removeprefix("of ")
            self.faults.add("MV622", path, f"{name} {problem}", "give one of `C`, `frames`, `curve` and `psm`")
            return None
        key = others[0] if others else "C"
        constant = self._time(fields, "C", path, f"the cost {said}")
        work: Work | None
        match key:
            case "frames":
                work = Work(frames=tuple(self._costs(fields[key], (*path, key), said)))
            case "curve":
                work = self._curve(fields[key], (*path, key), said)
            case "psm":
                work = self._psm(fields[key], (*path, key), said)
            case _:
                return None if constant is None else Work(constant)
        if work is None or not any(True for _ in work.values()):
            return None
        if "C" in given and constant is not None and constant != work.dearest:
            message = f"the cost {said} is given twice: `C` is not the dearest job of its `{key}`"
            self.faults.add("MV623", (*path, "C"), message, "leave `C` out")
        return work

    def _costs(self, value: Value, path: Path, said: str) -> Iterator[Fraction]:
        if not _is_list(value) or not value:
            self.faults.add("MV622", path, f"`{path[-1]}` {said} is a list of one cost or more")
            return
        for index, one in enumerate(value):
            cost = self._number(one, (*path, index), f"a cost {said}")
            if cost is not None and not_negative(cost, f"a cost {said}", (*path, index), self.faults):
                yield cost

    def _curve(self, value: Value, path: Path, said: str) -> Work | None:
        totals = tuple(self._costs(value, path, said))
        for index in range(1, len(totals)):
            if totals[index] < totals[index - 1]:
                message = f"the curve {said} falls: more jobs never cost less"
                self.faults.add("MV623", (*path, index), message)
                return None
        return Work(curve=totals)

    def _psm(self, value: Value, path: Path, said: str) -> Work | None:
        fields = self._object(value, path, f"the machine {said}")
        if fields is None:
            return None
        initial, edges = fields.get("initial"), fields.get("edges")
        if not isinstance(initial, str) or not initial:
            self.faults.add("MV622", (*path, "initial"), f"the machine {said} has no `initial` state")
            return None
        if not _is_list(edges) or not edges:
            self.faults.add("MV623", (*path, "edges"), f"the machine {said} has no transition in `edges`")
            return None
        found = [self._edge(edge, (*path, "edges", index), said) for index, edge in enumerate(edges)]
        whole = [edge for edge in found if edge is not None]
        if len(whole) < len(found):
            return None
        if not any(edge.source == initial for edge in whole):
            message = f"the machine {said} has no transition from its initial state `{initial}`"
            near = closest(initial, sorted({edge.source for edge in whole}))
            self.faults.add("MV623", (*path, "initial"), message, f"did you mean `{near[0]}`?" if near else "")
            return None
        return Work(machine=Machine(initial, tuple(whole)))

    def _edge(self, value: Value, path: Path, said: str) -> Edge | None:
        fields = self._object(value, path, f"a transition {said}")
        if fields is None:
            return None
        ends = [fields.get(key) for key in ("src", "dst")]
        cost = self._time(fields, "cost", path, f"the cost of a transition {said}", needed=True)
        source, target = ends
        if not isinstance(source, str) or not isinstance(target, str):
            message = f"a transition {said} leads from `src` to `dst`, two names of states"
            self.faults.add("MV622", path, message)
            return None
        return None if cost is None else Edge(source, target, cost)

    def _handlers(self, fields: Object) -> Iterator[Handler]:
        value = fields.get("interrupts")
        if value is None:
            return
        if not _is_list(value):
            self.faults.add("MV622", (*self.root, "interrupts"), '`interrupts` is a list of {"name", "T", "C"}')
            return
        for index, one in enumerate(value):
            path = (*self.root, "interrupts", index)
            inner = self._object(one, path, "an interrupt")
            if inner is None:
                continue
            name = self._name(inner, path, "an interrupt")
            period = self._time(inner, "T", path, f"the separation of `{name}`", needed=True, zero=False)
            cost = self._time(inner, "C", path, f"the cost of `{name}`", needed=True)
            if name and period is not None and cost is not None:
                yield Handler(name, period, cost)
