"""Scopes: what a module sees of itself and of what it imports."""

from __future__ import annotations

from written import codes, model_of, resolved

LIBRARY = "package lib\nstruct Position { x: f64 }\nexternal component Gps {\n  out port position: Position\n}"


def test_a_name_of_an_import_is_seen_alone_and_qualified() -> None:
    model = model_of(
        "import lib\nexternal component A {\n  out port p: Position\n  out port q: lib.Position\n}", LIBRARY
    )
    own = next(component for component in model.components if component.name == "A")
    assert own.ports[0].type == own.ports[1].type


def test_an_alias_takes_the_place_of_the_package() -> None:
    model_of("import lib as nav\nexternal component A {\n  out port p: nav.Position\n}", LIBRARY)
    _, report = resolved("import lib as nav\nexternal component A {\n  out port p: lib.Position\n}", LIBRARY)
    assert codes(report) == ["MV102"]


def test_an_own_declaration_hides_an_imported_one() -> None:
    text = "import lib\nstruct Position { y: u8 }\nexternal component A {\n  out port p: Position\n}"
    model = model_of(text, LIBRARY)
    own = next(component for component in model.components if component.name == "A")
    assert own.ports[0].type != next(c for c in model.components if c.name == "Gps").ports[0].type


def test_what_is_not_imported_is_not_seen() -> None:
    _, report = resolved("external component A {\n  out port p: Position\n}", LIBRARY)
    (diagnostic,) = report
    assert diagnostic.primary is not None
    assert (diagnostic.code, diagnostic.primary.text) == ("MV102", "not found in this file, which imports nothing")


def test_two_components_of_one_name_do_not_meet_in_an_architecture() -> None:
    text = "import lib\nexternal component Gps {\n}\narchitecture R {\n  instance a: Gps\n  instance b: lib.Gps\n}"
    _, report = resolved(text, LIBRARY)
    assert "MV103" in codes(report)


def test_a_mistake_in_an_instance_does_not_cascade() -> None:
    text = """
component Worker {
  out port value: f64
  codel work writes value
  behaviour {
    initial state On {
      run work
    }
  }
}
external component Sink {
  in port value: f64
}
board desk {
  cpu "arm7tdmi" at 60MHz
}
architecture R {
  instance a: Workers { period 10ms }
  instance b: Sink
  connect a.value -> b.value
}
deployment d of R {
  node n on desk {
    assume Worker.work wcet 1ms
    process p {
      thread t { a }
    }
  }
}
"""
    _, report = resolved(text)
    assert codes(report) == ["MV101"]
