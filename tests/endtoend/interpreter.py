"""An independent simulation of a resolved deployment, written from the semantics of record alone.

It knows nothing of PSMs, curves or fixed points: jobs are released, one transition of each due region fires, steps take
time, critical sections run at their ceilings, interrupts and ticks go before everything. Wherever the semantics leave
an outcome open (guards, commanded events, offsets, jitters, times below the WCET, the order among equals) a seeded
adversary chooses. What it observes must never exceed what the analysis reports.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import gcd
from random import Random

from mauve.model.model import (
    CallMethod,
    ComponentKind,
    Deployment,
    Endpoint,
    Instance,
    Node,
    PortKind,
    Region,
    Role,
    RunCodel,
    RunsIn,
    State,
    Step,
    Thread,
    Transition,
)


@dataclass(slots=True)
class Observation:
    """What a simulation saw, in picoseconds: the greatest response per task, and per region the cost of each of its
    activations in order."""

    responses: dict[str, int] = field(default_factory=dict)
    costs: dict[str, list[int]] = field(default_factory=dict)
    jobs: int = 0


@dataclass(slots=True)
class _Machine:
    """A region while it runs. `epoch` counts the entries of its states, `parent_epoch` is the one it was entered in."""

    name: str
    instance: Instance
    region: Region
    period: int
    parent: _Machine | None
    within: str
    phase: int = 0
    state: State | None = None
    since: int = 0
    epoch: int = 0
    parent_epoch: int = -1
    inbox: dict[str, list[tuple[Endpoint, int]]] = field(default_factory=dict)


@dataclass(slots=True)
class _Task:
    name: str
    priority: int
    period: int
    jitter: int
    sporadic: bool
    machines: list[_Machine]
    instances: list[Instance]
    exchange: dict[str, int]
    queue: list[_Job] = field(default_factory=list)
    released: int = 0
    number: int = 0


@dataclass(slots=True)
class _Job:
    task: _Task | None
    nominal: int
    release: int
    arrived: int
    copied: dict[int, dict[str, int]] = field(default_factory=dict)
    due: list[_Machine] = field(default_factory=list)
    segments: list[list[int]] = field(default_factory=list)
    writes: set[Endpoint] = field(default_factory=set)
    started: bool = False
    inside: bool = False
    waits: bool = False
    asked: list[_Request] = field(default_factory=list)
    answers: list[_Request] = field(default_factory=list)


@dataclass(slots=True, eq=False)
class _Request:
    """A call that waits for the owner of its operation."""

    target: Endpoint
    caller: _Job


CALL = -2
"""In place of a ceiling: the segment is a wait for the answer to a call."""


class Simulation:
    """One run of the tasks of a deployment of one node."""

    def __init__(self, deployment: Deployment, times: Mapping[tuple[str, str], int], seed: int) -> None:
        self.random = Random(seed)
        self.deployment = deployment
        self.node: Node = deployment.nodes[0]
        self.times = times
        self.greedy = self.random.random() < 0.5
        self.full = self.random.random() < 0.8
        self.fifo = self.random.random() < 0.5
        self.together = self.random.random() < 0.4
        self.ambush = self.random.random() < 0.5
        self.late = self.random.random() < 0.3
        self.hidden: list[_Task] = []
        self.requests: list[_Request] = []
        self.calls: dict[int, Endpoint] = {}
        self.instances = {instance.name: instance for instance in deployment.architecture.instances}
        self.services = {c.caller: c.provider for c in deployment.architecture.services}
        self.pending: dict[str, set[str]] = {name: set() for name in self.instances}
        self.machines: list[_Machine] = []
        self.tasks = self._tasks()
        self.seen = Observation()
        self._find_sharing()
        self.events: list[tuple[int, int, object]] = []
        self.sequence = 0

    # ------------------------------------------------------------------------------------------ structure
    def _machines_of(self, instance: Instance) -> list[_Machine]:
        found: list[_Machine] = []

        def walk(region: Region, path: tuple[str, ...], parent: _Machine | None, within: str) -> None:
            here = (*path, region.name) if region.name else path
            around = parent.period if parent else (instance.period.value if instance.period else 0)
            period = _every(region) or around or _anything(region)
            machine = _Machine(".".join((instance.name, *here)), instance, region, period, parent, within)
            found.append(machine)
            for state in region.states:
                for nested in state.regions:
                    walk(nested, here, machine, state.name)

        for region in instance.component.regions:
            walk(region, (), None, "")
        return found

    def _tasks(self) -> list[_Task]:
        active = [instance for instance in self.instances.values() if instance.active]
        by_instance = {instance.name: self._machines_of(instance) for instance in active}
        self.machines = [machine for machines in by_instance.values() for machine in machines]
        if self.node.threads:
            return [self._thread(thread, by_instance) for thread in self.node.threads]
        tasks = []
        for instance in active:
            machines = by_instance[instance.name]
            period = gcd(*(machine.period for machine in machines))
            assert instance.priority is not None
            tasks.append(
                _Task(
                    instance.name, instance.priority.value, period, instance.jitter, instance.sporadic, machines,
                    [instance], {instance.name: self._exchange(instance)},
                )
            )  # fmt: skip
        return tasks

    def _thread(self, thread: Thread, by_instance: Mapping[str, list[_Machine]]) -> _Task:
        members = {str(member) for member, _ in thread.members}
        elsewhere = {str(m) for t in self.node.threads if t is not thread for m, _ in t.members}
        machines: list[_Machine] = []
        for owned in by_instance.values():
            for machine in owned:
                parts = machine.name.split(".")
                prefixes = [".".join(parts[:n]) for n in range(len(parts), 0, -1)]
                nearest = next((p for p in prefixes if p in members or p in elsewhere), "")
                if nearest in members:
                    machines.append(machine)
        period = thread.period.value if thread.period else gcd(*(machine.period for machine in machines))
        instances = list({m.instance.name: m.instance for m in machines}.values())
        exchange = {i.name: self._exchange(i) for i in instances}
        jitter = max([thread.jitter, *(i.jitter for i in instances)])
        sporadic = any(i.sporadic for i in instances)
        priority = thread.priority.value if thread.priority else 0
        return _Task(thread.name, priority, period, jitter, sporadic, machines, instances, exchange)

    def _exchange(self, instance: Instance) -> int:
        costs = {name: cost for name, cost, _ in self.node.exchanges}
        return costs.get(instance.name, costs.get("", 0))

    def set_priorities(self, priorities: Mapping[str, int]) -> None:
        """Priorities that the analysis chose where none are written."""
        for task in self.tasks:
            task.priority = priorities[task.name]
        self._find_sharing()

    def _find_sharing(self) -> None:
        """The ceiling of each provider, of each datum that several tasks reach, and of each port connected."""
        touched: dict[Endpoint, list[tuple[_Task, bool, bool]]] = {}
        self.ceilings: dict[str, int] = {}
        for task in self.tasks:
            for machine in task.machines:
                for step in _all_steps(machine.region):
                    if isinstance(step, CallMethod):
                        target = self.services[Endpoint(machine.instance.name, step.method)]
                        if not self._in_owner(target):
                            self._raise(target.instance, task.priority)
                    for datum, writes, called in self._touches(machine.instance, step):
                        touched.setdefault(datum, []).append((task, writes, called))
        self.shared: dict[Endpoint, int] = {}
        for datum, accesses in touched.items():
            several = len({id(task) for task, _, _ in accesses}) > 1
            if several and any(w for _, w, _ in accesses) and not all(c for _, _, c in accesses):
                self.shared[datum] = max(task.priority for task, _, _ in accesses)
        self.port_ceiling: dict[str, int] = {}
        for connection in self.deployment.architecture.data:
            ends = {connection.source.instance, connection.target.instance}
            top = max((t.priority for t in self.tasks for i in t.instances if i.name in ends), default=0)
            for end in ends:
                self.port_ceiling[end] = max(self.port_ceiling.get(end, 0), top)

    def _raise(self, resource: str, priority: int) -> None:
        self.ceilings[resource] = max(self.ceilings.get(resource, 0), priority)

    def _touches(self, instance: Instance, step: Step) -> Iterator[tuple[Endpoint, bool, bool]]:
        match step:
            case RunCodel(codel=name):
                codel = instance.component.codel(name)
                yield from ((Endpoint(instance.name, d), False, False) for d in codel.reads)
                yield from ((Endpoint(instance.name, d), True, False) for d in codel.writes)
            case CallMethod(method=method, arguments=arguments, result=result):
                yield from ((Endpoint(instance.name, d), False, False) for d in arguments)
                if result:
                    yield Endpoint(instance.name, result), True, False
                target = self.services[Endpoint(instance.name, method)]
                provider = self.instances[target.instance]
                if provider.component.kind is not ComponentKind.ACTIVE or self._in_owner(target):
                    return
                operation = next(o for o in provider.component.operations if o.name == target.name)
                codel = provider.component.codel(operation.codel)
                own = {p.name for p in provider.component.ports} | {d.name for d in provider.component.data}
                yield from ((Endpoint(provider.name, d), False, True) for d in codel.reads if d in own)
                yield from ((Endpoint(provider.name, d), True, True) for d in codel.writes if d in own)

    def _in_owner(self, target: Endpoint) -> bool:
        """Whether an operation is carried out by its owner's task."""
        operations = self.instances[target.instance].component.operations
        return any(o.name == target.name and o.runs is RunsIn.OWNER for o in operations)

    # ------------------------------------------------------------------------------------------ one activation
    def _time(self, wcet: int) -> int:
        if self.full or self.random.random() < 0.5:
            return wcet
        return self.random.randint(0, wcet)

    def _execute(self, steps: tuple[Step, ...], machine: _Machine, job: _Job) -> int:
        """Append what the steps need to the job; their cost."""
        total = 0
        for step in steps:
            instance, name = machine.instance, ""
            ceiling = max((self.shared[d] for d, _, _ in self._touches(instance, step) if d in self.shared), default=-1)
            match step:
                case RunCodel(codel=codel):
                    name = codel
                    component = instance.component
                    outs = {p.name for p in component.ports if p.kind is PortKind.OUT}
                    writes = set(component.codel(codel).writes)
                case CallMethod(method=method, result=result):
                    target = self.services[Endpoint(instance.name, method)]
                    if self._in_owner(target):
                        total += self._ask(target, job)
                        continue
                    ceiling = max(ceiling, self.ceilings[target.instance])
                    component = self.instances[target.instance].component
                    name = next(o.codel for o in component.operations if o.name == target.name)
                    outs = {p.name for p in instance.component.ports if p.kind is PortKind.OUT}
                    writes = {result}
            cost = self._time(self.times[component.name, name])
            job.segments.append([cost, ceiling])
            job.writes |= {Endpoint(instance.name, port) for port in outs & writes}
            total += cost
        return total

    def _ask(self, target: Endpoint, job: _Job) -> int:
        """A call that waits: away from the task and back to it, and what the switches cost."""
        switch = self.node.board.context_switch
        wait = [0, CALL]
        self.calls[id(wait)] = target
        job.segments += [[switch, -1], wait, [switch, -1]]
        return 2 * switch

    def _serve(self, machine: _Machine, state: State, job: _Job, first: bool = False) -> int:
        """Carry out the requests that this state serves; without any, its method steps run or do not, except in the
        `first` activation."""
        component = machine.instance.component
        steps = self._steps(state, Role.METHOD)
        codels = {operation.codel for operation in component.operations}
        named = {step.codel for step in steps if isinstance(step, RunCodel)}
        general = tuple(s for s in steps if not isinstance(s, RunCodel) or s.codel not in codels)
        waiting = self.requests if self.late else [one for one in job.asked if one in self.requests]
        cost, served = 0, False
        for request in list(waiting) if steps else []:
            operation = next((o for o in component.operations if o.name == request.target.name), None)
            if operation is None or request.target.instance != machine.instance.name:
                continue
            if general or operation.codel in named:
                self.requests.remove(request)
                job.answers.append(request)
                cost += self._execute((*general, RunCodel(operation.codel, operation.span)), machine, job)
                served = True
        if not served and not first and self.random.random() < 0.5:
            cost += self._execute(general, machine, job)
        return cost

    def _steps(self, state: State, role: Role) -> tuple[Step, ...]:
        """The steps that a role executes at an activation; those of `once` activities belong to the entry."""
        return tuple(s for a in state.activities if a.role is role and a.apart is None for s in a.steps)

    def _entry(self, state: State) -> tuple[Step, ...]:
        once = tuple(s for a in state.activities if a.role is not Role.ENTRY and a.apart is not None for s in a.steps)
        return tuple(s for a in state.activities if a.role is Role.ENTRY for s in a.steps) + once

    def _step(self, machine: _Machine, job: _Job, now: int) -> int:
        """One activation of a region; what it cost."""
        parent = machine.parent
        inside = parent is None or (parent.state is not None and parent.state.name == machine.within)
        epoch = parent.epoch if parent is not None else 0
        initial = next(s for s in machine.region.states if s.name == machine.region.initial)
        if machine.state is None:
            if not inside:
                return 0
            cost = self._enter(machine, initial, job, now, epoch)
            return cost + (self._serve(machine, initial, job, True) if parent is None else 0)
        if parent is None or (inside and epoch == machine.parent_epoch):
            return self._fire(machine, machine.state, job, now)
        cost = 0
        if self.greedy or self.random.random() < 0.5:
            cost += self._activity(machine, machine.state, job)
            cost += sum(self._execute(t.guards, machine, job) for t in machine.state.transitions)
        cost += self._execute(self._steps(machine.state, Role.EXIT), machine, job)
        machine.state = None
        return cost + (self._enter(machine, initial, job, now, epoch) if inside else 0)

    def _enter(self, machine: _Machine, state: State, job: _Job, now: int, epoch: int) -> int:
        machine.state, machine.since, machine.parent_epoch = state, now, epoch
        machine.epoch += 1
        return self._execute(self._entry(state), machine, job)

    def _activity(self, machine: _Machine, state: State, job: _Job) -> int:
        cost = 0
        copied = job.copied.get(id(machine), {})
        for step in self._steps(state, Role.MESSAGE):
            reads = machine.instance.component.codel(step.codel).reads if isinstance(step, RunCodel) else ()
            named = [port for port in reads if port in copied]
            count = sum(copied[port] for port in named or copied)
            for _ in range(count or self.random.randint(0, 1)):
                cost += self._execute((step,), machine, job)
        cost += self._serve(machine, state, job)
        return cost + self._execute(self._steps(state, Role.RUN), machine, job)

    def _fire(self, machine: _Machine, state: State, job: _Job, now: int) -> int:
        cost = self._activity(machine, state, job)
        for transition in state.transitions:
            possible = self._possible(machine, transition, now)
            if possible or self.random.random() < 0.5:
                called = transition.guards
                if not self.greedy and called and self.random.random() < 0.3:
                    called = called[: self.random.randint(1, len(called))]
                cost += self._execute(called, machine, job)
            if not possible or (transition.guards and self.random.random() < 0.5):
                continue
            self.pending[machine.instance.name].discard(transition.event or "")
            self.pending[machine.instance.name] |= set(transition.emit)
            cost += self._execute(self._steps(state, Role.EXIT), machine, job)
            cost += self._execute(transition.do, machine, job)
            target = next(s for s in machine.region.states if s.name == transition.target)
            return cost + self._enter(machine, target, job, now, machine.parent_epoch)
        return cost

    def _possible(self, machine: _Machine, transition: Transition, now: int) -> bool:
        """Whether neither its event nor its delay keeps a transition from being tried."""
        if transition.after is not None and now - machine.since < transition.after:
            return False
        if transition.event is None:
            return True
        component = machine.instance.component
        if transition.event in component.events:
            return transition.event in self.pending[machine.instance.name]
        ports = {port.name for port in component.ports}
        return transition.event not in ports or self.random.random() < 0.5

    def _begin(self, job: _Job, now: int) -> None:
        """The work of a job, decided when it starts."""
        assert job.task is not None
        switch = self.node.board.context_switch
        job.segments.append([switch, -1])
        exchanges = [(self._time(cost), self.port_ceiling.get(name, -1)) for name, cost in job.task.exchange.items()]
        for cost, ceiling in exchanges:
            job.segments.append([cost // 2, ceiling])
        for machine in job.due:
            cost = self._step(machine, job, now)
            self.seen.costs.setdefault(machine.name, []).append(cost)
        for cost, ceiling in exchanges:
            job.segments.append([cost - cost // 2, ceiling])
        job.segments.append([switch, -1])
        job.started = True

    # ------------------------------------------------------------------------------------------ time
    def _at(self, time: int, what: object) -> None:
        self.sequence += 1
        self.events.append((time, self.sequence, what))

    def _release(self, task: _Task, nominal: int, now: int) -> None:
        """A job arrives nominally; it is released within the jitter, and its in-ports copied then."""
        delay = self.random.choice((0, task.jitter, self.random.randint(0, task.jitter)))
        release = max(now + delay, task.released)
        task.released = release
        self._at(release, _Job(task, nominal, release, self.sequence))

    def _copy(self, job: _Job) -> None:
        """Copy the in-ports for each region that is due; each finds what came since it was last."""
        task = job.task
        assert task is not None
        job.due = [m for m in task.machines if (task.number + m.phase) * task.period % m.period == 0]
        if task.sporadic:
            job.due = list(task.machines)
        task.number += 1
        job.asked = list(self.requests)
        sizes = {(c.source, c.target): c.size for c in self.deployment.architecture.data}
        for machine in job.due:
            ports = [p.name for p in machine.instance.component.ports if p.kind is not PortKind.OUT]
            copied = dict.fromkeys(ports, 0)
            for port in ports:
                target = Endpoint(machine.instance.name, port)
                connected = [(s, size) for (s, t), size in sizes.items() if t == target]
                waiting = machine.inbox.get(port, [])
                for source, size in connected:
                    count = sum(1 for one, _ in waiting if one == source)
                    copied[port] += min(count, size) if size is not None else self.random.randint(0, 1)
                if not connected:
                    copied[port] = self.random.randint(0, 1)
                machine.inbox[port] = []
            job.copied[id(machine)] = copied

    def _publish(self, job: _Job, now: int) -> None:
        """At the end of a job its out-ports are published; that wakes who waits for events."""
        for connection in self.deployment.architecture.data:
            if connection.source not in job.writes:
                continue
            target = self.instances[connection.target.instance]
            for machine in self.machines:
                if machine.instance is target:
                    machine.inbox.setdefault(connection.target.name, []).append((connection.source, now))
            port = next(p for p in target.component.ports if p.name == connection.target.name)
            if target.sporadic and port.kind is PortKind.EVENT:
                for task in self.tasks:
                    if target in task.instances:
                        self._release(task, now, now)

    def _woken(self, task: _Task) -> bool:
        """Whether components of the model wake a sporadic task."""
        names = {i.name: {p.name for p in i.component.ports if p.kind is PortKind.EVENT} for i in task.instances}
        return any(
            c.target.name in names.get(c.target.instance, ()) and self.instances[c.source.instance].active
            for c in self.deployment.architecture.data
        )

    def _arrivals(self, horizon: int) -> None:
        """When tasks, interrupts and ticks arrive. In an ambush all tasks wait until the least urgent one, or another,
        is in a critical section."""
        own = [task for task in self.tasks if not (task.sporadic and self._woken(task))]
        if self.ambush and len(own) > 1:
            first = min(own, key=lambda task: task.priority) if self.fifo else self.random.choice(own)
            owners = {target.instance for target in self.services.values() if self._in_owner(target)}
            serving = [t for t in own if t is not first and any(i.name in owners for i in t.instances)]
            self.hidden = [task for task in own if task is not first and task not in serving]
            own = [first, *serving]
            self._at(horizon // 4, "now")
        for task in own:
            self._arrive(task, 0 if self.together else self.random.randrange(task.period), horizon)
        kernel = [(i.every, (i.wcet or 0) + 2 * self.node.board.context_switch) for i in self.node.interrupts]
        if self.node.board.tick_every is not None:
            kernel.append((self.node.board.tick_every, self.node.board.tick_cost))
        for every, cost in kernel:
            at = 0 if self.together else self.random.randrange(every)
            while at < horizon and cost:
                self._at(at, cost)
                at += every

    def _arrive(self, task: _Task, at: int, horizon: int) -> None:
        if not self.together:
            for machine in task.machines:
                machine.phase = self.random.randrange(max(m.period // task.period for m in task.machines))
        while at < horizon:
            self._at(at, task)
            at += task.period
            if task.sporadic and self.random.random() < 0.3:
                at += self.random.randrange(task.period)

    def _attack(self, now: int, horizon: int) -> None:
        """The hidden tasks arrive."""
        for task in self.hidden:
            self._arrive(task, now + 1, horizon)
        self.hidden = []
        self.events.sort()

    def run(self, horizon: int, most: int) -> Observation:
        """Simulate until `horizon` or until `most` jobs have ended."""
        self._arrivals(horizon)
        self.events.sort()
        ready: list[_Job] = []
        kernel, now = 0, 0
        while self.seen.jobs < most:
            while self.events and self.events[0][0] <= now:
                what = self.events.pop(0)[2]
                if isinstance(what, int):
                    kernel += what
                elif isinstance(what, _Task):
                    self._release(what, now, now)
                    self.events.sort()
                elif isinstance(what, str):
                    self._attack(now, horizon)
                elif isinstance(what, _Job):
                    assert what.task is not None
                    self._copy(what)
                    what.task.queue.append(what)
                    ready.append(what)
            until = self.events[0][0] if self.events else None
            if not kernel and all(job.waits or job.task is None or job.task.queue[0] is not job for job in ready):
                if until is None or until > horizon:
                    break
                now = until
                continue
            if kernel:
                spent = kernel if until is None else min(kernel, until - now)
                kernel, now = kernel - spent, now + spent
                continue
            job = self._choose(ready)
            if not job.started:
                self._begin(job, now)
            segment = job.segments[0]
            if segment[1] == CALL:
                job.waits = True
                self.requests.append(_Request(self.calls.pop(id(segment)), job))
                continue
            if self.hidden and segment[0] > 1 and self.random.random() < 0.3:
                assert job.task is not None
                if segment[1] > job.task.priority:
                    self._attack(now, horizon)
                    until = self.events[0][0]
            spent = segment[0] if until is None else min(segment[0], until - now)
            segment[0] -= spent
            now += spent
            job.inside = bool(segment[0]) and segment[1] >= 0
            if not segment[0]:
                job.segments.pop(0)
                if not job.segments:
                    self._end(job, ready, now)
        return self.seen

    def _end(self, job: _Job, ready: list[_Job], now: int) -> None:
        task = job.task
        assert task is not None
        ready.remove(job)
        task.queue.pop(0)
        self.seen.jobs += 1
        self.seen.responses[task.name] = max(self.seen.responses.get(task.name, 0), now - job.nominal)
        for request in job.answers:
            request.caller.waits = False
            request.caller.segments.pop(0)
        self._publish(job, now)
        self.events.sort()

    def _choose(self, ready: list[_Job]) -> _Job:
        """The most urgent job; one in a critical section has at least its ceiling and yields to no equal."""
        best: list[_Job] = []
        rank = (-1, False)
        for job in ready:
            assert job.task is not None
            if job.task.queue[0] is not job or job.waits:
                continue
            priority = max(job.task.priority, job.segments[0][1]) if job.inside else job.task.priority
            if (priority, job.inside) > rank:
                rank, best = (priority, job.inside), []
            if (priority, job.inside) == rank:
                best.append(job)
        return best[0] if self.fifo else self.random.choice(best)


def _every(region: Region) -> int:
    """The gcd of the periods of the activities of a region, 0 for none."""
    periodic = [a.every for s in region.states for a in s.activities if a.every]
    apart = [a.apart for s in region.states for a in s.activities if a.apart]
    return gcd(*periodic, *apart) if periodic else 0


def _anything(region: Region) -> int:
    """What gives a region a period where nothing around it does: its `once` activities, or its nested regions."""
    apart = gcd(*(a.apart for s in region.states for a in s.activities if a.apart))
    return apart or gcd(*(_every(n) or _anything(n) for s in region.states for n in s.regions))


def _all_steps(region: Region) -> Iterator[Step]:
    for state in region.states:
        for activity in state.activities:
            yield from activity.steps
        for transition in state.transitions:
            yield from (*transition.guards, *transition.do)
