"""What the tests of the command line share: a small model, and a way to run a command inside this process."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

from mauve.cli import main

ROOT = Path(__file__).resolve().parents[2]
FIXTURES = ROOT / "tests" / "wcet" / "fixtures"
ELF = FIXTURES / "arm7tdmi-arm-O0.elf"

MODEL = """\
mauve 1
package small

component Driver {
  codel open wcet 40us
  codel read wcet 250us
  behaviour {
    initial state Closed {
      run open
      -> Open
    }
    state Open {
      run read
      -> Closed
    }
  }
}

component Control {
  codel step wcet 1ms
  behaviour {
    initial state On {
      run step
    }
  }
}

architecture Robot {
  instance driver: Driver { period 5ms }
  instance control: Control { period 20ms  priority 1  deadline 10ms }
}

board desk {
  cpu "arm926ej-s" at 200MHz
  icache off
  dcache off
  mmu off
  memory ram at 0x0 size 1MiB wait 0cycles
  os bare {
    context_switch 10us
    tick every 10ms cost 5us
  }
}

deployment bench of Robot {
  node base on desk {
  }
}
"""

MISSED = MODEL.replace("codel step wcet 1ms", "codel step wcet 12ms")
UNTIMED = MODEL.replace("codel open wcet 40us", "codel open")
WITH_BINARY = MODEL.replace("codel step wcet 1ms", "codel step").replace(
    "  node base on desk {\n",
    f'  node base on desk {{\n    binary "{ELF}" {{\n      Control.step = "sum"\n    }}\n',
)


@dataclass(frozen=True)
class Run:
    code: int
    out: str
    err: str


Command = Callable[..., Run]


@pytest.fixture(scope="session")
def caches(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One directory of caches for all of these tests: the parse table is built once."""
    return tmp_path_factory.mktemp("caches")


@pytest.fixture
def environment(caches: Path) -> dict[str, str]:
    """What a process of its own gets: this checkout, the caches of these tests, and bytecode kept between processes."""
    kept = {name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "MAUVEC"))}
    own = {"PYTHONPATH": str(ROOT), "PYTHONPYCACHEPREFIX": str(caches / "bytecode"), "XDG_CACHE_HOME": str(caches)}
    return {**kept, **own}


@pytest.fixture(autouse=True)
def _own_caches(caches: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("MAUVEC_CACHE", raising=False)
    monkeypatch.delenv("MAUVEC_TRACEBACK", raising=False)
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(caches))


@pytest.fixture
def mauvec(capsys: pytest.CaptureFixture[str]) -> Iterator[Command]:
    """Run a command; its exit code and what it wrote."""

    def run(*arguments: str | Path) -> Run:
        capsys.readouterr()
        code = main([str(argument) for argument in arguments])
        captured = capsys.readouterr()
        return Run(code, captured.out, captured.err)

    yield run


@pytest.fixture
def model(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[str], str]:
    """Write a model into the current directory; its name."""
    monkeypatch.chdir(tmp_path)

    def write(text: str, name: str = "robot.mauve") -> str:
        Path(name).write_text(text, encoding="utf-8")
        return name

    return write
