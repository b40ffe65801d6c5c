"""MAST text to task sets: transactions of one activity each, on processors with fixed priorities.

A transaction becomes a task with its name. What has no counterpart (networks, other policies, chains of activities,
bursts, offsets that matter, priority inheritance) is an error at its place, not left out.
"""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from mauve.diagnostics.diagnostic import Diagnostic, Label, Report, Severity
from mauve.records import record
from mauve.source import SourceFile, Span
from mauve.tasksets.mast_text import Declaration, Fault, Group, Word, parse_mast
from mauve.tasksets.numbers import read_number
from mauve.tasksets.taskset import UNREADABLE, Document, Entry, KnownSpans, Path, Scheduler, TaskSet, Work

MOST_NESTED = 50
"""Operations within operations."""

PROCESSORS = ("regular_processor", "fixed_priority_processor")
KINDS = (
    "model",
    "processing_resource",
    "scheduler",
    "scheduling_server",
    "shared_resource",
    "operation",
    "transaction",
)


@record
class _Server:
    """A scheduling server: which processor runs it, and how."""

    processor: str
    priority: int
    preemptive: bool


@record
class _Operation:
    """The cost of an operation, and its stays in resources."""

    cost: Fraction
    sections: tuple[tuple[str, Fraction], ...]


class _Unfit(Exception):
    """Something that is not carried over, or is not MAST; ends the reading of one declaration."""

    def __init__(self, code: str, message: str, span: Span) -> None:
        super().__init__(message)
        self.code, self.message, self.span = code, message, span


def read_mast(file: SourceFile, report: Report) -> Document:
    """A set per processor; what is wrong, or cannot be carried over, is reported (MV621 to MV624, MV627)."""
    declarations = parse_mast(file)
    if isinstance(declarations, Fault):
        report.add(Diagnostic("MV621", declarations.message, Label(declarations.span)))
        return UNREADABLE
    model = _Model(file, report)
    for kind in KINDS:
        for declaration in declarations:
            if declaration.kind.text.lower() == kind:
                model.try_read(kind, declaration)
    for declaration in declarations:
        if declaration.kind.text.lower() not in KINDS:
            message = f"`{declaration.kind.text}` is not carried over"
            report.add(Diagnostic("MV627", message, Label(declaration.kind.span)))
            model.failed = True
    if not model.entries and not model.failed:
        report.add(Diagnostic("MV622", "there is no transaction in the model", Label(Span(file, 0, 0))))
        model.failed = True
    return UNREADABLE if model.failed else model.document()


class _Model:
    """What has been read of a model so far."""

    def __init__(self, file: SourceFile, report: Report) -> None:
        self.file, self.report = file, report
        self.failed = False
        self.name = ""
        self.processors: dict[str, Fraction] = {}
        self.switches: dict[str, Fraction] = {}
        self.schedulers: dict[str, str] = {}
        self.servers: dict[str, _Server] = {}
        self.resources: dict[str, str] = {}
        self.raw: dict[str, Group] = {}
        self.operations: dict[str, _Operation] = {}
        self.entries: dict[str, list[Entry]] = {}
        self.spans: dict[Path, Span] = {}
        self.names: dict[str, set[str]] = {}

    def try_read(self, kind: str, declaration: Declaration) -> None:
        """Read one declaration; what is wrong with it is reported."""
        try:
            self._once(kind, declaration)
            match kind:
                case "model":
                    self.name = declaration.body.said("model_name")
                case "processing_resource":
                    self._processor(declaration.body)
                case "scheduler":
                    self._scheduler(declaration.body)
                case "scheduling_server":
                    self._server(declaration.body)
                case "shared_resource":
                    self._resource(declaration.body)
                case "operation":
                    self.raw[declaration.body.said("name")] = declaration.body
                case _:
                    self._transaction(declaration)
        except _Unfit as fault:
            self.failed = True
            self.report.add(Diagnostic(fault.code, fault.message, Label(fault.span)))

    def document(self) -> Document:
        """The set of each processor that has a task."""
        spans = KnownSpans(self.file, self.spans)
        several = len(self.entries) > 1
        sets = [
            TaskSet(
                name=processor if several else self.name,
                scheduler=Scheduler.PREEMPTIVE
                if any(entry.preemptive for entry in entries)
                else Scheduler.NON_PREEMPTIVE,
                unit="",
                tasks=tuple(entries),
                spans=spans,
                context_switch=self.switches.get(processor, Fraction(0)),
            )
            for processor, entries in self.entries.items()
        ]
        return Document(tuple(sets), listed=several)

    # ------------------------------------------------------------------------------------------------- declarations
    def _once(self, kind: str, declaration: Declaration) -> None:
        if kind == "model":
            return
        name = _needed(declaration.body, "Name")
        known = self.names.setdefault(kind, set())
        if name.text.lower() in known:
            raise _Unfit("MV624", f"there are two declarations `{kind}` of the name `{name.text}`", name.span)
        known.add(name.text.lower())

    def _processor(self, body: Group) -> None:
        kind = _needed(body, "Type")
        if kind.text.lower() not in PROCESSORS:
            raise _Unfit("MV627", f"a processing resource of the type `{kind.text}` is not carried over", kind.span)
        name = body.said("name")
        timer = body.get("system_timer")
        if isinstance(timer, Group) and _number(timer, "Worst_Overhead", Fraction(0)):
            raise _Unfit("MV627", "the overhead of a system timer is not carried over", timer.span)
        speed = _number(body, "Speed_Factor", Fraction(1))
        if speed <= 0:
            raise _Unfit("MV623", "a speed factor is above 0", body.span)
        self.processors[name] = speed
        self.schedulers[name] = name  # the older format has no schedulers: servers name the processor
        self.switches[name] = _number(body, "Worst_Context_Switch", Fraction(0))

    def _scheduler(self, body: Group) -> None:
        kind = _needed(body, "Type")
        policy = body.get("policy")
        if kind.text.lower() != "primary_scheduler":
            raise _Unfit("MV627", f"a scheduler of the type `{kind.text}` is not carried over", kind.span)
        if not isinstance(policy, Group) or policy.said("type") != "fixed_priority":
            span = policy.span if policy is not None else body.span
            raise _Unfit("MV627", "only schedulers with the policy `Fixed_Priority` are carried over", span)
        host = _needed(body, "Host")
        if host.text.lower() not in self.processors:
            raise _Unfit("MV622", f"there is no processing resource `{host.text}`", host.span)
        self.schedulers[body.said("name")] = host.text.lower()
        self.switches[host.text.lower()] = _number(policy, "Worst_Context_Switch", Fraction(0))

    def _server(self, body: Group) -> None:
        parameters = body.get("server_sched_parameters")
        if not isinstance(parameters, Group):
            raise _Unfit("MV622", "a scheduling server has `Server_Sched_Parameters => (...)`", body.span)
        policy = _needed(parameters, "Type")
        kinds = {"fixed_priority_policy": True, "non_preemptible_fp_policy": False}
        if policy.text.lower() not in kinds:
            raise _Unfit("MV627", f"a server with the policy `{policy.text}` is not carried over", policy.span)
        place = body.word("scheduler") or _needed(body, "Server_Processing_Resource")
        processor = self.schedulers.get(place.text.lower())
        if processor is None:
            raise _Unfit("MV622", f"there is no scheduler `{place.text}`", place.span)
        priority = _number(parameters, "The_Priority")
        if priority.denominator != 1:
            raise _Unfit("MV623", "a priority is a whole number", parameters.span)
        self.servers[body.said("name")] = _Server(processor, int(priority), kinds[policy.text.lower()])

    def _resource(self, body: Group) -> None:
        kind = _needed(body, "Type")
        if kind.text.lower() not in ("immediate_ceiling_resource", "srp_resource"):
            raise _Unfit("MV627", f"a shared resource of the type `{kind.text}` is not carried over", kind.span)
        preassigned = body.word("preassigned")
        if preassigned is not None and preassigned.text.lower() == "yes":
            raise _Unfit("MV627", "a preassigned ceiling is not carried over: ceilings are computed", preassigned.span)
        self.resources[body.said("name")] = _needed(body, "Name").text

    # --------------------------------------------------------------------------------------------------- operations
    def _operation(self, name: Word, above: tuple[str, ...] = ()) -> _Operation:
        body = self.raw.get(name.text.lower())
        if body is None:
            raise _Unfit("MV622", f"there is no operation `{name.text}`", name.span)
        if name.text.lower() in above:
            raise _Unfit("MV622", f"the operation `{name.text}` contains itself", name.span)
        if len(above) > MOST_NESTED:
            raise _Unfit("MV622", f"the operation `{name.text}` is nested too deeply", name.span)
        other = body.get("new_sched_parameters")
        if other is not None:
            raise _Unfit("MV627", "other scheduling parameters within an operation are not carried over", other.span)
        known = self.operations.get(name.text.lower())
        if known is None:
            known = self.operations[name.text.lower()] = self._read_operation(body, (*above, name.text.lower()))
        return known

    def _read_operation(self, body: Group, above: tuple[str, ...]) -> _Operation:
        inner = [self._operation(one, above) for one in body.words("composite_operation_list")]
        longest: dict[str, Fraction] = {}
        for resource, length in (section for one in inner for section in one.sections):
            longest[resource] = max(length, longest.get(resource, length))
        sections = tuple(longest.items())
        kind = _needed(body, "Type")
        match kind.text.lower():
            case "composite":
                return _Operation(sum((one.cost for one in inner), Fraction(0)), sections)
            case "enclosing":
                return _Operation(_number(body, "Worst_Case_Execution_Time"), sections)
            case "simple":
                cost = _number(body, "Worst_Case_Execution_Time")
                return _Operation(cost, tuple((resource, cost) for resource in self._locked(body)))
        raise _Unfit("MV627", f"an operation of the type `{kind.text}` is not carried over", kind.span)

    def _locked(self, body: Group) -> list[str]:
        """The resources that a simple operation holds for all of its time."""
        both = body.words("shared_resources_list")
        locked, unlocked = body.words("shared_resources_to_lock"), body.words("shared_resources_to_unlock")
        if {one.text.lower() for one in locked} != {one.text.lower() for one in unlocked}:
            message = "a resource that stays locked beyond its operation is not carried over"
            raise _Unfit("MV627", message, (*locked, *unlocked)[0].span)
        for one in (*both, *locked):
            if one.text.lower() not in self.resources:
                raise _Unfit("MV622", f"there is no shared resource `{one.text}`", one.span)
        return list(dict.fromkeys(self.resources[one.text.lower()] for one in (*both, *locked)))

    # ------------------------------------------------------------------------------------------------- transactions
    def _transaction(self, declaration: Declaration) -> None:
        body = declaration.body
        name = _needed(body, "Name")
        event = _only(body, "External_Events", "an external event", declaration.kind)
        handler = _only(body, "Event_Handlers", "an activity", declaration.kind)
        period, jitter = self._arrivals(event)
        kind = _needed(handler, "Type")
        if kind.text.lower() not in ("activity", "system_timed_activity"):
            raise _Unfit("MV627", f"an event handler of the type `{kind.text}` is not carried over", kind.span)
        place = _needed(handler, "Activity_Server")
        server = self.servers.get(place.text.lower())
        if server is None:
            raise _Unfit("MV622", f"there is no scheduling server `{place.text}`", place.span)
        operation = self._operation(_needed(handler, "Activity_Operation"))
        speed = self.processors[server.processor]
        path: Path = (name.text,)
        self.spans[path] = name.span
        entry = Entry(
            name=name.text,
            period=period,
            work=Work(operation.cost / speed),
            path=path,
            deadline=self._deadline(body.groups("internal_events"), event.said("name"), jitter),
            priority=server.priority,
            jitter=jitter,
            sections=tuple((resource, length / speed) for resource, length in operation.sections),
            preemptive=server.preemptive,
        )
        self.entries.setdefault(server.processor, []).append(entry)

    def _arrivals(self, event: Group) -> tuple[Fraction, Fraction]:
        kind = _needed(event, "Type")
        match kind.text.lower():
            case "periodic":
                phase = event.word("phase")
                if phase is not None and _number(event, "Phase"):
                    message = "the phase of an event is left out, which never makes a response shorter"
                    self.report.add(Diagnostic("MV627", message, Label(phase.span), Severity.WARNING))
                period, jitter = _number(event, "Period"), _number(event, "Max_Jitter", Fraction(0))
            case "sporadic":
                period, jitter = _number(event, "Min_Interarrival"), Fraction(0)
            case _:
                raise _Unfit("MV627", f"an external event of the type `{kind.text}` is not carried over", kind.span)
        if period <= 0:
            raise _Unfit("MV623", "the separation of external events is above 0", event.span)
        return period, jitter

    def _deadline(self, events: Iterable[Group], source: str, jitter: Fraction) -> Fraction | None:
        """The hard deadline of a transaction's end; None for none, which leaves the period."""
        found: list[Fraction] = []
        for event in events:
            requirement = event.get("timing_requirements")
            if not isinstance(requirement, Group):
                continue
            for one in event.groups("timing_requirements"):
                kind = _needed(one, "Type")
                local = kind.text.lower() == "hard_local_deadline"
                if not (kind.text.lower() == "hard_global_deadline" or (local and not jitter)):
                    raise _Unfit("MV627", f"a requirement of the type `{kind.text}` is not carried over", kind.span)
                reference = one.word("referenced_event")
                if reference is not None and reference.text.lower() != source:
                    raise _Unfit("MV622", f"there is no external event `{reference.text}` here", reference.span)
                found.append(_number(one, "Deadline"))
                if found[-1] <= 0:
                    raise _Unfit("MV623", "a deadline is above 0", one.span)
        return min(found, default=None)


def _needed(group: Group, name: str) -> Word:
    word = group.word(name)
    if word is None or not word.text:
        start = group.span.start
        raise _Unfit("MV622", f"`{name} => ...` is missing", Span(group.span.file, start, start + 1))
    return word


def _only(body: Group, name: str, what: str, kind: Word) -> Group:
    """The one group of a list; a chain of several is not a task of its own."""
    groups = body.groups(name)
    if len(groups) != 1:
        count = "no" if not groups else str(len(groups))
        span = groups[1].span if groups else kind.span
        message = f"a transaction with {count} `{name}` is not carried over: a task has {what}"
        raise _Unfit("MV627", message, span)
    return groups[0]


def _number(group: Group, name: str, default: Fraction | None = None) -> Fraction:
    """A time in a field, not negative."""
    word = group.word(name)
    if word is None:
        if default is None:
            _needed(group, name)
        return default or Fraction(0)
    value = read_number(word.text)
    if isinstance(value, str):
        raise _Unfit("MV623", f"`{name}`: {value}", word.span)
    if value < 0:
        raise _Unfit("MV623", f"`{name}` is negative", word.span)
    return value


