"""Source text, spans and arbitrary diagnostics for the tests of the renderers."""

from __future__ import annotations

from hypothesis import strategies as st

from mauve.diagnostics.diagnostic import Diagnostic, Fix, Label, Severity
from mauve.source import SourceFile, Span

ROBOT = SourceFile(
    "ttrk.mauve",
    """\
component IG500 {
  out port position: Position
}
component StateFusion {
  in port attitude: Attitude
  behaviour {
    initial state Fusing {
      run fuse
    }
  }
}
architecture TTRK {
  connect ig500.position -> fusion.attitude
}
""",
)


def at(text: str, file: SourceFile = ROBOT, until: str | None = None) -> Span:
    """The first occurrence of a text, or the stretch from it to the end of another."""
    start = file.text.index(text)
    end = start + len(text) if until is None else file.text.index(until, start) + len(until)
    return Span(file, start, end)


texts = st.text(st.one_of(st.sampled_from("ab {\t\n\r\u0301漢\x1b\u2028\u200d"), st.characters()), max_size=120)
offsets = st.integers(-5, 140)


@st.composite
def diagnostics(draw: st.DrawFn) -> Diagnostic:
    """Any diagnostic at all, its spans in two files and sometimes outside their text."""
    files = [SourceFile(draw(texts), draw(texts)) for _ in range(2)]
    label = st.builds(
        Label, st.builds(Span, st.sampled_from(files), start=offsets, end=offsets), text=st.one_of(st.just(""), texts)
    )
    return Diagnostic(
        draw(st.sampled_from(["MV201", "MV000", "nonsense"])),
        draw(texts),
        draw(st.one_of(st.none(), label)),
        draw(st.sampled_from(Severity)),
        tuple(draw(st.lists(label, max_size=5))),
        draw(st.one_of(st.just(""), texts)),
        tuple(draw(st.lists(texts, max_size=2))),
        draw(st.one_of(st.none(), st.builds(Fix, texts))),
    )
