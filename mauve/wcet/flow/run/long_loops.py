"""Loops that unknown values do not end, or that are followed when time runs short: for all values at once, until
nothing new comes."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mauve.wcet.binary.graph import EXIT
from mauve.wcet.flow.run.census import census
from mauve.wcet.flow.run.frames import Covered, Frame
from mauve.wcet.flow.run.layers import Layer, release
from mauve.wcet.flow.run.measure import iterations
from mauve.wcet.flow.run.paths import Path, Starts
from mauve.wcet.flow.run.repeats import Kept, changed, includes, is_less, keep, widen
from mauve.wcet.flow.run.words import UNKNOWN, WILD

if TYPE_CHECKING:
    from mauve.wcet.flow.run.machine import Machine

LOOKING, ASKING, PATIENCE, FEW = 24, 400, 3_000, 40
"""Iterations of a loop that unknown values do not end: after so many it is compared with earlier ones, then a proof of
its bound is asked for, and then (after few, for one that was found to go on before) all values are followed at once."""
LOOSE = 1 << 12
"""Iterations that a proof allows for, and still the ways of the loop are followed apart."""
SOON, UNROLLED = 2, 60_000
"""The same when time runs short: iterations of a loop in which all values were followed at once before, and the work
for others."""


def starts_of(frame: Frame, block: int, but: int | None = None) -> Starts:
    """The words that were there when an iteration around a block began, of loops (`but` one) that go on and on."""
    if not frame.kept or block == EXIT:
        return ()
    around = (loop for _, loop in frame.function.around[block][0] if loop in frame.kept and loop != but)
    return [start for loop in around for start in frame.kept[loop].starts]


def arrive(machine: Machine, frame: Frame, block: int) -> int:
    """Come to a block. At the header of a loop that goes on and on: raises Covered where this iteration can do
    nothing that an earlier one did not do, and has it cover all further ones in the end."""
    loop = frame.function.headers.get(block)
    if loop is None or not (machine.hurried or frame.open.get(loop, 0) > LOOKING):
        return block
    _forget(machine, frame, block)
    memory, compared, since, rounds = machine.memory, frame.function.compared, machine.steps, 0
    if frame.census is not None and frame.census.loop == loop:
        frame.census.note(memory, Path(block, machine.registers, memory.layer, frame.now))
        raise Covered
    places = list(compared.places)
    kept = frame.kept.get(loop)
    path = Path(block, machine.registers, memory.layer, frame.now)
    if kept is not None:
        since = kept.since
        wide = _is_long(machine, frame, loop, kept)
        # Where less and less remains possible, an end may come.
        if includes(memory, kept, path) and (wide or not is_less(memory, kept, path)):
            if not _goes_on(machine, frame, loop, kept, path):
                raise Covered
            return block
        if wide:
            path = widen(memory, kept, path, compared, starts_of(frame, block, loop))
            rounds = kept.rounds + 1
            frame.function.endless.add(loop)
            places = list(dict.fromkeys([*places, *changed(kept, path)]))
            frame.loose.add(loop)
            machine.take(frame, path)
        elif frame.now.current[loop] < 2 * kept.path.counters.current[loop]:
            return block
        release(kept.path.layer)
    layer = memory.layer
    now = Path(block, machine.registers, layer, frame.now)
    outer = starts_of(frame, block, loop)
    frame.kept[loop] = keep(memory, now, places, compared.pairs, outer, since, rounds)
    memory.enter(Layer(layer))
    return block


def _forget(machine: Machine, frame: Frame, block: int) -> None:
    """Leave nothing in registers and flags that is not read any more."""
    for slot in frame.function.code.stale[block]:
        machine.registers[slot] = UNKNOWN
    for register in frame.function.dead[block]:
        machine.registers[register] = WILD


def _is_long(machine: Machine, frame: Frame, loop: int, kept: Kept) -> bool:
    """Whether it is time to follow all values of a loop at once."""
    again, count = loop in frame.function.endless, frame.now.current[loop]
    if machine.hurried:
        return (again and count > SOON) or machine.steps - kept.since > UNROLLED
    return count > (FEW if again else PATIENCE)


def _goes_on(machine: Machine, frame: Frame, loop: int, kept: Kept, path: Path) -> bool:
    """Nothing new comes of further iterations of a loop. Whether its ways are followed apart now, to bound it."""
    function = frame.function
    frame.loose.add(loop)
    function.endless.add(loop)
    if frame.census is not None and function.nest.loops[loop].blocks < frame.census.blocks:
        return False
    before = kept.path.counters.current[loop]
    apart = path.counters.current[loop] - before
    more = iterations(machine.memory, kept, path, function, loop, apart)
    limit = machine.limit_of(frame, loop) if more is None else before + more
    may_gain = (limit is None or limit > LOOSE) and loop not in function.unmeasured and loop not in frame.endless
    if may_gain and apart == 1:
        _follow_ways(machine, frame, loop, kept, limit)
    else:
        _settle(frame, loop, limit)
    return may_gain and apart == 1


def _settle(frame: Frame, loop: int, limit: int | None) -> None:
    """A loop that goes on and on has a bound, or none."""
    if limit is None:
        frame.endless.add(loop)
    else:
        frame.proven[loop] = max(limit, frame.proven.get(loop, 0))


def _follow_ways(machine: Machine, frame: Frame, loop: int, kept: Kept, limit: int | None) -> None:
    """Begin one more iteration of a loop, from the path that covers all, on which its ways are followed apart."""
    end_census(frame)
    function, path = frame.function, kept.path
    blocks = function.nest.loops[loop].blocks
    frame.census = census(machine.memory, kept, loop, blocks, function.compared.pairs, limit)
    release(machine.memory.layer)
    machine.take(frame, Path(path.block, path.registers[:], Layer(path.layer), path.counters.copy()))


def end_census(frame: Frame) -> None:
    """All ways of a loop that were followed apart have come to their ends."""
    found, frame.census = frame.census, None
    if found is None:
        return
    limit = found.limit_now()
    if limit is None or limit == found.limit:
        frame.function.unmeasured.add(found.loop)
    _settle(frame, found.loop, limit)


__all__ = ["ASKING", "arrive", "end_census", "starts_of"]
