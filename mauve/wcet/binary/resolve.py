"""Where indirect jumps go: stub."""
from __future__ import annotations
from dataclasses import dataclass
from mauve.wcet.binary.elf import Binary
from mauve.wcet.binary.microop import Instruction, IndirectJump

@dataclass(frozen=True, slots=True)
class Resolution:
    """r"""
    targets: tuple[int, ...] = ()
    returns: bool = False
    link: int | None = None

class Code:
    """c"""
    def __init__(self, binary: Binary, key: int) -> None:
        self.binary, self.key = binary, key
        self.instructions: dict[int, Instruction] = {}
        self.sources: dict[int, set[tuple[int, bool]]] = {}

    def connect(self, source: int, target: int, call: bool) -> None:
        """c"""
        self.sources.setdefault(target, set()).add((source, call))

def link_before(code: Code, instruction: Instruction) -> int | None:
    """l"""
    return None

def resolve(code: Code, instruction: Instruction) -> Resolution | None:
    """r"""
    if isinstance(instruction.flow, IndirectJump) and instruction.flow.returns:
        return Resolution(returns=True)
    return None
