"""Tables: alignment, cutting, and text that a terminal may be shown."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from mauve.diagnostics.style import ANSI, PLAIN, Role
from mauve.report.table import Align, Cell, Column, format_table

COLUMNS = (Column("name", elastic=True), Column("cycles", Align.RIGHT), Column("origin"))


def test_columns_are_as_wide_as_their_widest_cell() -> None:
    lines = format_table(COLUMNS, [("a", "1 000", "derived"), ("longer", "7", "")], PLAIN)
    assert lines == [
        "  name    cycles  origin",
        "  a        1 000  derived",
        "  longer       7",
    ]


def test_a_column_without_text_is_left_out() -> None:
    assert format_table(COLUMNS, [("a", "", "derived")], PLAIN) == ["  name  origin", "  a     derived"]
    assert format_table(COLUMNS, [], PLAIN) == ["  name  cycles  origin"]


def test_names_are_cut_in_the_middle_and_numbers_never() -> None:
    rows = [("sensor_fusion_component_left_camera", "1 000 000", "derived")]
    wide = format_table(COLUMNS, rows, PLAIN, limit=100)
    narrow = format_table(COLUMNS, rows, PLAIN, limit=40)
    assert wide == format_table(COLUMNS, rows, PLAIN)
    assert [len(line) for line in narrow] == [39, 40]
    assert narrow[1] == "  sensor_fu…ft_camera  1 000 000  derived"[:40] or "…" in narrow[1]
    assert narrow[1].endswith("1 000 000  derived") and narrow[1].startswith("  sensor")


def test_colours_do_not_move_anything() -> None:
    rows = [("a", "1", Cell("missed", Role.ERROR)), ("b", "22", Cell("", Role.ERROR))]
    coloured = format_table(COLUMNS, rows, ANSI)
    assert coloured[1] == "  a          1  \x1b[1;31mmissed\x1b[0m"
    assert coloured[2] == "  b         22"


def test_names_of_a_binary_cannot_reach_the_terminal() -> None:
    (line,) = format_table(COLUMNS[:1], [("evil\x1b[2J\nname",)], PLAIN)[1:]
    assert "\x1b" not in line and "\n" not in line


def test_wide_characters_take_two_cells() -> None:
    lines = format_table(COLUMNS, [("传感器", "1", "x"), ("abcdef", "1", "x")], PLAIN)
    assert lines[1:] == ["  传感器       1  x", "  abcdef       1  x"]


@given(
    st.lists(st.tuples(st.text(max_size=60), st.integers(0, 10**9).map(str), st.text(max_size=10)), max_size=5),
    st.integers(10, 120),
)
def test_every_line_keeps_to_the_limit_where_names_can_be_cut(rows: list[tuple[str, str, str]], limit: int) -> None:
    """Numbers and short columns set the least width; above it no line is longer than asked."""
    ascii_rows = [tuple(cell.encode("ascii", "replace").decode() for cell in row) for row in rows]
    least = 2 + 12 + 2 + 10 + 2 + 10
    for line in format_table(COLUMNS, ascii_rows, PLAIN, limit=limit):
        assert len(line) <= max(limit, least)
        assert line == line.rstrip()
