"""Random models that are free of errors: architectures with everything that a check without binaries accepts."""

from __future__ import annotations

from dataclasses import dataclass, field
from random import Random

PERIODS = ((1000, 2000, 4000, 8000), (1000, 2000, 5000, 10000), (1400, 2100, 3300, 5000, 7700))
LIFECYCLE = ("configure", "start", "update", "stop", "cleanup")


@dataclass(slots=True)
class _Component:
    """A component while it is written."""

    name: str
    budget: int
    lines: list[str] = field(default_factory=list)
    behaviour: list[str] = field(default_factory=list)
    codels: list[str] = field(default_factory=list)
    guards: list[str] = field(default_factory=list)
    handlers: list[str] = field(default_factory=list)
    methods: list[str] = field(default_factory=list)
    events: list[str] = field(default_factory=list)
    ports: list[str] = field(default_factory=list)
    regions: list[str] = field(default_factory=list)
    states: int = 0
    named: int = 0


@dataclass(frozen=True, slots=True)
class Options:
    """What a random model may hold."""

    components: tuple[int, int] = (2, 5)
    load: float = 0.75
    explicit: bool = False
    """Whether all priorities are written."""
    calls: float = 0.0
    """How often some operations run in their owners."""


class Writer:
    """Writes one model from a seed."""

    def __init__(self, seed: int, options: Options = Options()) -> None:
        self.random = Random(seed)
        self.options = options
        self.periods = self.random.choice(PERIODS)
        self.components: list[_Component] = []
        self.own: dict[str, int] = {}
        self.sporadic: dict[str, bool] = {}
        self.calling: list[tuple[int, int]] = []
        self.chained = False

    def chance(self, probability: float) -> bool:
        """True this often."""
        return self.random.random() < probability

    def model(self) -> str:
        """The text."""
        count = self.random.randint(*self.options.components)
        self.threaded = self.chance(0.35)
        self.passive = self.random.randint(0, 2)
        self.queued = self.chance(0.5)
        self.servers = self.random.randint(1, 2) if self.options.calls and self.chance(self.options.calls) else 0
        load = self.random.uniform(0.4, 1.1) * self.options.load / count
        for number in range(count):
            self.components.append(self._component(number, load))
        text = ["mauve 1", "import std.lifecycle", *self._board(), *self._passive(), *self._servers(),
                "external component World {", "out port told: f64", "}"]  # fmt: skip
        for component in self.components:
            text += [f"component {component.name} {{", *component.lines, *component.behaviour, "}"]
        return "\n".join((*text, *self._architecture(), *self._deployment(), ""))

    # ------------------------------------------------------------------------------------------ platform
    def _board(self) -> list[str]:
        items = [f"context_switch {self.random.randint(1, 15)}us"] if self.chance(0.5) else []
        if self.chance(0.4):
            items.append(f"tick every {self.random.choice((500, 1000, 1300))}us cost {self.random.randint(1, 20)}us")
        os = ["os small {", *items, "}"] if items else []
        return ["board desk {", 'cpu "arm926ej-s" at 200MHz', *os, "}"]

    def _passive(self) -> list[str]:
        lines = []
        for number in range(self.passive):
            lines += [f"passive component Store{number} {{", "var kept: f64",
                      f"operation put{number}(value: f64) = keep", f"operation take{number}(value: f64): f64 = get",
                      f"codel keep reads value, kept writes kept wcet {self.random.randint(5, 400)}us",
                      f"codel get reads value, kept returns f64 wcet {self.random.randint(5, 300)}us", "}"]  # fmt: skip
        return lines

    def _servers(self) -> list[str]:
        """Components whose own tasks carry out operations; the second may call the first."""
        lines = []
        for number in range(self.servers):
            cost = self.random.randint(1, min(self.periods) // self.random.choice((100, 200, 400)))
            again = number > 0 and self.chance(0.5)
            method = self.random.choice((f"do_ask{number} then do_tell{number}", "look"))
            run = f"w = ask0(v) then poll{number}" if again else f"poll{number}"
            lines += [f"component Server{number} {{", "var v: f64", "var w: f64",
                      f"operation ask{number}(value: f64): f64 = do_ask{number} runs in owner",
                      f"operation tell{number}(value: f64) = do_tell{number} runs in owner",
                      f"codel do_ask{number} reads value, v returns f64 wcet {cost}us",
                      f"codel do_tell{number} reads value writes v wcet {self.random.randint(0, cost)}us",
                      f"codel look wcet {self.random.randint(0, cost)}us", f"codel poll{number} wcet {cost}us",
                      f"codel tired{number} returns bool wcet 1us",
                      *(["method ask0(value: f64): f64"] if again else []),
                      "behaviour {", "initial state Up {", f"method {method}", f"run {run}",
                      f"-> Down when tired{number}", "}", "state Down {", f"method {method}",
                      *([f"exit poll{number}"] if self.chance(0.5) else []),
                      "-> Up", "}", "}", "}"]  # fmt: skip
            self.chained = again
        return lines

    # ------------------------------------------------------------------------------------------ components
    def _component(self, number: int, load: float) -> _Component:
        name = f"C{number}"
        period = self.random.choice(self.periods)
        self.own[name] = period
        one = _Component(name, max(4, int(period * load / 4)))
        self.sporadic[name] = number > 0 and not self.threaded and self.chance(0.25)
        kinds = ["event" if self.sporadic[name] else "in", *(["in"] * self.random.randint(0, 1))]
        for index, kind in enumerate(kinds):
            one.ports.append(f"p{index}")
            one.lines.append(f"{kind} port p{index}: f64")
        one.lines += ["out port made: f64", "var v: f64", "var w: f64", "event Up, Down"]
        one.events = ["Up", "Down"]
        for passive in range(self.passive):
            one.lines += [f"method put{passive}(value: f64)", f"method take{passive}(value: f64): f64"]
            one.methods += [f"put{passive}(v)", f"w = take{passive}(v)"]
        for server in range(self.servers):
            if self.chance(0.6):
                self.calling.append((number, server))
                one.lines += [f"method ask{server}(value: f64): f64", f"method tell{server}(value: f64)"]
                one.methods += [f"w = ask{server}(v)", f"tell{server}(v)"]
        self._codels(one)
        self._behaviour(one)
        return one

    def _codels(self, one: _Component) -> None:
        for index in range(self.random.randint(3, 6)):
            touched = self.random.choice(("", " reads v", " writes v", " reads v writes w", " writes made"))
            if index == 0:
                touched = " writes made"
            one.codels.append(f"c{index}")
            one.lines.append(f"codel c{index}{touched} wcet {self._cost(one)}")
        for index in range(self.random.randint(1, 3)):
            one.guards.append(f"g{index}")
            one.lines.append(f"codel g{index} returns bool wcet {self._cost(one, 4)}")
        for port in [*one.ports, *([""] if self.chance(0.3) else [])]:
            one.handlers.append(f"m{len(one.handlers)}")
            reads = f" reads {port}" if port else ""
            one.lines.append(f"codel {one.handlers[-1]}{reads} wcet {self._cost(one, 3)}")
        if self.chance(0.3):
            one.lines.append(f"codel both reads {', '.join(one.ports)} wcet {self._cost(one, 4)}")
            one.handlers.append("both")

    def _cost(self, one: _Component, part: int = 1) -> str:
        top = max(1, one.budget // part)
        return f"{self.random.choice((0, 1, top, self.random.randint(1, 2 * top), self.random.randint(1, top)))}us"

    def _steps(self, one: _Component) -> str:
        pool = one.codels + (one.methods if self.chance(0.4) else [])
        return " then ".join(self.random.choice(pool) for _ in range(self.random.choice((1, 1, 1, 2))))

    def _behaviour(self, one: _Component) -> None:
        if self.chance(0.12):
            hooks = [f"{hook} {self._steps(one)}" for hook in LIFECYCLE if self.chance(0.8)]
            one.behaviour = ["behaviour orocos {", *hooks, "}"]
            return
        one.behaviour.append("behaviour {")
        count = self.random.choice((1, 1, 2, 3))
        for index in range(count):
            one.regions.append(f"r{index}")
            one.behaviour += self._region(one, f"r{index}", 0, index)
        one.behaviour.append("}")

    def _region(self, one: _Component, name: str, depth: int, index: int) -> list[str]:
        every = 0
        if not self.sporadic[one.name] and self.chance(0.25):
            every = self.own[one.name] * self.random.choice((1, 2, 3)) // self.random.choice((1, 1, 2))
        count = self.random.randint(1, 3)
        first = one.states
        one.states += count
        names = [f"S{first + n}" for n in range(count)]
        lines = [f"region {name} {{"]
        for place, state in enumerate(names):
            lines += [f"{'initial ' if not place else ''}state {state} {{"]
            lines += self._activities(one, every, bool(index or depth or place))
            following = names[place + 1 : place + 2]
            lines += self._transitions(one, names, following)
            if depth < 2 and self.chance(0.22):
                one.named += 1
                lines += self._region(one, f"n{one.named}", depth + 1, index)
            lines.append("}")
        return [*lines, "}"]

    def _activities(self, one: _Component, every: int, optional: bool) -> list[str]:
        own = f" every {every}us" if every else ""
        lines = [f"entry {self._steps(one)}"] if self.chance(0.4) else []
        if self.chance(0.4):
            lines.append(f"message {self.random.choice(one.handlers)}")
        if self.chance(0.1):
            lines.append(f"method {self._steps(one)}")
        if self.chance(0.12):
            apart = f", at least {self.own[one.name] * self.random.choice((2, 3))}us apart" if self.chance(0.7) else ""
            lines.append(f"run {self._steps(one)} once{apart}")
        elif own or not optional or self.chance(0.8):
            lines.append(f"run {'c0' if not optional else self._steps(one)}{own}")
        if self.chance(0.4):
            lines.append(f"exit {self._steps(one)}")
        return lines

    def _transitions(self, one: _Component, names: list[str], following: list[str]) -> list[str]:
        targets = following + [self.random.choice(names) for _ in range(self.random.randint(0, 2))]
        self.random.shuffle(targets)
        lines = []
        for place, target in enumerate(targets):
            words = []
            last = place == len(targets) - 1
            if self.chance(0.25):
                words.append(f"on {self.random.choice(one.events)}")
            if self.chance(0.6):
                words.append(f"when {self._guard(one)}")
            if self.chance(0.12) or (not words and not last):
                words.append(f"after {self.random.randint(1, 4) * self.own[one.name]}us")
            if self.chance(0.3):
                words.append(f"do {self._steps(one)}")
            if self.chance(0.4):
                words.append(f"emit {self.random.choice(one.events)}")
            lines.append(f"-> {target} {' '.join(words)}".rstrip())
        return lines

    def _guard(self, one: _Component) -> str:
        word = self.random.choice(one.guards)
        word = f"not {word}" if self.chance(0.3) else word
        if self.chance(0.3):
            word = f"({word} {self.random.choice(('and', 'or'))} {self.random.choice(one.guards)})"
        return word

    # ------------------------------------------------------------------------------------------ architecture
    def _architecture(self) -> list[str]:
        lines = ["architecture Robot {", "instance world: World"]
        for number, one in enumerate(self.components):
            lines.append(f"instance i{number}: {one.name} {{ {self._attributes(one)} }}")
        lines += [f"instance store{n}: Store{n}" for n in range(self.passive)]
        for server in range(self.servers):
            period = min(self.periods) // (self.random.choice((2, 5, 10)) if not server or self.chained else 1)
            rank = f" priority {self.random.randint(3, 9)}" if self.options.explicit or self.chance(0.75) else ""
            late = f" jitter {period // 3}us" if self.chance(0.2) else ""
            lines.append(f"instance server{server}: Server{server} {{ period {period}us{rank}{late} }}")
        for number, server in self.calling:
            for word in ("ask", "tell"):
                lines.append(f"connect i{number}.{word}{server} -> server{server}.{word}{server}")
        if self.chained:
            lines.append("connect server1.ask0 -> server0.ask0")
        for number, one in enumerate(self.components):
            lines += self._connections(number, one)
        return [*lines, "}"]

    def _attributes(self, one: _Component) -> str:
        period = self.own[one.name]
        words = [f"{'sporadic' if self.sporadic[one.name] else 'period'} {period}us"]
        if self.options.explicit or self.chance(0.75):
            words.append(f"priority {self.random.randint(1, 6)}")
        if self.chance(0.5):
            words.append(f"deadline {int(period * self.random.choice((0.6, 0.9, 1, 1.5, 3)))}us")
        if self.chance(0.2):
            words.append(f"jitter {int(period * self.random.choice((0.05, 0.3, 0.9, 1.6)))}us")
        if self.chance(0.2):
            words.append(f"offset {self.random.randint(0, period)}us")
        return " ".join(words)

    def _connections(self, number: int, one: _Component) -> list[str]:
        lines = []
        for place, port in enumerate(one.ports):
            if self.sporadic[one.name] and place == 0:
                able = [n for n in range(number) if self.own[f"C{n}"] >= self.own[one.name] and not self._spread(n)]
                lines += self._event(number, port, able)
                continue
            writers = [n for n in range(len(self.components)) if n != number and self.chance(0.4)]
            writers = writers[: 2 if self.queued else 1]
            for writer in writers:
                size = self.random.randint(1, 6)
                policy = self.random.choice(("drop oldest", "drop newest"))
                buffered = (
                    f" buffered size {size} {policy}" if len(writers) > 1 or (self.queued and self.chance(0.6)) else ""
                )
                lines.append(f"connect i{writer}.made -> i{number}.{port}{buffered}")
        for passive in range(self.passive):
            lines.append(f"connect i{number}.put{passive} -> store{passive}.put{passive}")
            lines.append(f"connect i{number}.take{passive} -> store{passive}.take{passive}")
        return lines

    def _spread(self, number: int) -> bool:
        """Whether regions of a component have periods of their own, which may be shorter than its own."""
        return any(" every " in line or " apart" in line for line in self.components[number].behaviour)

    def _event(self, number: int, port: str, able: list[int]) -> list[str]:
        policy = " buffered size 3 drop oldest" if self.queued else ""
        if able and self.chance(0.8):
            return [f"connect i{self.random.choice(able)}.made -> i{number}.{port}{policy}"]
        return [f"connect world.told -> i{number}.{port}{policy}"]

    # ------------------------------------------------------------------------------------------ deployment
    def _deployment(self) -> list[str]:
        lines = ["deployment bench of Robot {", "node base on desk {"]
        if self.chance(0.3):
            lines.append(f"interrupt line every {self.random.randint(200, 3000)}us wcet {self.random.randint(1, 30)}us")
        lines += ["process main {", "lock immediate_ceiling"]
        if self.chance(0.4):
            lines.append(f"exchange ports {self.random.randint(1, 60)}us")
        if self.chance(0.2):
            lines.append(f"exchange i0.ports {self.random.randint(1, 60)}us")
        if self.threaded:
            lines += self._threads()
        return [*lines, "}", "}", "}"]

    def _threads(self) -> list[str]:
        members = []
        for number, one in enumerate(self.components):
            calls = any(caller == number for caller, _ in self.calling)
            if len(one.regions) > 1 and not calls and self.chance(0.5):
                members += [f"i{number}.{region}" for region in one.regions]
            else:
                members.append(f"i{number}")
        self.random.shuffle(members)
        threads = []
        while members:
            size = self.random.choice((1, 1, 2, 3))
            group, members = members[:size], members[size:]
            priority = f" priority {self.random.randint(1, 6)}" if self.options.explicit or self.chance(0.7) else ""
            threads.append(f"thread t{len(threads)}{priority} {{ {' '.join(group)} }}")
        for server in range(self.servers):
            priority = f" priority {self.random.randint(3, 9)}" if self.options.explicit or self.chance(0.7) else ""
            threads.append(f"thread s{server}{priority} {{ server{server} }}")
        return threads


def random_model(seed: int, options: Options | None = None) -> str:
    """A model without errors, the same for the same seed."""
    return Writer(seed, options or Options()).model()
