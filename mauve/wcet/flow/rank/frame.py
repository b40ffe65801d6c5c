"""Where a function's registers point into its own stack frame, what its stores may touch, whether the frame escapes.

One cheap forward pass over a function. A register holds `entry sp + constant`, or something computed from sp, or
nothing of the stack. Assumed as everywhere (and listed in results): memory and arguments hold no address of an
active frame unless the function itself put it there or passed it on.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from mauve.wcet.binary.floats import ToFloat
from mauve.wcet.binary.graph import EXIT, Cfg
from mauve.wcet.binary.microop import SP, Compute, Imm, Instruction, Load, Op, Operand, Store, StoreUnknown
from mauve.wcet.flow.locations import AAPCS, HALF, WORD, Base, CallEffects, Region


@dataclass(frozen=True, slots=True)
class StoreTarget:
    """What a store may touch: `region` where it is exactly known; `frame`: it may be inside the function's frame."""

    region: Region | None
    frame: bool


@dataclass(frozen=True, slots=True)
class Frame:
    """`offsets[block]` maps registers to their distance from the entry sp at the start of the block.

    `stores` is keyed by instruction address and index of the micro-operation; `escapes`: an address of the frame may be
    known elsewhere.
    """

    offsets: tuple[Mapping[int, int], ...]
    stores: Mapping[tuple[int, int], StoreTarget]
    escapes: bool


@dataclass(slots=True)
class _Pointers:
    """`known`: registers at a constant distance from the entry sp; `derived`: all registers computed from sp."""

    known: dict[int, int]
    derived: set[int] = field(default_factory=set)

    def copy(self) -> _Pointers:
        return _Pointers(dict(self.known), set(self.derived))

    def join(self, other: _Pointers) -> bool:
        """Weaken to what holds in both; whether that changed anything."""
        known = {r: k for r, k in self.known.items() if other.known.get(r) == k}
        derived = self.derived | other.derived
        changed = known != self.known or derived != self.derived
        self.known, self.derived = known, derived
        return changed


def analyse_frame(cfg: Cfg, effects: Mapping[int, CallEffects]) -> Frame:
    """The least fixed point of the pass described above."""
    at: dict[int, _Pointers] = {cfg.entry: _Pointers({SP: 0}, {SP})}
    leaving: dict[int, list[int]] = {}
    for index, edge in enumerate(cfg.edges):
        leaving.setdefault(edge.source, []).append(index)
    escapes = False
    work = [cfg.entry]
    while work:
        block = work.pop()
        here = at[block].copy()
        for instruction in cfg.blocks[block].instructions:
            escapes |= _instruction(instruction, here, {})
        for index in leaving.get(block, ()):
            edge = cfg.edges[index]
            after = here
            if edge.callees or edge.kind.value in ("call", "tail"):
                escapes |= bool(here.derived & {0, 1, 2, 3})
                after = here.copy()
                for register in effects.get(index, AAPCS).registers:
                    _forget(after, register)
            if edge.target == EXIT:
                continue
            if edge.target not in at:
                at[edge.target] = after.copy()
                work.append(edge.target)
            elif at[edge.target].join(after) and edge.target not in work:
                work.append(edge.target)
    offsets = tuple(at[b.id].known if b.id in at else {} for b in cfg.blocks)
    return Frame(offsets, _all_stores(cfg, at), escapes)


def _all_stores(cfg: Cfg, at: Mapping[int, _Pointers]) -> dict[tuple[int, int], StoreTarget]:
    """What each store may touch, at the fixed point; copies of an instruction in several blocks are taken together."""
    stores: dict[tuple[int, int], StoreTarget] = {}
    for block, pointers in at.items():
        here = pointers.copy()
        found: dict[tuple[int, int], StoreTarget] = {}
        for instruction in cfg.blocks[block].instructions:
            _instruction(instruction, here, found)
        for key, target in found.items():
            other = stores.get(key, target)
            same = target if target == other else StoreTarget(None, target.frame or other.frame)
            stores[key] = same
    return stores


def _forget(pointers: _Pointers, register: int) -> None:
    pointers.known.pop(register, None)
    pointers.derived.discard(register)


def _instruction(instruction: Instruction, here: _Pointers, stores: dict[tuple[int, int], StoreTarget]) -> bool:
    """Carry `here` over the instruction, note its stores; whether it stores an address of the frame."""
    before = here.copy() if instruction.condition.name != "AL" else None
    escapes = False
    constants: dict[int, int] = {}
    for index, op in enumerate(instruction.ops):
        match op:
            case Compute():
                _compute(op, here, constants)
            case Load(dst):
                _forget(here, dst)
                constants.pop(dst, None)
            case Store(address, value, size):
                escapes |= not isinstance(value, Imm) and value in here.derived
                _store(instruction, index, address, size, here, stores)
            case StoreUnknown(address, size):
                _store(instruction, index, address, size, here, stores)
            case ToFloat(_, source):  # not followed: what comes back from the FPU is unknown
                escapes |= source in here.derived
    for temporary in [r for r in here.derived if r > 15]:
        _forget(here, temporary)
    if before is not None:
        here.join(before)
    return escapes


def _compute(op: Compute, here: _Pointers, constants: dict[int, int]) -> None:
    def constant(operand: Operand) -> int | None:
        return operand.value if isinstance(operand, Imm) else constants.get(operand)

    a, b = op.a, op.b
    distance: int | None = None
    result: int | None = None
    known_a = None if isinstance(a, Imm) else here.known.get(a)
    known_b = None if isinstance(b, Imm) else here.known.get(b)
    if op.op is Op.MOV:
        distance, result = known_a, constant(a)
    elif op.op in (Op.ADD, Op.SUB):
        number = constant(b)
        if known_a is not None and number is not None:
            distance = known_a + (number if op.op is Op.ADD else -number)
        elif known_b is not None and op.op is Op.ADD and (number := constant(a)) is not None:
            distance = known_b + number
    elif op.op is Op.OR and known_a is not None:
        number = constant(b)
        if number is not None and number < 4 and not known_a & number:  # sp is a multiple of 4 (AAPCS, 6.2.1.1)
            distance = known_a + number
    derived = any(not isinstance(o, Imm) and o in here.derived for o in (a, b))
    _forget(here, op.dst)
    constants.pop(op.dst, None)
    if result is not None:
        constants[op.dst] = result
    if distance is not None:
        here.known[op.dst] = (distance + HALF) % WORD - HALF
    if derived:
        here.derived.add(op.dst)


def _store(
    instruction: Instruction,
    index: int,
    address: Operand,
    size: int,
    here: _Pointers,
    stores: dict[tuple[int, int], StoreTarget],
) -> None:
    if isinstance(address, Imm):
        target = StoreTarget(Region(Base.ABSOLUTE, address.value, address.value + size - 1), False)
    elif (distance := here.known.get(address)) is not None:
        target = StoreTarget(Region(Base.SP, distance, distance + size - 1), True)
    else:
        target = StoreTarget(None, address in here.derived)
    stores[instruction.address, index] = target
