"""Graphs for the tests of the path solvers: random ones, their loop nests by a naive method, and exhaustive search."""

from __future__ import annotations

from dataclasses import replace
from random import Random

from mauve.wcet.binary.graph import EXIT
from mauve.wcet.binary.loops import Loop, LoopNest
from mauve.wcet.ipet.problem import PathProblem

Edges = list[tuple[int, int]]


def nest_of(blocks: int, entry: int, edges: Edges) -> LoopNest | None:
    """The loop nest by plain dominator sets; None when a cycle is left over (an irreducible graph)."""
    everything = frozenset(range(blocks))
    predecessors: dict[int, list[int]] = {block: [] for block in everything}
    for source, target in edges:
        if target != EXIT:
            predecessors[target].append(source)
    dominators = dict.fromkeys(everything, everything)
    dominators[entry] = frozenset({entry})
    changed = True
    while changed:
        changed = False
        for block in everything - {entry}:
            sets = [dominators[p] for p in predecessors[block]]
            new = frozenset({block}) | (frozenset.intersection(*sets) if sets else everything)
            if new != dominators[block]:
                dominators[block], changed = new, True
    back = [i for i, (s, t) in enumerate(edges) if t != EXIT and t in dominators[s]]
    if _cyclic(blocks, [edge for i, edge in enumerate(edges) if i not in back]):
        return None
    bodies: dict[int, set[int]] = {}
    for index in back:
        source, header = edges[index]
        body = bodies.setdefault(header, {header})
        waiting = [source]
        while waiting:
            block = waiting.pop()
            if block not in body:
                body.add(block)
                waiting += predecessors[block]
    order = sorted(bodies, key=lambda header: (-len(bodies[header]), header))
    loops = []
    for index, header in enumerate(order):
        around = [i for i in range(index) if header in bodies[order[i]]]
        parent = min(around, key=lambda i: len(bodies[order[i]]), default=None)
        inside = frozenset(bodies[header])
        backs = tuple(i for i in back if edges[i][1] == header)
        entries = tuple(i for i, (s, t) in enumerate(edges) if t == header and s not in inside)
        loops.append(Loop(index, header, inside, backs, entries, parent, len(around) + 1))
    return LoopNest(tuple(loops))


def _cyclic(blocks: int, edges: Edges) -> bool:
    degree = [0] * blocks
    for _, target in edges:
        if target != EXIT:
            degree[target] += 1
    waiting = [block for block in range(blocks) if degree[block] == 0]
    done = 0
    while waiting:
        block = waiting.pop()
        done += 1
        for source, target in edges:
            if source == block and target != EXIT:
                degree[target] -= 1
                if degree[target] == 0:
                    waiting.append(target)
    return done < blocks


def random_problem(random: Random, blocks: int, extra: int, largest_bound: int = 6) -> PathProblem | None:
    """A random graph in which all blocks are reachable and reach EXIT; None when it is irreducible."""
    edges: Edges = [(random.randrange(block), block) for block in range(1, blocks)]
    edges += [(block, EXIT) for block in range(blocks) if not any(source == block for source, _ in edges)]
    for _ in range(extra):
        edges.append((random.randrange(blocks), random.choice([EXIT, *range(blocks)])))
    edges = list(dict.fromkeys(edges))
    nest = nest_of(blocks, 0, edges)
    if nest is None:
        return None
    costs = tuple(random.randrange(30) for _ in edges)
    bounds = {index: random.randint(1, largest_bound) for index in range(len(nest.loops))}
    return PathProblem(blocks, 0, tuple(edges), costs, nest, bounds)


class Structured:
    """A random structured program: sequences, branches, loops with break and continue, returns."""

    def __init__(self, random: Random) -> None:
        self.random = random
        self.edges: Edges = []
        self.blocks = 0

    def block(self) -> int:
        self.blocks += 1
        return self.blocks - 1

    def statement(self, at: int, depth: int, loops: list[tuple[int, int]]) -> int:
        """Code from block `at`; the block where it continues."""
        match self.random.choice(["plain", "branch", "loop", "loop", "jump", "sequence"] if depth else ["plain"]):
            case "branch":
                join = self.block()
                for _ in range(2):
                    arm = self.block()
                    self.edges.append((at, arm))
                    self.edges.append((self.statement(arm, depth - 1, loops), join))
                return join
            case "loop":
                header, after = self.block(), self.block()
                body = self.block()
                self.edges += [(at, header), (header, body)]
                end = self.statement(body, depth - 1, [*loops, (header, after)])
                self.edges += [(end, header), (header if self.random.random() < 0.5 else end, after)]
                return after
            case "jump":
                rest = self.block()
                self.edges.append((at, rest))
                choices = [EXIT, *(target for pair in loops for target in pair)]
                self.edges.append((at, self.random.choice(choices)))
                return rest
            case "sequence":
                return self.statement(self.statement(at, depth - 1, loops), depth - 1, loops)
            case _:
                return at

    def problem(self, depth: int, largest_bound: int = 5, largest_cost: int = 50) -> PathProblem:
        entry = self.block()
        last = self.statement(entry, depth, [])
        edges = list(dict.fromkeys([*self.edges, (last, EXIT)]))
        nest = nest_of(self.blocks, entry, edges)
        assert nest is not None
        costs = tuple(self.random.randrange(largest_cost) for _ in edges)
        bounds = {index: self.random.randint(1, largest_bound) for index in range(len(nest.loops))}
        return PathProblem(self.blocks, entry, tuple(edges), costs, nest, bounds)


def longest_by_search(problem: PathProblem, limit: int = 200_000) -> int | None:
    """The most expensive path by trying all of them, counting headers per entry, totals and limited edges, and
    keeping groups of edges apart; None beyond the limit."""
    out: dict[int, list[int]] = {}
    for index, (source, _) in enumerate(problem.edges):
        if index not in problem.infeasible:
            out.setdefault(source, []).append(index)
    loops = problem.nest.loops
    starts = [int(loop.header == problem.entry) for loop in loops]
    limited = sorted(problem.limits)
    free: tuple[int | None, ...] = (None,) * len(problem.exclusive)
    stack = [(problem.entry, 0, tuple(starts), tuple(starts), (0,) * len(limited), free)]
    best, steps = -1, 0
    while stack:
        block, cost, here, totals, passed, chosen = stack.pop()
        steps += 1
        if steps > limit:
            return None
        for edge in out.get(block, ()):
            target = problem.edges[edge][1]
            now, sums = list(here), list(totals)
            for index, loop in enumerate(loops):
                if target == loop.header:
                    now[index] = here[index] + 1 if edge in loop.back_edges else 1
                    sums[index] += 1
            if any(now[index] > problem.bounds[index] for index in range(len(loops))):
                continue
            if any(sums[index] > total for index, total in problem.totals.items()):
                continue
            taken = tuple(n + (edge == limit) for n, limit in zip(passed, limited, strict=True))
            if any(n > problem.limits[edge] for n, edge in zip(taken, limited, strict=True)):
                continue
            picked = list(chosen)
            for number, (group, _) in enumerate(problem.exclusive):
                if edge in group:
                    picked[number] = edge if chosen[number] in (None, edge) else -1
            if -1 in picked:
                continue
            for number, (_, scope) in enumerate(problem.exclusive):
                if scope is not None and target == loops[scope].header:
                    picked[number] = None
            if target == EXIT:
                best = max(best, cost + problem.costs[edge])
            else:
                stack.append((target, cost + problem.costs[edge], tuple(now), tuple(sums), taken, tuple(picked)))
    return best if best >= 0 else None


def nested(depth: int, bound: int, cost: int) -> PathProblem:
    """Loops in each other: header i, then header i+1, ..., with a body in the middle; each exits from its header."""
    edges: Edges = [(i, i + 1) for i in range(depth)]
    edges += [(depth, depth - 1)]
    edges += [(i, i - 1) for i in range(depth - 1, 0, -1)]
    edges += [(0, EXIT)]
    nest = nest_of(depth + 1, 0, edges)
    assert nest is not None
    return PathProblem(depth + 1, 0, tuple(edges), (cost,) * len(edges), nest, dict.fromkeys(range(depth), bound))


def with_totals(problem: PathProblem, totals: dict[int, int]) -> PathProblem:
    return replace(problem, totals=totals)


def large(blocks: int, seed: int = 1) -> PathProblem:
    """A structured program of about that many blocks, up to five loops deep; its nest is known by construction."""
    random = Random(seed)
    edges: Edges = []
    loops: list[Loop] = []
    count = 1

    def new() -> int:
        nonlocal count
        count += 1
        return count - 1

    def sequence(at: int, depth: int, around: tuple[int, ...]) -> int:
        for _ in range(4):
            if depth and random.random() < 0.35:
                header, body, index = new(), new(), len(loops)
                entry = len(edges)
                edges.append((at, header))
                edges.append((header, body))
                loops.append(Loop(index, header, frozenset(), (), (entry,), None, 1))
                end = sequence(body, depth - 1, (*around, index))
                edges.append((end, header))
                inside = frozenset(range(header, count))
                parent = around[-1] if around else None
                loops[index] = Loop(index, header, inside, (len(edges) - 1,), (entry,), parent, len(around) + 1)
                at = new()
                edges.append((header, at))
            else:
                left, right, join = new(), new(), new()
                edges.extend([(at, left), (at, right), (left, join), (right, join)])
                at = join
        return at

    last = 0
    while count < blocks:
        last = sequence(last, 5, ())
    edges.append((last, EXIT))
    costs = tuple(random.randrange(1, 30) for _ in edges)
    bounds = {index: random.randint(1, 50) for index in range(len(loops))}
    return PathProblem(count, 0, tuple(edges), costs, LoopNest(tuple(loops)), bounds)
