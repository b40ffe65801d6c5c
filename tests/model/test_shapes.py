"""The shape of regions: unreachable states and traps, checked against their definitions."""

from __future__ import annotations

import time

from hypothesis import given
from hypothesis import strategies as st
from written import codes, resolved

from mauve.model.reachability import components, reachable, reversed_graph

GRAPHS = st.dictionaries(st.sampled_from("abcdef"), st.lists(st.sampled_from("abcdef"), max_size=4), min_size=6)


@given(GRAPHS)
def test_components_partition_a_graph_into_mutual_reachability(graph: dict[str, list[str]]) -> None:
    names = sorted(graph)
    found = components(names, graph, reversed_graph(graph))
    assert sorted(name for component in found for name in component) == names
    home = {name: number for number, component in enumerate(found) for name in component}
    for a in names:
        for b in names:
            mutual = b in reachable((a,), graph) and a in reachable((b,), graph)
            assert mutual == (home[a] == home[b])


def _behaviour(states: dict[str, list[str]], final: str = "") -> str:
    lines = ["component C {", "codel go returns bool", "behaviour {"]
    for number, (name, targets) in enumerate(states.items()):
        lines.append(f"{'initial ' if number == 0 else ''}{'final ' if name == final else ''}state {name} {{")
        lines += [f"-> {target} when go" for target in targets]
        lines.append("}")
    return "\n".join([*lines, "}", "}"])


def test_one_message_for_states_that_would_become_reachable_together() -> None:
    _, report = resolved(_behaviour({"a": [], "b": ["c"], "c": ["d"], "d": ["b"], "e": []}))
    assert codes(report) == ["MV301", "MV301"]
    assert "`e`" in next(d.message for d in report)


def test_one_message_for_a_trap_at_its_entrance() -> None:
    _, report = resolved(_behaviour({"a": ["b"], "b": ["c"], "c": ["d"], "d": ["c"]}))
    (diagnostic,) = report
    assert diagnostic.code == "MV305" and diagnostic.primary is not None
    assert diagnostic.primary.span.text == "c"


def test_two_traps_are_two_messages_and_a_final_state_is_none() -> None:
    _, report = resolved(_behaviour({"a": ["b", "c"], "b": [], "c": []}))
    assert codes(report) == ["MV305", "MV305"]
    _, report = resolved(_behaviour({"a": ["b", "c"], "b": [], "c": []}, final="b"))
    assert codes(report) == ["MV305"]


def test_an_initial_state_that_is_never_entered_again_is_no_trap_of_the_rest() -> None:
    _, report = resolved(_behaviour({"boot": ["run"], "run": ["stop"], "stop": ["run"]}))
    assert codes(report) == ["MV305"]
    _, report = resolved(_behaviour({"boot": ["run"], "run": ["boot"]}))
    assert codes(report) == []


def test_a_region_of_two_thousand_states_takes_linear_time() -> None:
    ring = {f"s{n}": [f"s{(n + 1) % 2000}"] for n in range(2000)}
    chain = {f"s{n}": [f"s{n + 1}"] if n < 1999 else [] for n in range(2000)}
    for states in (ring, chain):
        text = _behaviour(states)
        start = time.process_time()
        _, report = resolved(text)
        assert time.process_time() - start < 5
        assert len(codes(report)) <= 1
