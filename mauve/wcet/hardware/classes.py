"""Which entry of a core's timing table an instruction uses.

The classes are the union of what the manuals of the supported cores tell apart; a core file that has no entry for a
class has no time for it, and an instruction of that class is a problem, never free.
"""

from __future__ import annotations

from mauve.wcet.binary.microop import Call, IndirectCall, Instruction, Kind, Traits

CONDITION_FAILED = "condition_failed"
"""An instruction whose condition does not hold, and a conditional branch that is not taken."""

_WITH_FLAGS = frozenset({Kind.MUL, Kind.MLA, Kind.LONG_MUL, Kind.LONG_MLA})
_LOADS = ("load", "load_scaled", "load_narrow", "load_narrow_scaled", "load_literal", "load_pc", "load_pc_scaled")
_MULTIPLES = ("load_multiple_one", "load_multiple_pc", "store_multiple_one")

TIMING_CLASSES: frozenset[str] = frozenset(
    {kind.value for kind in Kind}
    | {f"{kind.value}_flags" for kind in _WITH_FLAGS}
    | {"alu_register_shift", "alu_pc", "alu_pc_logical", "alu_pc_shift", "alu_pc_register_shift"}
    | set(_LOADS)
    | set(_MULTIPLES)
    | {"store_scaled", "swap_narrow", "branch_link_thumb", "branch_link_exchange", CONDITION_FAILED}
)


def timing_class(instruction: Instruction) -> str:
    """The name of the timing entry for an instruction that executes (its condition holds)."""
    traits = instruction.traits
    match traits.kind:
        case Kind.BRANCH_LINK | Kind.BRANCH_EXCHANGE if _is_blx(instruction):
            return "branch_link_exchange"
        case Kind.ALU:
            return _alu_class(traits)
        case Kind.LOAD:
            return _load_class(traits)
        case Kind.STORE:
            return "store_scaled" if traits.scaled_offset else "store"
        case Kind.LOAD_MULTIPLE:
            if traits.writes_pc:
                return "load_multiple_pc"
            return "load_multiple_one" if traits.transfers == 1 else "load_multiple"
        case Kind.STORE_MULTIPLE:
            return "store_multiple_one" if traits.transfers == 1 else "store_multiple"
        case Kind.SWAP:
            return "swap_narrow" if traits.width < 4 else "swap"
        case Kind.BRANCH_LINK:
            return "branch_link_thumb" if instruction.thumb else "branch_link"
        case _:
            flags = traits.sets_flags and traits.kind in _WITH_FLAGS
            return f"{traits.kind.value}_flags" if flags else str(traits.kind.value)


def _is_blx(instruction: Instruction) -> bool:
    """Whether it links and may change the instruction set: a class of its own, because ARMv4T has none of it."""
    match instruction.flow:
        case IndirectCall():
            return True
        case Call(thumb=thumb):
            return thumb != instruction.thumb
    return False


def _alu_class(traits: Traits) -> str:
    if not traits.writes_pc:
        return "alu_register_shift" if traits.shifts_by_register else "alu"
    if traits.shifts_by_register:
        return "alu_pc_register_shift"
    if traits.shifts:
        return "alu_pc_shift"
    return "alu_pc_logical" if traits.logical else "alu_pc"


def _load_class(traits: Traits) -> str:
    if traits.writes_pc:
        return "load_pc_scaled" if traits.scaled_offset else "load_pc"
    narrow = traits.width < 4 or traits.signed
    if traits.literal and not narrow:
        return "load_literal"
    return "load" + ("_narrow" if narrow else "") + ("_scaled" if traits.scaled_offset else "")
