"""The CI script runs the commands that the README shows."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCRIPT = ROOT / ".ci" / "run"


def readme_command(text: str, readme: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """What the script's own function finds in a README."""
    (folder / "README.md").write_text(readme)
    function = re.search(r"^readme_command\(\) \{.*?^\}", SCRIPT.read_text(), re.S | re.M)
    assert function is not None
    program = f'root="{folder}"\n{function[0]}\nreadme_command "{text}"'
    return subprocess.run(["bash", "-c", program], capture_output=True, text=True)


def test_the_script_is_executable_and_stops_at_the_first_failure() -> None:
    assert os.access(SCRIPT, os.X_OK)
    assert "set -euo pipefail" in SCRIPT.read_text()
    assert subprocess.run(["bash", "-n", str(SCRIPT)]).returncode == 0


def test_both_commands_of_the_readme_are_found(tmp_path: Path) -> None:
    readme = (ROOT / "README.md").read_text()
    for text in ("mauvec check", "bin/pytest"):
        found = readme_command(text, readme, tmp_path)
        assert found.returncode == 0, found.stderr
        assert found.stdout.startswith("python3 -m venv .venv && ") and text in found.stdout


def test_a_command_outside_a_block_or_given_twice_is_refused(tmp_path: Path) -> None:
    line = "python3 -m venv .venv && .venv/bin/pytest -q\n"
    assert readme_command("bin/pytest", line, tmp_path).returncode == 1
    assert readme_command("bin/pytest", f"```\n{line}{line}```\n", tmp_path).returncode == 1
    assert readme_command("bin/pytest", f"```sh\n{line}```\n", tmp_path).stdout == line.strip()
