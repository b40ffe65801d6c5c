"""Little pieces of A32 code for the tests of the cost models: words to blocks and graphs."""

from __future__ import annotations

from collections.abc import Sequence

from mauve.wcet.binary.decode import Decoded, Decoder
from mauve.wcet.binary.graph import EXIT, Block, Cfg, Edge, EdgeKind
from mauve.wcet.binary.microop import Instruction
from mauve.wcet.hardware.board import Board, Memory
from mauve.wcet.hardware.core import Core, load_core
from mauve.wcet.hardware.cost import edge_costs

BASE = 0x8000


def instructions(words: Sequence[int], address: int = BASE) -> tuple[Instruction, ...]:
    data = b"".join(word.to_bytes(4, "little") for word in words)

    def read(at: int, size: int) -> bytes | None:
        found = data[at - address : at - address + size]
        return found if at >= address and len(found) == size else None

    decoder = Decoder(read)
    made = []
    for index in range(len(words)):
        decoded = decoder.decode(address + 4 * index, thumb=False)
        assert isinstance(decoded, Decoded), decoded
        made.append(decoded.instruction)
    return tuple(made)


def graph(blocks: Sequence[Sequence[int]], edges: Sequence[tuple[int, int, EdgeKind]], address: int = BASE) -> Cfg:
    """Blocks of words one after the other from `address`, the first is the entry."""
    made, at = [], address
    for number, words in enumerate(blocks):
        made.append(Block(number, instructions(words, at)))
        at += 4 * len(words)
    return Cfg("f", address, False, 0, tuple(made), tuple(Edge(*edge) for edge in edges))


def core(name: str) -> Core:
    found = load_core(name)
    assert found is not None
    return found


def board(*memories: Memory, core_name: str = "arm7tdmi") -> Board:
    return Board("bench", core_name, 100_000_000, memories)


def cost(core_name: str, words: Sequence[int], memories: Sequence[Memory] = ()) -> int:
    """The cycles of a single block that leaves the function."""
    cfg = graph([words], [(0, EXIT, EdgeKind.RETURN)])
    costs = edge_costs(cfg, core(core_name), board(*memories, core_name=core_name), {})
    assert costs.problems == ()
    return costs.cycles[0]
