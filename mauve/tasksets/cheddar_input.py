"""Cheddar XML to task sets: periodic and sporadic tasks on processors of one core with fixed priorities."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from xml.parsers import expat

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report, Severity
from mauve.source import SourceFile, Span
from mauve.tasksets.numbers import read_number
from mauve.tasksets.taskset import UNREADABLE, Document, Entry, KnownSpans, Path, Scheduler, TaskSet, Work

DEEPEST = 60
"""Elements nested deeper are no Cheddar model."""

POLICIES = {
    "rate_monotonic_protocol": "T",
    "deadline_monotonic_protocol": "D",
    "posix_1003_highest_priority_first_protocol": "priority",
}
"""The schedulers that are carried over, and what decides their priorities."""

LAZY, NONE = "priority_ceiling_protocol", "no_protocol"
PROTOCOLS = ("immediate_priority_ceiling_protocol", LAZY, NONE)

SECTIONS = ("core_units", "processors", "address_spaces", "tasks", "resources")
"""What is read, or never changes a response."""


class _Element:
    """An element with its text, and where it begins. Names are in lower case: versions of Cheddar differ."""

    __slots__ = ("attributes", "children", "span", "tag", "text")

    def __init__(self, tag: str, attributes: dict[str, str], span: Span) -> None:
        self.tag, self.attributes, self.span = tag, attributes, span
        self.children: list[_Element] = []
        self.text = ""

    def child(self, tag: str) -> _Element | None:
        """The first child of a name."""
        return next((one for one in self.children if one.tag == tag), None)

    def said(self, tag: str) -> str:
        """The text of a child; empty where there is none."""
        found = self.child(tag)
        return found.text.strip() if found is not None else ""

    def every(self, tag: str) -> Iterator[_Element]:
        """Every element of a name below."""
        for one in self.children:
            if one.tag == tag:
                yield one
            yield from one.every(tag)


class _Unfit(Exception):
    def __init__(self, code: str, message: str, span: Span) -> None:
        super().__init__(message)
        self.code, self.message, self.span = code, message, span


def read_cheddar(file: SourceFile, report: Report) -> Document:
    """A set per processor; what is wrong, or cannot be carried over, is reported (MV621 to MV624, MV627)."""
    root = _parse(file, report)
    if root is None:
        return UNREADABLE
    model = _Model(file, report)
    if root.tag != "cheddar":
        model.fault(_Unfit("MV621", f"this is no Cheddar model: its root is `{root.tag}`", root.span))
        return UNREADABLE
    for section in root.children:
        if section.tag not in SECTIONS and section.children:
            model.fault(_Unfit("MV627", f"`{section.tag}` are not carried over", section.span))
    model.read(root)
    return UNREADABLE if model.failed else model.document()


def _parse(file: SourceFile, report: Report) -> _Element | None:
    """The tree of a document. Its own entities are refused: nothing expands without end."""
    parser = expat.ParserCreate()
    stack: list[_Element] = []
    roots: list[_Element] = []
    data = file.text.encode()

    def place() -> Span:
        at = len(data[: parser.CurrentByteIndex].decode("utf-8", errors="ignore"))
        return Span(file, at, min(at + 1, len(file.text)))

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = _Element(tag.lower(), attributes, place())
        if len(stack) >= DEEPEST:
            raise _Unfit("MV621", "elements are nested too deeply for a Cheddar model", element.span)
        (stack[-1].children if stack else roots).append(element)
        stack.append(element)

    def end(tag: str) -> None:
        stack.pop()

    def text(characters: str) -> None:
        if stack:
            stack[-1].text += characters

    def entity(*_: object) -> None:
        raise _Unfit("MV621", "a Cheddar model declares no entities", place())

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.CharacterDataHandler, parser.EntityDeclHandler = text, entity
    try:
        parser.Parse(data, True)
    except expat.ExpatError as error:
        at = file.line_starts[min(error.lineno, len(file.line_starts)) - 1] + error.offset
        label = Label(Span(file, at, min(at + 1, len(file.text))))
        report.add(Diagnostic("MV621", f"this is not XML: {expat.ErrorString(error.code)}", label))
        return None
    except _Unfit as fault:
        report.add(Diagnostic(fault.code, fault.message, Label(fault.span)))
        return None
    return roots[0]


class _Model:
    """What has been read of a model so far."""

    def __init__(self, file: SourceFile, report: Report) -> None:
        self.file, self.report = file, report
        self.failed = False
        self.cores: dict[str, _Element] = {}
        self.processors: dict[str, tuple[str, bool, Fraction]] = {}
        self.entries: dict[str, list[Entry]] = {}
        self.sections: dict[str, list[tuple[str, Fraction]]] = {}
        self.spans: dict[Path, Span] = {}
        self.switches: dict[str, set[Fraction]] = {}
        self.lazy: list[Span] = []

    def fault(self, fault: _Unfit) -> None:
        """Report what does not fit."""
        self.failed = True
        self.report.add(Diagnostic(fault.code, fault.message, Label(fault.span)))

    def read(self, root: _Element) -> None:
        """All of it, resources before the tasks that use them."""
        for units in root.children:
            for one in units.children if units.tag in SECTIONS else ():
                if units.tag == "core_units":
                    self.cores[one.attributes.get("id", "")] = one
        steps = {"processors": self._processor, "resources": self._resource, "tasks": self._task}
        for tag, step in steps.items():
            for units in root.children:
                for one in units.children if units.tag == tag else ():
                    try:
                        step(one)
                    except _Unfit as fault:
                        self.fault(fault)
        if not self.entries and not self.failed:
            self.fault(_Unfit("MV622", "there is no task in the model", root.span))
        if self.lazy and any(max(switches) for switches in self.switches.values()):
            # The bound on blocking is that of the immediate protocol, but a job that is blocked is switched once more.
            message = "priority ceiling protocol: not carried over beside context switches: it switches more often"
            self.fault(_Unfit("MV627", message, self.lazy[0]))
        known = {entry.name for entries in self.entries.values() for entry in entries}
        for name in self.sections:
            if name not in known and not self.failed:
                self.fault(_Unfit("MV622", f"a resource names a task `{name}` that is not there", root.span))

    def document(self) -> Document:
        """The set of each processor that has a task."""
        spans = KnownSpans(self.file, self.spans)
        several = len(self.entries) > 1
        sets = []
        for processor, entries in self.entries.items():
            rule, preemptive, _ = self.processors[processor]
            scheduler = Scheduler.PREEMPTIVE if preemptive else Scheduler.NON_PREEMPTIVE
            ordered = _prioritised(entries, rule)
            switch = max(self.switches[processor])
            sets.append(TaskSet(processor, scheduler, "", ordered, spans, context_switch=switch))
        return Document(tuple(sets), listed=several)

    def _processor(self, one: _Element) -> None:
        name = one.said("name")
        if one.tag != "mono_core_processor":
            raise _Unfit("MV627", f"the processor `{name}` has several cores, which is not carried over", one.span)
        reference = one.child("core")
        core = self.cores.get(reference.attributes.get("ref", "")) if reference is not None else None
        if core is None:
            raise _Unfit("MV622", f"the processor `{name}` has no core unit that is there", one.span)
        parameters = next(core.every("scheduling_parameters"), core)
        kind = parameters.said("scheduler_type").lower()
        if kind not in POLICIES:
            place = parameters.child("scheduler_type") or parameters
            raise _Unfit("MV627", f"the scheduler `{kind}` is not carried over", place.span)
        preemptive = parameters.said("preemptive_type").lower() != "not_preemptive"
        speed = _number(core, "speed") or Fraction(1)
        self.processors[name] = (POLICIES[kind], preemptive, speed)

    def _resource(self, one: _Element) -> None:
        protocol = one.child("protocol")
        kind = protocol.text.strip().lower() if protocol is not None else ""
        if protocol is not None and kind not in PROTOCOLS:
            raise _Unfit("MV627", f"the protocol `{kind}` is not carried over", protocol.span)
        if protocol is not None and kind == LAZY:
            self.lazy.append(protocol.span)
        users = {element.text.strip() for each in one.every("critical_sections") for element in each.every("task_name")}
        if protocol is not None and kind == NONE and len(users) > 1:
            message = f"nothing raises who holds `{one.said('name')}`: without a protocol, waiting for it has no bound"
            raise _Unfit("MV627", message, protocol.span)
        assigned = one.child("priority_assignment")
        if assigned is not None and assigned.text.strip().lower() == "manual_assignment":
            raise _Unfit("MV627", "a ceiling by hand is not carried over: ceilings are computed", assigned.span)
        for each in one.every("critical_sections"):
            task = ""
            for element in each.children:
                if element.tag == "task_name":
                    task = element.text.strip()
                elif element.tag == "critical_section":
                    first, last = _number(element, "task_begin"), _number(element, "task_end")
                    if first is None or last is None or last < first:
                        raise _Unfit("MV623", "a critical section ends before it begins", element.span)
                    # From the beginning of its first unit of time to the end of its last.
                    self.sections.setdefault(task, []).append((one.said("name"), last - first + 1))

    def _task(self, one: _Element) -> None:
        name = one.said("name")
        if one.tag not in ("periodic_task", "sporadic_task"):
            raise _Unfit("MV627", f"a task of the kind `{one.tag}` is not carried over", one.span)
        processor = one.said("cpu_name")
        if processor not in self.processors:
            if self.failed:
                return
            raise _Unfit("MV622", f"`{name}` runs on a processor `{processor}` that is not there", one.span)
        path: Path = (name,)
        if not name or path in self.spans:
            raise _Unfit("MV624" if name else "MV622", f"two tasks of the name `{name}`, or none", one.span)
        self.spans[path] = (one.child("name") or one).span
        speed = self.processors[processor][2]
        period, cost = _positive(one, "period"), _number(one, "capacity")
        if cost is None:
            raise _Unfit("MV622", f"`{name}` has no capacity", one.span)
        start = one.child("start_time")
        if start is not None and _number(one, "start_time"):
            message = f"the start time of `{name}` is left out, which never makes a response shorter"
            self.report.add(Diagnostic("MV627", message, Label(start.span), Severity.WARNING))
        for key in ("offsets", "every"):
            found = one.child(key)
            if found is not None and (found.children or found.text.strip() not in ("", "0")):
                raise _Unfit("MV627", f"`{key}` of `{name}` is not carried over", found.span)
        priority = _number(one, "priority")
        if priority is not None and priority.denominator != 1:
            raise _Unfit("MV623", f"the priority of `{name}` is no whole number", one.span)
        self.switches.setdefault(processor, set()).add(_number(one, "context_switch_overhead") or Fraction(0))
        entry = Entry(
            name=name,
            period=period,
            work=Work(cost / speed),
            path=path,
            deadline=_positive(one, "deadline") if one.said("deadline") not in ("", "0") else None,
            priority=None if priority is None else int(priority),
            jitter=_number(one, "jitter") or Fraction(0),
            blocking=_number(one, "blocking_time") or Fraction(0),
            sections=tuple((resource, length / speed) for resource, length in self.sections.get(name, ())),
        )
        self.entries.setdefault(processor, []).append(entry)


def _prioritised(entries: list[Entry], rule: str) -> tuple[Entry, ...]:
    """The tasks with the priorities that the scheduler gives them."""
    from mauve.records import changed

    if rule == "priority":
        return tuple(entries)
    if rule == "T":
        return tuple(changed(entry, priority=None) for entry in entries)
    order = sorted(entries, key=lambda entry: entry.period if entry.deadline is None else entry.deadline)
    rank = {entry.name: len(order) - place for place, entry in enumerate(order)}
    return tuple(changed(entry, priority=rank[entry.name]) for entry in entries)


def _number(one: _Element, tag: str) -> Fraction | None:
    """The number of a child, not negative; None where it is not there."""
    child = one.child(tag)
    if child is None or not child.text.strip():
        return None
    value = read_number(child.text.strip())
    if isinstance(value, str):
        raise _Unfit("MV623", f"`{tag}`: {value}", child.span)
    if value < 0:
        raise _Unfit("MV623", f"`{tag}` is negative", child.span)
    return value


def _positive(one: _Element, tag: str) -> Fraction:
    value = _number(one, tag)
    if value is None or value == 0:
        raise _Unfit("MV623", f"`{one.said('name')}` has no `{tag}` above 0", (one.child(tag) or one).span)
    return value
