"""The wheel carries everything that a run outside the checkout needs."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DATA = {".lark", ".mauve", ".toml", ".md", ".typed"}


def run(*command: str | Path, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([str(part) for part in command], cwd=cwd, capture_output=True, text=True, timeout=600)


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    built = run(sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", folder, ROOT, cwd=folder)
    assert built.returncode == 0, built.stderr
    (found,) = folder.glob("mauvec-*.whl")
    return found


@pytest.mark.slow
def test_the_wheel_holds_the_package_with_its_data_and_nothing_else(wheel: Path) -> None:
    held = {name for name in zipfile.ZipFile(wheel).namelist() if ".dist-info/" not in name}
    package = {
        path.relative_to(ROOT).as_posix()
        for path in (ROOT / "mauve").rglob("*")
        if path.is_file() and path.suffix in DATA | {".py"}
    }
    assert held == package
    assert {"mauve/py.typed", "mauve/syntax/mauve.lark", "mauve/diagnostics/pages/MV001.md"} <= held
    assert any(name.startswith("mauve/std/") and name.endswith(".mauve") for name in held)
    assert any(name.startswith("mauve/wcet/") and name.endswith(".toml") for name in held)


@pytest.mark.slow
def test_an_installed_mauvec_works_outside_the_checkout(wheel: Path, tmp_path: Path) -> None:
    environment, robot = tmp_path / "venv", tmp_path / "robot"
    robot.mkdir()
    for name in ("ttrk.mauve", "ttrk.elf"):
        (robot / name).write_bytes((ROOT / "examples" / "ttrk" / name).read_bytes())
    assert run(sys.executable, "-m", "venv", environment, cwd=tmp_path).returncode == 0
    installed = run(environment / "bin" / "pip", "install", "-q", wheel, cwd=tmp_path)
    assert installed.returncode == 0, installed.stderr

    mauvec = environment / "bin" / "mauvec"
    version = run(mauvec, "--version", cwd=robot)
    assert (version.returncode, version.stdout.split()[0]) == (0, "mauvec")
    explained = run(mauvec, "explain", "MV201", cwd=robot)
    assert "MV201 type-mismatch" in explained.stdout
    checked = run(mauvec, "check", "ttrk.mauve", cwd=robot)
    assert (checked.returncode, "Traceback" in checked.stderr) == (0, False), checked.stderr
    assert "fusion" in checked.stdout
