"""The collector itself: what a page may contain, and that a wrong message is seen."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from markdown_cases import cases, difference, rewritten, run

PAGE = """# Names

Prose, and `code`.

```mauve title="board.mauve" shared=yes
package board
```

```mauve
mauve 1
import lib
```

```mauve title="lib/lib.mauve"
package lib
```

```files
copied.txt = LICENSE
```

```options
--method paper
```

```text
error[MV100 unknown-name]: no
```

## Fine

```mauve title="a.mauve"
mauve 1
```

```text
```
"""


def test_a_case_is_its_files_copies_options_and_messages() -> None:
    first, second = cases(PAGE)
    assert first.name == "Names"
    assert first.files == {
        "robot.mauve": "mauve 1\nimport lib\n",
        "lib/lib.mauve": "package lib\n",
        "board.mauve": "package board\n",
    }
    assert first.copies == {"copied.txt": "LICENSE"}
    assert first.options == ["--method", "paper"]
    assert first.expected == "error[MV100 unknown-name]: no"
    assert (second.name, second.files, second.expected) == (
        "Fine",
        {"a.mauve": "mauve 1\n", "board.mauve": "package board\n"},
        "",
    )


def test_the_command_runs_beside_the_files_and_its_messages_are_compared_exactly(tmp_path: Path) -> None:
    seen: list[list[str]] = []

    def main(arguments: list[str]) -> int:
        seen.append(arguments)
        assert Path("lib/lib.mauve").read_text() == "package lib\n"
        assert Path("copied.txt").exists()
        print("a table")
        print("error[MV100 unknown-name]: no", file=sys.stderr)
        return 1

    case = cases(PAGE)[0]
    code, printed = run(case, main, tmp_path, Path(__file__).resolve().parents[2])
    assert seen == [["check", "robot.mauve", "--format", "full", "--method", "paper"]]
    assert difference(case, code, printed) == ""
    assert difference(case, code, printed.replace(": no", ": yes")).endswith(
        "-error[MV100 unknown-name]: no\n+error[MV100 unknown-name]: yes"
    )
    assert "exit code is 0, not 1" in difference(case, 0, printed)


def test_rewriting_replaces_the_messages_and_nothing_else() -> None:
    first, second = cases(PAGE)
    changed = rewritten(rewritten(PAGE, first.block, "one\ntwo\n"), second.block, "three\n")
    assert [c.expected for c in cases(changed)] == ["one\ntwo", "three"]
    assert rewritten(rewritten(changed, first.block, first.expected), second.block, "") == PAGE


@pytest.mark.parametrize(
    ("page", "complaint"),
    [
        ("```text\nx\n```\n", "no source before"),
        ("```mauve\nx\n```\n", "no messages after"),
        ("```mauve\nx\n", "not closed"),
        ("```mauve\n```\n```mauve\n```\n```text\n```\n", "given twice"),
    ],
)
def test_a_page_that_does_not_add_up_is_refused(page: str, complaint: str) -> None:
    with pytest.raises(ValueError, match=complaint):
        cases(page)
