"""Programs of the corpus, built and measured by its own scripts: every executed loop bounded, no execution above."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

CORPUS = Path(__file__).resolve().parents[2] / "benchmarks" / "corpus"
PROGRAMS = "bubble_sort,crc8,hex_record"
CORES = "arm7tdmi,cortex-m4f"


def script(name: str, *words: str) -> str:
    """What a script of the corpus prints; its end without a fault is asserted."""
    run = subprocess.run([sys.executable, str(CORPUS / name), *words], capture_output=True, text=True, timeout=300)
    assert run.returncode == 0, run.stderr
    return run.stdout


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("arm-none-eabi-gcc") is None, reason="NO CROSS COMPILER: arm-none-eabi-gcc")
def test_loops_of_some_programs_are_bounded_at_what_executions_reach(tmp_path: Path) -> None:
    choice = ("--programs", PROGRAMS, "--compilers", "gcc-Os", "--cores", CORES)
    assert "6 of 6 images" in script("build.py", *choice, "--out", str(tmp_path))
    found = tmp_path / "rows.json"
    printed = script("measure.py", "--images", str(tmp_path), *choice, "--inputs", "6", "--out", str(found))
    rows = json.loads(found.read_text())
    assert len(rows) == 6 and "| all | 6 | 100.0 |" in printed
    for row in rows:
        assert not row["traceback"] and not row["wrong"] and not row["outside"], row
        assert row["runs"] == 6 and row["cycles"] >= max(row["walked"], row["timed"]) > 0
        assert row["loops"] and all(loop["bound"] >= loop["seen"] > 0 for loop in row["loops"])


def test_manifests_name_entries_and_ranges() -> None:
    program = "import manifest; print(*(m for m in map(manifest.read_manifest, manifest.sources())), sep='\\n')"
    run = subprocess.run([sys.executable, "-c", program], cwd=CORPUS, capture_output=True, text=True, check=True)
    lines = run.stdout.splitlines()
    assert len(lines) >= 60 and all("entry='run'" in line for line in lines)
    assert any("Input(name='count', low=0, high=64, width=0)" in line for line in lines)
