"""Many functions of one executable: which ones there are, and their bounds on all processors of the machine."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from hashlib import sha256
from pathlib import Path

from mauve.records import record
from mauve.wcet.analysis import analyse_each
from mauve.wcet.cache import Cache, result_key
from mauve.wcet.flow.facts import Fact
from mauve.wcet.hardware.board import Board
from mauve.wcet.result import Problem, ProblemKind, WcetResult

Progress = Callable[[int, int, str], None]
"""Told after each function how many of how many are done, and the name of the last one."""

FEW = 24
"""So many functions are not worth a second process: what they have in common would be analysed in each."""


@record
class Settings:
    """What an analysis depends on beside the executable and the function."""

    board: Board
    facts: tuple[Fact, ...] = ()
    initial_data: bool = False
    timeout: float | None = None
    cache: bool = True


def all_functions(path: str | Path) -> tuple[str | int, ...] | Problem:
    """Every function with a symbol, by address, each address once: by its name, or by its address (bit 0 set for Thumb)
    where several have the name. A problem where the executable cannot be read or has no symbols."""
    from mauve.wcet.binary.elf import ElfProblem, load

    binary = load(path)
    if isinstance(binary, ElfProblem):
        from mauve.wcet.analysis import elf_problem

        return elf_problem(binary)
    found: dict[int, str | int] = {}
    for symbol in binary.functions:
        named = binary.function(symbol.name)
        unique = not isinstance(named, ElfProblem) and named.key == symbol.key
        found.setdefault(symbol.key, symbol.name if unique else symbol.key)
    if not found:
        message = f"{path} has no symbols of functions: name a function by its address, or link without -s"
        return Problem(ProblemKind.SYMBOL, message)
    return tuple(found.values())


def near_names(path: str | Path, wanted: str) -> tuple[str, ...]:
    """Functions of the executable that a misspelt name may mean, mangled ones of C++ included; empty where it cannot
    be read."""
    from mauve.diagnostics.suggest import closest
    from mauve.wcet.binary.elf import ElfProblem, load

    binary = load(path)
    if isinstance(binary, ElfProblem):
        return ()
    names = binary.function_names()
    mangled = f"_Z{len(wanted)}{wanted}"  # Itanium C++ ABI, section 5.1: a function outside namespaces and classes
    return tuple(name for name in names if name.startswith(mangled)) or closest(wanted, names)


def analyse_batch(
    path: str | Path,
    functions: Sequence[str | int],
    settings: Settings,
    workers: int = 1,
    progress: Progress | None = None,
) -> tuple[WcetResult, ...]:
    """The bound of every function, in the order given, as `analysis.analyse` makes it. What the cache does not hold is
    computed by up to `workers` processes."""
    results = dict(_known(path, functions, settings))
    done = len(results)
    for place, result in _computed(path, functions, settings, workers, results):
        results[place] = result
        done += 1
        if progress is not None:
            progress(done, len(functions), result.name)
    return tuple(results[place] for place in range(len(functions)))


def _known(
    path: str | Path, functions: Sequence[str | int], settings: Settings
) -> Iterator[tuple[int, WcetResult]]:
    """What an earlier run has kept, by place in `functions`."""
    if not settings.cache:
        return
    try:
        identity = sha256(Path(path).read_bytes()).hexdigest()
    except (OSError, ValueError):
        return
    cache = Cache()
    for place, function in enumerate(functions):
        result = cache.get(result_key(identity, function, settings.board, settings.facts, settings.initial_data))
        if result is not None:
            yield place, result


def _computed(
    path: str | Path,
    functions: Sequence[str | int],
    settings: Settings,
    workers: int,
    known: dict[int, WcetResult],
) -> Iterator[tuple[int, WcetResult]]:
    missing = [place for place in range(len(functions)) if place not in known]
    if workers < 2 or len(missing) <= FEW:
        yield from zip(missing, _analyse(path, [functions[place] for place in missing], settings), strict=True)
        return
    yield from _in_processes(path, functions, settings, workers, missing)


def _in_processes(
    path: str | Path, functions: Sequence[str | int], settings: Settings, workers: int, missing: list[int]
) -> Iterator[tuple[int, WcetResult]]:
    """Chunks of neighbours: they share what they call, which each chunk analyses anew, and all processes have work
    until the end."""
    from concurrent.futures import ProcessPoolExecutor, as_completed
    from multiprocessing import active_children

    size = max(1, min(64, len(missing) // (3 * workers)))
    chunks = [missing[start : start + size] for start in range(0, len(missing), size)]
    with ProcessPoolExecutor(workers, initializer=_obey_interrupts) as pool:
        try:
            jobs = {pool.submit(_chunk, path, [functions[p] for p in chunk], settings): chunk for chunk in chunks}
            for job in as_completed(jobs):
                yield from zip(jobs[job], job.result(), strict=True)
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            for child in active_children():
                child.terminate()
            raise


def _obey_interrupts() -> None:
    """Ctrl-C reaches all processes of a terminal: those that only compute end without a word."""
    import signal

    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _chunk(path: str | Path, functions: Sequence[str | int], settings: Settings) -> tuple[WcetResult, ...]:
    return tuple(_analyse(path, functions, settings))


def _analyse(path: str | Path, functions: Sequence[str | int], settings: Settings) -> Iterator[WcetResult]:
    cache = Cache() if settings.cache else None
    return analyse_each(
        path, functions, settings.board, settings.facts, settings.initial_data, settings.timeout, cache
    )
