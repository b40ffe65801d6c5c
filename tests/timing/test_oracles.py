"""Other tools on random sets: the long form, which needs an interpreter that has them.

Set MAUVEC_ORACLE to a Python with the packages response-time-analysis and simso, e.g.
`python -m venv oracle && oracle/bin/pip install response-time-analysis simso`, and MAUVEC_ORACLE_SETS for other than
1000 sets of each kind.
"""

from __future__ import annotations

import os
import subprocess
from pathlib import Path

import pytest

SCRIPT = Path(__file__).resolve().parents[2] / "benchmarks" / "oracles.py"
ORACLE = os.environ.get("MAUVEC_ORACLE", "")


@pytest.mark.slow
@pytest.mark.skipif(not ORACLE, reason="NOT COMPARED with other tools: MAUVEC_ORACLE is not set")
def test_pyrta_and_simso_agree_on_random_sets() -> None:
    sets = os.environ.get("MAUVEC_ORACLE_SETS", "1000")
    done = subprocess.run([ORACLE, str(SCRIPT), "--sets", sets], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.count(f"{sets} sets agree") == 8
