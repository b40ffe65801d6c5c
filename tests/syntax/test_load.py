from __future__ import annotations

import time
from pathlib import Path

import pytest

from mauve.diagnostics.diagnostic import Diagnostic, Report
from mauve.syntax import ast
from mauve.syntax.load import load_modules, read_source, standard_module, standard_names


def write(folder: Path, files: dict[str, str]) -> None:
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


def load(path: Path) -> tuple[list[str], list[Diagnostic]]:
    report = Report()
    modules = load_modules(path, report)
    return [str(module.package) for module in modules], report.sorted()


def test_imports_are_followed_once_each_and_the_checked_file_comes_first(tmp_path: Path) -> None:
    write(
        tmp_path,
        {
            "robot.mauve": "mauve 1\npackage robot\nimport nav.fusion\nimport nav.gps\nimport std.lifecycle\n",
            "nav/fusion.mauve": "mauve 1\npackage nav.fusion\nimport nav.types\nimport std.lifecycle\n",
            "nav/gps.mauve": "mauve 1\npackage nav.gps\nimport nav.types as t\n",
            "nav/types.mauve": "mauve 1\npackage nav.types\n",
        },
    )
    packages, found = load(tmp_path / "robot.mauve")
    assert found == []
    assert packages == ["robot", "nav.fusion", "nav.types", "std.lifecycle", "nav.gps"]


def test_imports_start_above_the_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write(
        tmp_path,
        {
            "nav/fusion.mauve": "mauve 1\npackage nav.fusion\nimport nav.types\n",
            "nav/types.mauve": "mauve 1\npackage nav.types\n",
            "lib/part.mauve": "mauve 1\npackage lib\nimport nav.types\n",
        },
    )
    assert load(tmp_path / "nav" / "fusion.mauve") == (["nav.fusion", "nav.types"], [])
    assert load(tmp_path / "lib" / "part.mauve") == (["lib", "nav.types"], [])
    monkeypatch.chdir(tmp_path / "nav")
    assert load(Path("fusion.mauve")) == (["nav.fusion", "nav.types"], [])


def test_a_missing_import_names_a_near_one(tmp_path: Path) -> None:
    write(tmp_path, {"a.mauve": "mauve 1\nimport nav.fusoin\nimport std.lifecicle\n", "nav/fusion.mauve": "mauve 1\n"})
    _, (first, second) = load(tmp_path / "a.mauve")
    assert (first.code, first.message) == ("MV104", "there is no module `nav.fusoin`")
    assert first.help is not None and first.help.text == "there is a module `nav.fusion`"
    assert second.help is not None and second.help.text == "there is a module `std.lifecycle`"
    assert second.primary is not None and second.primary.text == "not in the standard library"


def test_an_imported_file_names_the_package_it_is_imported_by(tmp_path: Path) -> None:
    write(tmp_path, {"a.mauve": "mauve 1\nimport nav.gps\n", "nav/gps.mauve": "mauve 1\npackage gps\n"})
    _, (found,) = load(tmp_path / "a.mauve")
    assert found.code == "MV104" and "is the package `gps`, it is imported as `nav.gps`" in found.message
    assert found.help is not None and found.help.text.startswith("write `package nav.gps` in")


def test_a_cycle_is_told_as_a_walk(tmp_path: Path) -> None:
    write(
        tmp_path,
        {
            "a.mauve": "mauve 1\npackage a\nimport b\n",
            "b.mauve": "mauve 1\npackage b\nimport c\n",
            "c.mauve": "mauve 1\npackage c\nimport a\nimport b\n",
        },
    )
    packages, found = load(tmp_path / "a.mauve")
    assert packages == ["a", "b", "c"]
    assert [d.message for d in found] == [
        "these modules import each other: `a` -> `b` -> `c` -> `a`",
        "these modules import each other: `b` -> `c` -> `b`",
    ]
    walk = [found[0].primary, *found[0].labels]
    assert [label.text for label in walk if label] == [
        "`a` imports `b` here",
        "`b` imports `c` here",
        "`c` imports `a` here",
    ]
    assert [label.span.file.name.rsplit("/", 1)[-1] for label in walk if label] == ["a.mauve", "b.mauve", "c.mauve"]


def test_a_file_that_imports_itself(tmp_path: Path) -> None:
    write(tmp_path, {"a.mauve": "mauve 1\npackage robot\nimport a\n"})
    assert [d.message for d in load(tmp_path / "a.mauve")[1]] == ["`robot` imports itself"]


def test_a_long_chain_of_imports_is_followed(tmp_path: Path) -> None:
    write(tmp_path, {f"m{i}.mauve": f"mauve 1\nimport m{i + 1}\n" for i in range(1200)} | {"m1200.mauve": "mauve 1\n"})
    packages, found = load(tmp_path / "m0.mauve")
    assert (len(packages), found) == (1201, [])


@pytest.mark.parametrize(
    ("data", "line", "column"),
    [(b"mauve 1\n\xff", 2, 1), (b"mauve 1\n// caf\xe9\n", 2, 7), ("mauve 1\n".encode("utf-16"), 1, 1), (b"\xc3", 1, 1)],
)
def test_a_file_that_is_not_utf8_is_shown_at_its_first_wrong_byte(
    tmp_path: Path, data: bytes, line: int, column: int
) -> None:
    path = tmp_path / "a.mauve"
    path.write_bytes(data)
    report = Report()
    assert load_modules(path, report) == ()
    (found,) = report.diagnostics
    assert found.code == "MV002" and found.primary is not None
    assert (found.primary.span.first.line, found.primary.span.first.column) == (line, column)


def test_files_that_cannot_be_read(tmp_path: Path) -> None:
    for path, reason in ((tmp_path / "none.mauve", "there is no such file"), (tmp_path, "it is a directory")):
        report = Report()
        assert read_source(path, report) is None
        assert [(d.code, d.message) for d in report] == [("MV002", f"cannot read `{path}`: {reason}")]
    report = Report()
    assert read_source(Path("a\0b"), report) is None
    assert [d.code for d in report] == ["MV002"]


def test_ten_megabytes_of_braces_are_refused_at_once(tmp_path: Path) -> None:
    path = tmp_path / "a.mauve"
    path.write_bytes(b"{" * 10_000_000)
    report = Report()
    begin = time.process_time()
    assert load_modules(path, report) == ()
    assert [d.code for d in report] == ["MV008"]
    path.write_bytes(b"mauve 1\n" + b"{" * 4_000_000)
    report = Report()
    load_modules(path, report)
    assert [d.code for d in report] == ["MV008"]
    assert time.process_time() - begin < 1


def test_a_byte_order_mark_is_no_text(tmp_path: Path) -> None:
    path = tmp_path / "a.mauve"
    path.write_bytes(b"\xef\xbb\xbfmauve 1\r\npackage a\r\n")
    assert load(path) == (["a"], [])


def test_the_standard_library_is_sound() -> None:
    report = Report()
    modules = [standard_module(name, report) for name in standard_names()]
    assert standard_names() == ("boards", "lifecycle") and report.diagnostics == []
    assert standard_module("nothing", report) is None
    boards, lifecycle = modules
    assert boards is not None and lifecycle is not None
    assert [str(d.name) for d in boards.declarations] == [
        "generic-arm7tdmi",
        "generic-arm926ej-s",
        "generic-arm920t",
        "generic-cortex-m0",
        "generic-cortex-m0plus",
        "generic-cortex-m3",
        "generic-cortex-m4",
        "generic-cortex-m4f",
    ]
    (orocos,) = lifecycle.declarations
    assert isinstance(orocos, ast.LifecycleDecl)
    assert [str(hook) for hook in orocos.hooks] == ["configure", "start", "update", "stop", "cleanup"]
    edges = {(str(s.name), str(t.target), str(t.do[0].target)) for s in orocos.regions[0].states for t in s.transitions}
    assert edges == {
        ("PreOp", "Stopped", "configure"),
        ("Stopped", "Running", "start"),
        ("Stopped", "PreOp", "cleanup"),
        ("Running", "Stopped", "stop"),
    }
