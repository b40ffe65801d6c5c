"""No simulated flow is slower than its bounds: chains of random tasks, polled or woken, some waiting for a server."""

from __future__ import annotations

import os
from bisect import bisect_right
from random import Random

from endtoend.checked import Checked, checked
from endtoend.interpreter import Simulation, _Job

from mauve.model.model import Endpoint
from mauve.timing.response import Method
from mauve.verdict.flows import FlowResult, check_flows

SYSTEMS = int(os.environ.get("MAUVE_SYSTEMS", "16"))

Born = tuple[int, int]
"""The nominal arrival and the release of the job that read the data at the begin of the flow."""


class Followed(Simulation):
    """A simulation that follows data from the first to the last instance of a flow over their ports `in` and `out`."""

    def __init__(self, found: Checked, seed: int) -> None:
        super().__init__(found.deployment, found.times, seed)
        self.ambush = False  # it keeps tasks from running at all at first
        self.names = [step.instance for step in found.deployment.architecture.flows[0].steps]
        self.at: dict[Endpoint, Born] = {}
        self.carried: dict[tuple[int, str], Born] = {}
        self.read: list[int] = []
        self.outputs: list[tuple[int, Born]] = []

    def _copy(self, job: _Job) -> None:
        super()._copy(job)
        assert job.task is not None
        for instance in job.task.instances:
            if instance.name == self.names[0]:
                self.read.append(job.release)
                self.carried[id(job), instance.name] = (job.nominal, job.release)
            elif (born := self.at.get(Endpoint(instance.name, "got"))) is not None:
                self.carried[id(job), instance.name] = born

    def _publish(self, job: _Job, now: int) -> None:
        assert job.task is not None
        for instance in job.task.instances:
            born = self.carried.pop((id(job), instance.name), None)
            if born is not None and instance.name in self.names:
                if instance.name == self.names[-1]:
                    self.outputs.append((now, born))
                for connection in self.deployment.architecture.data:
                    if connection.source.instance == instance.name:
                        self.at[connection.target] = born
        super()._publish(job, now)

    def latencies(self) -> tuple[int, int]:
        """The greatest reaction time and data age seen after each component has made its first activation, which
        only enters the initial state."""
        started = (len(self.names) + 2) * max(task.period for task in self.tasks)
        age = max((now - born[0] for now, born in self.outputs), default=0)
        releases = [born[1] for _, born in self.outputs]
        reaction = 0
        for missed in (at for at in self.read if at > started):  # a change just after this job read its inputs
            place = bisect_right(releases, missed)
            if place < len(releases):
                reaction = max(reaction, self.outputs[place][0] - missed)
        return reaction, age


def _model(random: Random) -> str:
    count = random.randint(2, 4)
    server = random.random() < 0.4
    parts, instances, connections = [], [], []
    period = 0
    for place in range(count):
        woken = place > 0 and random.random() < 0.3
        period = period if woken else random.choice((1000, 1400, 2000, 3300, 5000))
        waits = server and random.random() < 0.4
        step = "act then v = ask(v)" if waits else "act"
        kind = "event" if woken else "in"
        cost = random.randint(1, period // (2 * count))
        parts += [f"component C{place} {{", f"{kind} port got: f64", "out port made: f64", "var v: f64",
                  *(["method ask(x: f64): f64"] if waits else []),
                  f"codel act reads got writes made wcet {cost}us",
                  f"behaviour {{ initial state On {{ run {step} }} }}", "}"]  # fmt: skip
        jitter = f" jitter {random.randint(0, period)}us" if not woken and random.random() < 0.3 else ""
        rate = "sporadic" if woken else "period"
        instances.append(f"instance i{place}: C{place} {{ {rate} {period}us priority {random.randint(1, 6)}{jitter} }}")
        if place:
            connections.append(f"connect i{place - 1}.made -> i{place}.got")
        if waits:
            connections.append(f"connect i{place}.ask -> server.ask")
    if server:
        parts += ["component Server {", "operation ask(x: f64): f64 = solve runs in owner",
                  "codel solve reads x returns f64 wcet 10us",
                  "behaviour { initial state On { method solve } }", "}"]  # fmt: skip
        instances.append("instance server: Server { period 200us priority 7 }")
    flow = f"flow whole: i0.made -> ... -> i{count - 1}.made"
    return "\n".join((
        "mauve 1", "board desk {", 'cpu "arm926ej-s" at 200MHz', "}", *parts, "architecture Robot {", *instances,
        *connections, flow, "}", "deployment bench of Robot {", "node base on desk { }", "}", "",
    ))  # fmt: skip


def _flow(found: Checked) -> FlowResult:
    settled = found.settled[Method.TRACE]
    (flow,) = check_flows(found.deployment, list(zip(settled.nodes, settled.results, strict=True)))
    return flow


def test_no_simulated_flow_exceeds_its_bounds() -> None:
    compared, closest = 0, 0.0
    for seed in range(SYSTEMS):
        found, errors = checked(_model(Random(seed)))
        assert found is not None, errors
        flow = _flow(found)
        if flow.latencies is None or flow.latencies.reaction.total is None or flow.latencies.age.total is None:
            continue
        for run in range(2):
            simulation = Followed(found, 100 * seed + run)
            simulation.set_priorities({one.task.name: one.task.priority for one in found.node.tasks})
            simulation.run(60 * max(one.task.period for one in found.node.tasks), 400)
            reaction, age = simulation.latencies()
            assert reaction <= flow.latencies.reaction.total, (seed, run)
            assert age <= flow.latencies.age.total, (seed, run)
            compared += 1
            closest = max(closest, reaction / flow.latencies.reaction.total)
    assert compared > SYSTEMS // 2 and closest > 0.6
