"""`mauvec mission --simulate`: step a mission's controller from typed or scripted events."""

from __future__ import annotations

import sys
from argparse import Namespace
from io import TextIOWrapper

from mauve.cli.output import wrong_usage
from mauve.lower.mission import plan
from mauve.mission.simulate import Refused, Session, begin, possible, script, step, told
from mauve.mission.templates import build_net
from mauve.model.model import Model

HELP = """events: start, ok OBJECTIVE, fail OBJECTIVE, timeout OBJECTIVE, lose HARDWARE, recover HARDWARE
        or the name of an event; `where` shows the state, `quit` ends
"""


def simulate(model: Model, name: str, arguments: Namespace) -> int:
    """Step the mission of that name; 1 where an event of a script was refused."""
    assert model.missions is not None
    mission = next(mission for mission in model.missions.missions if mission.name == name)
    session = begin(build_net(plan(mission)))
    if arguments.events is not None:
        return _script(session, arguments.events)
    return _typed(session, sys.stdin.isatty())


def _script(session: Session, path: str) -> int:
    try:
        with open(path, encoding="utf-8") as stream:
            lines = stream.read().splitlines()
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not UTF-8 text"
        return wrong_usage(f"cannot read {path}: {reason}")
    answers = script(session, lines)
    for answer in answers:
        print(told(answer))
        if not isinstance(answer, Refused):
            session = answer.session
    print(_where(session))
    return 1 if any(isinstance(answer, Refused) for answer in answers) else 0


def _typed(session: Session, terminal: bool) -> int:
    """Events from standard input, one a line; a refused one is told and changes nothing."""
    if terminal:
        sys.stdout.write(HELP)
    refused = False
    if isinstance(sys.stdin, TextIOWrapper):
        sys.stdin.reconfigure(errors="replace")
    while True:
        if terminal:
            print(f"possible: {', '.join(possible(session)) or 'nothing'}")
            sys.stdout.write("> ")
            sys.stdout.flush()
        line = sys.stdin.readline()
        typed = line.split("#")[0].split("//")[0].strip()
        if not line or typed in ("quit", "exit"):
            break
        if typed == "where":
            print(_where(session))
        elif typed in ("help", "?"):
            sys.stdout.write(HELP)
        elif typed:
            answer = step(session, typed)
            print(told(answer))
            if isinstance(answer, Refused):
                refused = True
            else:
                session = answer.session
    print(_where(session))
    return 1 if refused and not terminal else 0


def _where(session: Session) -> str:
    """The state in a few lines: objectives, alternatives, resources."""
    seen = session.view
    running = [name if way == "only" else f"{name}.{way}" for name, way in seen.running]
    lines = [
        f"objectives: {', '.join(seen.objectives) or '-'}",
        f"running: {', '.join(running) or '-'}",
        f"out of service: {', '.join(seen.lost) or '-'}",
    ]
    lines += [f"without an alternative: {', '.join(seen.failed)}"] if seen.failed else []
    lines += [f"mission: {seen.outcome}"] if seen.outcome else []
    return "\n".join(lines)
