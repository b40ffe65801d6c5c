"""Edges that exclude each other: in the linear program, in the facts that conditions give, and in compiled code."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from itertools import product
from pathlib import Path
from random import Random

import pytest
from emulator import Emulator
from hypothesis import given, settings
from hypothesis import strategies as st
from wcet.ipet import modes
from wcet.ipet.graphs import Edges, Structured, longest_by_search, nest_of
from wcet.soundness.replay import Replay, record

from mauve.wcet.analysis import analyse
from mauve.wcet.binary.elf import Binary, load
from mauve.wcet.binary.graph import EXIT
from mauve.wcet.flow.exclusive.facts import Facts, OrderKey, all_of, contradicts, facts_of, one_of
from mauve.wcet.flow.program import analyse_program
from mauve.wcet.flow.rank.terms import Kind, Relation, Term, Var, add, number, scale, variable
from mauve.wcet.flow.result import ProgramFlow
from mauve.wcet.hardware.board import Board
from mauve.wcet.hardware.core import load_core
from mauve.wcet.ipet.bottom_up import bound_program
from mauve.wcet.ipet.problem import PathProblem
from mauve.wcet.ipet.program import format_program, violated
from mauve.wcet.ipet.solve import Method, solve

IMAGES = Path(__file__).parent / "images"
WORD = 1 << 32
TIGHTENED = ("global", "argument", "flag", "twice", "looped", "each", "object", "saved")
FLAGS = (
    "-std=gnu11 -fno-common -nostdlib -nostartfiles -Wl,--build-id=none -Wl,-Ttext=0x8000 -Wl,-Tdata=0x40000"
    " -Wl,-e,_start"
)
CORES = {"arm7tdmi": "-marm -mthumb-interwork", "cortex-m3": "-mthumb"}


# ------------------------------------------------------------------------------------------------ the linear program
def decisions(random: Random) -> tuple[PathProblem, dict[int, frozenset[tuple[int, ...]]]]:
    """A chain of decisions over three variables of four values each; the assignments that go with each edge."""
    everything = frozenset(product(range(3), repeat=3))
    edges: Edges = []
    allowed: dict[int, frozenset[tuple[int, ...]]] = {}
    blocks = 1
    at = 0
    for _ in range(random.randint(2, 7)):
        variable_, value = random.randrange(3), random.randrange(3)
        yes = frozenset(values for values in everything if values[variable_] == value)
        join = blocks + 2
        for arm, holds in ((blocks, yes), (blocks + 1, everything - yes)):
            allowed[len(edges)] = holds
            edges += [(at, arm), (arm, join)]
        blocks, at = blocks + 3, join
    edges.append((at, EXIT))
    nest = nest_of(blocks, 0, edges)
    assert nest is not None
    costs = tuple(random.randrange(100) for _ in edges)
    pairs = [(a, b) for a in allowed for b in allowed if a < b and not allowed[a] & allowed[b]]
    kept = tuple((pair, None) for pair in pairs if edges[pair[0]][0] != edges[pair[1]][0] and random.random() < 0.8)
    return PathProblem(blocks, 0, tuple(edges), costs, nest, {}, exclusive=kept), allowed


def longest_consistent(problem: PathProblem, allowed: dict[int, frozenset[tuple[int, ...]]]) -> int:
    """The dearest path that some assignment takes."""
    best = 0
    for values in product(range(3), repeat=3):
        block, cost = problem.entry, 0
        while block != EXIT:
            edge = next(
                i for i, (s, _) in enumerate(problem.edges) if s == block and values in allowed.get(i, {values})
            )
            cost, block = cost + problem.costs[edge], problem.edges[edge][1]
        best = max(best, cost)
    return best


@pytest.mark.parametrize("seed", range(60))
def test_bounds_with_pairs_are_never_below_the_longest_consistent_path(seed: int) -> None:
    problem, allowed = decisions(Random(seed))
    solution, free = solve(problem), solve(problem, Method.STRUCTURAL)
    assert solution is not None and free is not None
    assert longest_consistent(problem, allowed) <= solution.cycles <= free.cycles
    ilp = solve(problem, Method.ILP)
    assert ilp is not None and longest_consistent(problem, allowed) <= ilp.cycles
    assert solution.cycles <= ilp.cycles
    if solution.attained:
        assert violated(problem, solution.counts) == ()


@pytest.mark.parametrize("seed", range(40))
def test_groups_in_loops_never_cut_a_path_that_keeps_them(seed: int) -> None:
    """Random groups of a graph with loops; a path is followed with the rule itself, not with the row."""
    random = Random(seed)
    problem = Structured(random).problem(depth=3, largest_bound=3)
    scopes: list[int | None] = [None, *range(len(problem.nest.loops))]
    groups = []
    for _ in range(random.randint(1, 3)):
        scope = random.choice(scopes)
        inside = [
            i for i, (s, _) in enumerate(problem.edges) if scope is None or s in problem.nest.loops[scope].blocks
        ]
        if len(inside) > 1:
            groups.append((tuple(sorted(random.sample(inside, 2))), scope))
    problem = replace(problem, exclusive=tuple(groups))
    longest = longest_by_search(problem, limit=20_000)
    solution = solve(problem)
    assert solution is not None
    if longest is not None:
        assert solution.cycles >= longest


def test_groups_are_rows_of_the_program_that_is_written() -> None:
    """A loop whose body is one of two blocks, four times: one kind in all, or one kind in each iteration."""
    edges = [(0, 1), (0, 2), (1, 0), (2, 0), (0, EXIT)]
    nest = nest_of(3, 0, edges)
    assert nest is not None
    problem = PathProblem(3, 0, tuple(edges), (9, 1, 0, 0, 1), nest, {0: 5})
    whole = replace(problem, exclusive=(((0, 1), None),))
    assert "\n never_0: x_b0_b1 + x_b0_b2 <= 4\n" in format_program(whole)
    each = replace(problem, exclusive=(((0, 1), 0),))
    assert "\n never_0: x_b0_b1 + x_b0_b2 - x_b1_b0 - x_b2_b0 <= 1\n" in format_program(each)


# ------------------------------------------------------------------------------------------------ facts of conditions
def value_of(term: Term, values: dict[int, int]) -> int:
    total = term.constant
    for of, factor in term.parts:
        assert isinstance(of, Var) and isinstance(of.location, int)
        total += factor * values[of.location]
    return total % WORD


def holds(relation: Relation, values: dict[int, int]) -> bool:
    a, b = value_of(relation.a, values), value_of(relation.b, values)
    if relation.kind in (Kind.SLT, Kind.SGE):
        a, b = (a ^ 1 << 31) - (1 << 31), (b ^ 1 << 31) - (1 << 31)
    match relation.kind:
        case Kind.EQ:
            return a == b
        case Kind.NE:
            return a != b
        case Kind.ULT | Kind.SLT:
            return a < b
        case _:
            return a >= b


def fits(facts: Facts, values: dict[int, int]) -> bool:
    """Whether values are among those that the facts allow."""
    for key, allowed in facts.items():
        if isinstance(key, OrderKey):
            a, b = value_of(key.a, values), value_of(key.b, values)
            if key.signed:
                a, b = (a ^ 1 << 31) - (1 << 31), (b ^ 1 << 31) - (1 << 31)
            found = 0 if a < b else 1 if a == b else 2
        else:
            found = value_of(Term(0, key.parts), values)
        if not any(low <= found <= high for low, high in allowed):
            return False
    return True


numbers = st.sampled_from([0, 1, 2, 5, 255, (1 << 31) - 1, 1 << 31, WORD - 2, WORD - 1])
registers = st.integers(0, 2)
terms = st.builds(
    lambda r, s, factor, c: add(add(scale(variable(r), factor), number(c)), variable(s), c % 3 - 1),
    registers,
    registers,
    st.sampled_from([0, 1, 1, 1, -1, 4, 1 << 31]),
    numbers,
)
relations = st.builds(Relation, st.sampled_from(list(Kind)), terms, terms | st.builds(number, numbers))
assignments = st.fixed_dictionaries({0: numbers, 1: numbers, 2: numbers})


@settings(max_examples=120, deadline=None)
@given(st.lists(relations, min_size=1, max_size=3), st.lists(relations, min_size=1, max_size=2), assignments)
def test_facts_allow_whatever_keeps_the_relations(
    first: list[Relation], second: list[Relation], values: dict[int, int]
) -> None:
    one, other = facts_of(first), facts_of(second)
    keeps = [all(holds(r, values) for r in side) for side in (first, second)]
    if keeps[0]:
        assert fits(one, values) and not contradicts(one)
    if all(keeps):
        assert fits(all_of(one, other), values)
    if any(keeps):
        assert fits(one_of([one, other]), values)


def test_contradictions_are_found() -> None:
    x, y = variable(0), variable(1)
    for first, second in (
        (Relation(Kind.EQ, x, number(1)), Relation(Kind.EQ, x, number(2))),
        (Relation(Kind.SLT, number(5), x), Relation(Kind.SLT, x, number(3))),
        (Relation(Kind.EQ, add(x, number(1)), number(0)), Relation(Kind.ULT, x, number(9))),
        (Relation(Kind.SLT, x, y), Relation(Kind.SGE, x, y)),
        (Relation(Kind.ULT, y, x), Relation(Kind.EQ, x, y)),
        (Relation(Kind.EQ, scale(x, -1), y), Relation(Kind.NE, add(x, y), number(0))),
    ):
        assert contradicts(all_of(facts_of([first]), facts_of([second]))), f"{first}, {second}"


# ------------------------------------------------------------------------------------------------ compiled programs
def analysed(image: Path, function: str) -> ProgramFlow:
    binary = load(image)
    assert isinstance(binary, Binary)
    return analyse_program(binary, binary.function(function).key)


def without_groups(program: ProgramFlow) -> ProgramFlow:
    return replace(program, functions={k: replace(f, exclusive=()) for k, f in program.functions.items()})


def check(image: Path, cpu: str, tightened: tuple[str, ...] = TIGHTENED) -> None:
    """Every function over all modes: no pair taken together, no time above the bound; some bounds below those without
    the groups."""
    board, core, emulator = Board("bench", cpu, 1_000_000), load_core(cpu), Emulator(image, cpu)
    assert core is not None
    for function in (*TIGHTENED, "changed", "alternating"):
        program = analysed(image, function)
        bounds = bound_program(program, core, board)
        replay, worst = Replay(program, (bounds,)), 0
        for value in range(-1, 8):
            state = emulator.alloc((value % WORD).to_bytes(4, "little") + bytes(4))
            run = record(emulator, function, [state if function == "object" else value])
            cycles = replay.walk(run)
            assert cycles is not None and not replay.wrong, (function, replay.wrong)
            worst = max(worst, cycles[0])
        bound, free = bounds[program.entry].cycles, bound_program(without_groups(program), core, board)
        loose = free[program.entry].cycles
        assert bound is not None and loose is not None and worst <= bound <= loose, function
        assert bound < loose or function not in tightened, function


@pytest.mark.parametrize(("image", "cpu"), [("modes-O0-arm7tdmi", "arm7tdmi"), ("modes-O2-cortex-m3", "cortex-m3")])
def test_modes_exclude_each_other(image: str, cpu: str) -> None:
    check(IMAGES / f"{image}.elf", cpu)


@pytest.mark.slow
@pytest.mark.parametrize("cpu", CORES)
@pytest.mark.parametrize("level", ["-O0", "-O1", "-O2"])
def test_modes_exclude_each_other_at_every_level(level: str, cpu: str, tmp_path: Path) -> None:
    image = tmp_path / "modes.elf"
    flags = f"{level} -mcpu={cpu} {CORES[cpu]} {FLAGS}".split()
    subprocess.run(["arm-none-eabi-gcc", *flags, str(IMAGES / "modes.c"), "-lgcc", "-o", str(image)], check=True)
    check(image, cpu)


@pytest.mark.slow
def test_modes_exclude_each_other_from_the_other_compiler(tmp_path: Path) -> None:
    image, made = tmp_path / "modes.elf", tmp_path / "modes.o"
    clang = ["-target", "thumb-freestanding-eabi", "-mcpu=cortex_m3", "-O2", "-c"]
    clang += ["-fno-sanitize=undefined", "-fno-unwind-tables"]
    source = str(IMAGES / "modes.c")
    subprocess.run([sys.executable, "-m", "ziglang", "cc", *clang, source, "-o", str(made)], check=True)
    flags = f"-mcpu=cortex-m3 -mthumb {FLAGS}".split()
    subprocess.run(["arm-none-eabi-gcc", *flags, str(made), "-lgcc", "-o", str(image)], check=True)
    check(image, "cortex-m3", ("argument", "looped", "object", "saved"))


def test_the_branches_are_told() -> None:
    (found,) = analyse(IMAGES / "modes-O0-arm7tdmi.elf", ["argument"], Board("bench", "arm7tdmi", 1_000_000))
    (group,) = found.exclusive
    assert [branch.condition for branch in group.branches] == ["argument 1 >= 6", "argument 1 <= 2"]
    assert [branch.source.rpartition("/")[2] for branch in group.branches] == ["modes.c:57", "modes.c:60"]
    assert group.function == "argument" and group.loop is None


SEEDS = range(int(os.environ.get("MODES_FIRST", "1")), int(os.environ.get("MODES_LAST", "3")))


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
def test_random_modes_are_never_taken_together(seed: int, tmp_path: Path) -> None:
    """MODES_FIRST and MODES_LAST choose other seeds, for a long run."""
    cpu, level = list(CORES)[seed % 2], ("-O0", "-O1", "-O2", "-Os")[seed // 2 % 4]
    image, text, functions = tmp_path / "modes.elf", tmp_path / "modes.c", 3
    text.write_text(modes.source(seed, functions))
    flags = f"-w {level} -mcpu={cpu} {CORES[cpu]} {FLAGS}".split()
    subprocess.run(["arm-none-eabi-gcc", *flags, str(text), "-lgcc", "-o", str(image)], check=True)
    emulator, random = Emulator(image, cpu), Random(seed)
    for number_ in range(functions):
        program = analysed(image, f"f{number_}")
        replay = Replay(program, ())
        for _ in range(15):
            part = emulator.alloc(b"".join((random.randrange(-1, 6) % WORD).to_bytes(4, "little") for _ in range(3)))
            run = record(emulator, f"f{number_}", [*(random.randrange(-1, 6) for _ in range(3)), part])
            assert replay.walk(run) is not None and not replay.wrong, replay.wrong
