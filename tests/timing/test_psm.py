"""A PSM says what can be reached, what is never left, and what it costs in the long run."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from mauve.timing.psm import (
    CostPart,
    Psm,
    PsmTransition,
    format_psm,
    make_psm,
    map_costs,
    max_cycle_mean,
    reachable_edges,
    shape,
    verify,
)


def psm_of(*arrows: tuple[str, int, str], initial: str | None = None) -> Psm:
    return make_psm("m", initial or arrows[0][0], [PsmTransition(a, b, cost) for a, cost, b in arrows])


@st.composite
def psms(draw: st.DrawFn, max_states: int = 5, max_cost: int = 9) -> Psm:
    """Any small PSM: traps, dead ends, unreachable states and parallel transitions included."""
    names = "abcdefgh"[: draw(st.integers(1, max_states))]
    arrow = st.tuples(st.sampled_from(names), st.integers(0, max_cost), st.sampled_from(names))
    arrows = draw(st.lists(arrow, max_size=3 * len(names)))
    return make_psm("m", names[0], [PsmTransition(a, b, cost) for a, cost, b in arrows], states=names)


def brute_force_cycle_mean(psm: Psm) -> Fraction:
    """The greatest mean over all simple cycles, by enumeration."""
    states, edges = reachable_edges(psm)
    best = Fraction(0)

    def walk(path: list[int], total: int) -> None:
        nonlocal best
        for cost, target in edges[path[-1]]:
            if target == path[0]:
                best = max(best, Fraction(total + cost, len(path)))
            elif target not in path and target > path[0]:
                walk([*path, target], total + cost)

    for start in range(len(states)):
        walk([start], 0)
    return best


def test_the_dearest_of_parallel_transitions_stands_and_the_others_are_kept() -> None:
    cheap = PsmTransition("a", "b", 3, "when low", (CostPart("guard", 3),))
    dear = PsmTransition("a", "b", 5, "when high", (CostPart("guard", 1), CostPart("move", 4)))
    psm = make_psm("m", "a", [cheap, dear])
    (merged,) = psm.transitions
    assert (merged.cost, merged.label, merged.alternatives) == (5, "when high", (cheap,))
    assert verify(psm) == []

    def without_move(t: PsmTransition) -> PsmTransition:
        parts = tuple(part for part in t.parts if part.label != "move")
        return PsmTransition(t.source, t.target, sum(part.cost for part in parts), t.label, parts)

    assert [t.cost for t in map_costs(psm, without_move).transitions] == [3]


def test_a_psm_prints_to_a_short_text() -> None:
    psm = make_psm(
        "command",
        "(start)",
        [
            PsmTransition("(start)", "Rotating", 10, "start", (CostPart("halt", 10),)),
            PsmTransition("Rotating", "Rotating", 590, "", (CostPart("aligned", 10), CostPart("rotate", 580))),
            PsmTransition("Rotating", "Done", 700, "when aligned"),
        ],
    )
    assert format_psm(psm) == (
        "psm command\n"
        "  initial (start)\n"
        "  (start)  -> Rotating   10  start  = halt 10\n"
        "  Rotating -> Rotating  590  = aligned 10 + rotate 580\n"
        "  Rotating -> Done      700  when aligned\n"
        "  Done has no transition"
    )
    assert str(psm) == format_psm(psm)


def test_verify_names_each_fault() -> None:
    broken = Psm(
        "m",
        "z",
        ("a", "a"),
        (
            PsmTransition("a", "a", 1, parts=(CostPart("x", 2),)),
            PsmTransition("a", "a", -1),
            PsmTransition("a", "b", 1),
        ),
    )
    assert verify(broken) == [
        "a state is listed twice",
        "the initial state z is not a state",
        "the parts of a -1-> a do not sum to its cost",
        "two transitions from a to a",
        "a --1-> a has a negative cost",
        "a -1-> b does not join two states",
    ]


def test_a_state_that_is_never_left_is_a_trap_only_if_a_cycle_leads_there() -> None:
    found = shape(psm_of(("(start)", 1, "go"), ("go", 2, "go"), ("go", 1, "abort"), ("abort", 1, "abort")))
    assert found.traps == (("abort",),)
    assert found.components == (("(start)",), ("go",), ("abort",))
    assert found.cyclic == (("go",), ("abort",))
    assert not found.strongly_connected
    assert shape(psm_of(("boot", 1, "run"), ("run", 9, "run"))).traps == ()


def test_a_state_without_a_transition_is_a_dead_end_and_an_unreachable_one_is_named() -> None:
    found = shape(psm_of(("a", 2, "a"), ("a", 1, "b"), ("c", 4, "a")))
    assert found.dead_ends == ("b",)
    assert found.unreachable == ("c",)
    assert found.reachable == ("a", "b")


def test_a_cycle_through_two_states_is_one_component() -> None:
    found = shape(psm_of(("a", 1, "b"), ("b", 1, "c"), ("c", 1, "b"), ("c", 1, "a")))
    assert found.components == (("a", "b", "c"),)
    assert found.strongly_connected


def test_the_cycle_mean_ignores_what_cannot_be_reached() -> None:
    assert max_cycle_mean(psm_of(("a", 1, "b"), ("b", 4, "a"), ("x", 99, "x"), initial="a")) == Fraction(5, 2)
    assert max_cycle_mean(psm_of(("a", 7, "b"))) == 0


@settings(max_examples=150, deadline=None)
@given(psms())
def test_the_cycle_mean_is_the_greatest_over_all_simple_cycles(psm: Psm) -> None:
    assert max_cycle_mean(psm) == brute_force_cycle_mean(psm)


@settings(max_examples=100, deadline=None)
@given(psms())
def test_components_partition_the_reachable_states_in_topological_order(psm: Psm) -> None:
    found = shape(psm)
    assert verify(psm) == []
    assert sorted(state for component in found.components for state in component) == sorted(found.reachable)
    place = {state: number for number, component in enumerate(found.components) for state in component}
    for t in psm.transitions:
        if t.source in place:
            assert place[t.source] <= place[t.target]
    assert set(found.traps) <= set(found.cyclic)


def test_a_long_chain_needs_no_recursion() -> None:
    names = [f"s{number}" for number in range(3000)]
    psm = make_psm("m", "s0", [PsmTransition(a, b, 1) for a, b in pairwise(names)])
    assert len(shape(psm).components) == 3000


def test_costs_print_with_a_unit() -> None:
    assert "a -> b  7ms" in format_psm(psm_of(("a", 7, "b")), lambda cost: f"{cost}ms")
