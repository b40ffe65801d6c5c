"""Parallel additions, selections and saturation on the words of a run.

What depends on an unknown word is unknown, except that a selection of bytes knows those that are the same either way:
string routines read words in which what lies behind the string's end plays no part, and ask whether any byte of such a
selection is set.
"""

from __future__ import annotations

from mauve.wcet.flow.run.words import MASK, SIGN, UNKNOWN, WILD, Undecided, Unknown, Word, is_wild


class Partial(Unknown):
    """A word of which the bits in `known` are those of `bits`."""

    __slots__ = ("bits", "known")

    def __init__(self, known: int, bits: int) -> None:
        self.known, self.bits = known, bits & known

    def __eq__(self, other: object) -> bool:
        if type(other) is int and (other ^ self.bits) & self.known:
            return False
        raise Undecided

    def __ne__(self, other: object) -> bool:
        return not self == other

    def __bool__(self) -> bool:
        return self != 0

    __hash__ = object.__hash__

    def __and__(self, other: object) -> Word:
        return partial(self.known | ~other & MASK, self.bits & other) if type(other) is int else UNKNOWN

    __rand__ = __and__

    def _lost(self, other: object) -> Unknown:
        return UNKNOWN

    __add__ = __radd__ = __sub__ = __rsub__ = __mul__ = __rmul__ = __lshift__ = __rlshift__ = _lost
    __rshift__ = __rrshift__ = __or__ = __ror__ = __xor__ = __rxor__ = _lost

    def __neg__(self) -> Unknown:
        return UNKNOWN


def partial(known: int, bits: int) -> Word:
    """A word with the bits that are known."""
    if known == MASK:
        return bits
    return Partial(known, bits) if known else UNKNOWN


def _known(word: Word) -> tuple[int, int]:
    if type(word) is int:
        return MASK, word
    return (word.known, word.bits) if type(word) is Partial else (0, 0)


_ADDS, _SUBTRACTS = False, True
_PARTS = {
    "add16": (16, ((0, _ADDS), (0, _ADDS))),
    "asx": (16, ((1, _SUBTRACTS), (1, _ADDS))),
    "sax": (16, ((1, _ADDS), (1, _SUBTRACTS))),
    "sub16": (16, ((0, _SUBTRACTS), (0, _SUBTRACTS))),
    "add8": (8, ((0, _ADDS),) * 4),
    "sub8": (8, ((0, _SUBTRACTS),) * 4),
}
"""By shape: the bits of a part, and for each part whether b's comes from the other half, and what is done."""


def media_parallel(prefix: str, shape: str, a: Word, b: Word) -> tuple[Word, Word]:
    """The result, and the four bits GE (of use for the prefixes s and u only)."""
    if type(a) is not int or type(b) is not int:
        return (WILD if is_wild(a) or is_wild(b) else UNKNOWN), UNKNOWN
    size, parts = _PARTS[shape]
    top, ones = 1 << size - 1, (1 << size) - 1
    result = greater = 0
    for place, (crossed, subtracts) in enumerate(parts):
        x = a >> size * place & ones
        y = b >> size * (place ^ crossed) & ones
        if not prefix.startswith("u"):
            x, y = (x ^ top) - top, (y ^ top) - top
        total = x - y if subtracts else x + y
        if total >= (1 << size if prefix == "u" and not subtracts else 0):
            greater |= (3 << 2 * place) if size == 16 else 1 << place
        if prefix == "q":
            total = min(max(total, -top), top - 1)
        elif prefix == "uq":
            total = min(max(total, 0), ones)
        elif prefix in ("sh", "uh"):
            total >>= 1
        result |= (total & ones) << size * place
    return result, greater


_BYTES = tuple(sum(0xFF << 8 * i for i in range(4) if bits >> i & 1) for bits in range(16))


def media_select(greater: Word, a: Word, b: Word) -> Word:
    """The bytes of a where GE is set, those of b where not."""
    if type(greater) is int and type(a) is int and type(b) is int:
        return a & _BYTES[greater] | b & ~_BYTES[greater]
    if is_wild(a) or is_wild(b):
        return WILD
    (first, x), (second, y) = _known(a), _known(b)
    if type(greater) is int:
        chosen = _BYTES[greater]
        return partial(first & chosen | second & ~chosen, x & chosen | y & ~chosen)
    same = first & second & ~(x ^ y)
    return partial(same, x & same)


def media_saturate(a: Word, bits: int, signed: bool) -> Word:
    """The number of `bits` bits that is nearest to a."""
    if type(a) is not int:
        return UNKNOWN
    low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
    return min(max((a ^ SIGN) - SIGN, low), high) & MASK
