"""Terms over the values that registers and memory cells had at one point of a program, and relations between terms.

A term is a linear combination of atoms with a constant, modulo 2**32: the arithmetic that address and counter
computations are made of is exact, everything else is an opaque application of an operation. Two equal terms have equal
values; terms that differ may have equal values all the same. Relations only ever state facts that hold.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum

from mauve.wcet.binary.microop import Op
from mauve.wcet.flow.domain import clears_low_bits
from mauve.wcet.flow.locations import ANY, HALF, WORD, Interval, Location, whole

LARGEST_TERM = 48
"""Terms with more atoms than this are replaced by an unknown value: no argument of ours looks that deep."""


@dataclass(frozen=True, slots=True)
class Var:
    """The value of a location at the point where the summary starts."""

    location: Location
    _hash: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_hash", hash(self.location))

    def __hash__(self) -> int:
        return self._hash


@dataclass(frozen=True, slots=True)
class FrameBase:
    """The value of sp when the function was entered."""


@dataclass(frozen=True, slots=True)
class Fresh:
    """Some value between `low` and `high`; two different ids have nothing to do with each other."""

    id: int
    low: int = 0
    high: int = WORD - 1

    def __hash__(self) -> int:
        return hash(self.id)


@dataclass(frozen=True, slots=True)
class Apply:
    """An operation that is not linear, on terms."""

    op: Op
    args: tuple[Term, ...]
    _hash: int = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_hash", hash((self.op, self.args)))

    def __hash__(self) -> int:
        return self._hash


@dataclass(frozen=True, slots=True)
class Truth:
    """1 where the relation holds, 0 where it does not: a flag used as a number."""

    relation: Relation


Atom = Var | FrameBase | Fresh | Apply | Truth
_STACK: frozenset[tuple[Atom, int]] = frozenset({(FrameBase(), 1)})


@dataclass(frozen=True, slots=True)
class Term:
    """constant + sum of coefficient * atom, modulo 2**32; 0 <= constant < 2**32, 0 < coefficient < 2**32."""

    constant: int
    parts: frozenset[tuple[Atom, int]] = frozenset()
    size: int = 0

    def __hash__(self) -> int:
        return hash((self.constant, self.parts))

    def __str__(self) -> str:
        return show(self)

    @property
    def is_constant(self) -> bool:
        """Whether the term is a number."""
        return not self.parts


class Kind(Enum):
    """The relations; the others are these with the sides exchanged."""

    EQ = "=="
    NE = "!="
    ULT = "<u"
    UGE = ">=u"
    SLT = "<s"
    SGE = ">=s"


_NEGATED = {
    Kind.EQ: Kind.NE,
    Kind.NE: Kind.EQ,
    Kind.ULT: Kind.UGE,
    Kind.UGE: Kind.ULT,
    Kind.SLT: Kind.SGE,
    Kind.SGE: Kind.SLT,
}


@dataclass(frozen=True, slots=True)
class Relation:
    """`a kind b`, on 32-bit values."""

    kind: Kind
    a: Term
    b: Term

    @property
    def negated(self) -> Relation:
        """The relation that holds exactly when this one does not."""
        return Relation(_NEGATED[self.kind], self.a, self.b)

    def __str__(self) -> str:
        return f"{self.a} {self.kind.value} {self.b}"


def number(value: int) -> Term:
    """A constant."""
    return Term(value % WORD)


ZERO = number(0)


def atom(of: Atom, coefficient: int = 1) -> Term:
    """coefficient * atom."""
    return _linear(0, {of: coefficient})


def variable(location: Location) -> Term:
    """The value of the location at the start."""
    return atom(Var(location))


def _atom_size(of: Atom) -> int:
    match of:
        case Apply():
            return 1 + sum(arg.size for arg in of.args)
        case Truth():
            return 1 + of.relation.a.size + of.relation.b.size
        case _:
            return 1


def _linear(constant: int, parts: dict[Atom, int]) -> Term:
    if len(parts) > 1:
        _gather_division(parts)
    kept = frozenset((a, c % WORD) for a, c in parts.items() if c % WORD)
    return Term(constant % WORD, kept, sum(_atom_size(a) for a, _ in kept))


def add(a: Term, b: Term, factor: int = 1) -> Term:
    """a + factor * b."""
    if b.is_constant:
        return Term((a.constant + factor * b.constant) % WORD, a.parts, a.size)
    parts = dict(a.parts)
    for part, coefficient in b.parts:
        parts[part] = parts.get(part, 0) + factor * coefficient
    return _linear(a.constant + factor * b.constant, parts)


def subtract(a: Term, b: Term) -> Term:
    """a - b."""
    return add(a, b, -1)


def scale(a: Term, factor: int) -> Term:
    """factor * a."""
    return add(ZERO, a, factor)


def signed(value: int) -> int:
    """A 32-bit value read as two's complement."""
    return (value + HALF) % WORD - HALF


def fold(op: Op, a: int, b: int) -> int | None:
    """The operation on numbers; None where it is not modelled or reads flags."""
    amount = b & 0xFF
    match op:
        case Op.AND:
            return a & b
        case Op.OR:
            return a | b
        case Op.XOR:
            return a ^ b
        case Op.SHL:
            return (a << amount) % WORD if amount < 32 else 0
        case Op.LSR:
            return a >> amount if amount < 32 else 0
        case Op.ASR:
            return (signed(a) >> min(amount, 31)) % WORD
        case Op.ROR:
            amount %= 32
            return ((a >> amount) | (a << (32 - amount))) % WORD
        case Op.UMULH:
            return a * b >> 32
        case Op.SMULH:
            return (signed(a) * signed(b) >> 32) % WORD
        case Op.UDIV:
            return a // b if b else 0
        case Op.SDIV:
            return _truncated(signed(a), signed(b)) % WORD
        case Op.CLZ:
            return 32 - a.bit_length()
        case Op.UXTB:
            return a & 0xFF
        case Op.UXTH:
            return a & 0xFFFF
        case Op.SXTB:
            return ((a & 0xFF ^ 0x80) - 0x80) % WORD
        case Op.SXTH:
            return ((a & 0xFFFF ^ 0x8000) - 0x8000) % WORD
        case _:
            return None


def _truncated(a: int, b: int) -> int:
    """a / b rounded towards zero; 0 when b is."""
    return (abs(a) // abs(b)) * (1 if (a < 0) == (b < 0) else -1) if b else 0


_UNARY = {Op.CLZ, Op.RBIT, Op.REV, Op.REV16, Op.REVSH, Op.SXTB, Op.SXTH, Op.UXTB, Op.UXTH}
_COMMUTATIVE = {Op.AND, Op.OR, Op.XOR, Op.MUL, Op.UMULH, Op.SMULH}


def compute(op: Op, a: Term, b: Term) -> Term | None:
    """op(a, b) as a term, for the operations that read no flags; None for a value that nothing is known of."""
    match op:
        case Op.MOV:
            return a
        case Op.ADD:
            return _limited(add(a, b))
        case Op.SUB:
            return _limited(subtract(a, b))
        case Op.NOT:
            return subtract(number(-1), a)
        case Op.MUL if b.is_constant or a.is_constant:
            return scale(a, b.constant) if b.is_constant else scale(b, a.constant)
        case Op.SHL if b.is_constant:
            return scale(a, 1 << (b.constant & 0xFF)) if (b.constant & 0xFF) < 32 else ZERO
        case Op.UNKNOWN | Op.ADC | Op.SBC | Op.RRX:
            return None
    if op in _UNARY:
        b = ZERO
    if a.is_constant and b.is_constant and (value := fold(op, a.constant, b.constant)) is not None:
        return number(value)
    return _simplified(op, a, b)


def _limited(term: Term) -> Term | None:
    return term if term.size <= LARGEST_TERM else None


def _simplified(op: Op, a: Term, b: Term) -> Term | None:
    if op in _COMMUTATIVE and a.is_constant and not b.is_constant:
        a, b = b, a
    match op:
        case Op.LSR | Op.ASR | Op.ROR if b.is_constant and b.constant & 0xFF == 0:
            return a
        case Op.AND | Op.OR if a == b:
            return a
        case Op.XOR if a == b:
            return ZERO
        case Op.OR | Op.XOR if b == ZERO:
            return a
        case Op.OR if b.is_constant and b.constant < 4 and not a.constant & b.constant and a.parts == _STACK:
            return add(a, b)  # sp is a multiple of 4 at any time (AAPCS, 6.2.1.1)
        case Op.AND if b == ZERO:
            return ZERO
        case Op.AND if b.constant == WORD - 1 and b.is_constant:
            return a
        case Op.XOR if b.is_constant and b.constant == WORD - 1:
            return subtract(b, a)
        case Op.AND if b.is_constant and b.constant in (0xFF, 0xFFFF):
            op, b = (Op.UXTB if b.constant == 0xFF else Op.UXTH), ZERO
    if op in (Op.LSR, Op.ASR) and b.is_constant and b.constant in (16, 24):
        narrow = _without_shift(op, a, b.constant)
        if narrow is not None:
            return narrow
    divided = _as_division(op, a, b)
    if divided is not None:
        return atom(divided)
    args = (a,) if op in _UNARY else (a, b)
    if op in (Op.UXTB, Op.UXTH) and within(bounds(a), 0, 0xFF if op is Op.UXTB else 0xFFFF):
        return a
    return _limited(atom(Apply(op, args)))


def _without_shift(op: Op, a: Term, amount: int) -> Term | None:
    """(x << 16) >> 16 and (x << 24) >> 24 are extensions, as older cores write them."""
    unit = 1 << amount
    if a.constant % unit or any(factor % unit for _, factor in a.parts):
        return None
    x = _linear(a.constant >> amount, {of: signed(factor) // unit for of, factor in a.parts})
    extensions = {(Op.LSR, 16): Op.UXTH, (Op.LSR, 24): Op.UXTB, (Op.ASR, 16): Op.SXTH, (Op.ASR, 24): Op.SXTB}
    return _simplified(extensions[op, amount], x, ZERO)


# ------------------------------------------------------------------------------------------------------- divisions
def _as_division(op: Op, a: Term, b: Term) -> Apply | None:
    """What compilers write for divisions by constants, as what it is: umulh(x, m) >> s with m the rounded-up inverse of
    the divisor (Granlund and Montgomery, "Division by invariant integers using multiplication", theorem 4.2), and
    (x + (x >> 31)) >> 1 with the first shift unsigned for a signed half."""
    if not b.is_constant or a.constant or not 0 < b.constant < 32:
        return None
    inner = _only_atom(a)
    if op is Op.LSR and inner is not None and inner.op is Op.UMULH:
        divisor = _inverse(inner.args[1], 32 + b.constant, 1 << b.constant)
        return None if divisor is None else Apply(Op.UDIV, (inner.args[0], number(divisor)))
    if op is Op.ASR and b.constant == 1 and len(a.parts) == 2:
        for part, factor in a.parts:
            if isinstance(part, Apply) and part.op is Op.LSR and part.args[1] == number(31) and factor == 1:
                x = part.args[0]
                if subtract(a, atom(part)) == x:
                    return Apply(Op.SDIV, (x, number(2)))
    return None


def _gather_division(parts: dict[Atom, int]) -> None:
    """(smulh(x, m) >> s) - (x >> 31) is a signed division (theorem 5.1 of the same paper)."""
    for part, factor in list(parts.items()):
        if not (isinstance(part, Apply) and part.op is Op.ASR and part.args[1].is_constant):
            continue
        inner, shift = _only_atom(part.args[0]), part.args[1].constant & 0xFF
        if inner is None or inner.op is not Op.SMULH or part.args[0].constant or shift > 30:
            continue
        sign = Apply(Op.ASR, (inner.args[0], number(31)))
        divisor = _inverse(inner.args[1], 32 + shift, 1 << shift + 1)
        if divisor is None or divisor & (divisor - 1) == 0 or inner.args[1].constant >= HALF:
            continue  # the theorem asks for a factor above the inverse
        if (parts.get(sign, 0) + factor) % WORD == 0:
            del parts[part], parts[sign]
            whole = Apply(Op.SDIV, (inner.args[0], number(divisor)))
            parts[whole] = parts.get(whole, 0) + factor
            return


def _only_atom(term: Term) -> Apply | None:
    """The application that the term is, if it is one."""
    if len(term.parts) != 1 or term.constant:
        return None
    ((of, factor),) = term.parts
    return of if factor == 1 and isinstance(of, Apply) else None


def _inverse(factor: Term, bits: int, error: int) -> int | None:
    """The divisor d with 2**bits <= factor * d <= 2**bits + error, where multiplying by the factor and shifting by
    `bits` divides by d exactly for all operands."""
    if not factor.is_constant or not factor.constant:
        return None
    divisor = -(-(1 << bits) // factor.constant)
    return divisor if divisor > 1 and factor.constant * divisor - (1 << bits) <= error else None


# ------------------------------------------------------------------------------------------------------- intervals
Ranges = Callable[[Atom], Interval]
"""What is known of an atom's value."""


def static_range(of: Atom) -> Interval:
    """What holds of an atom anywhere."""
    match of:
        case Var(location):
            return whole(location)
        case Fresh():
            return Interval(of.low, of.high)
        case Truth():
            return Interval(0, 1)
        case _:
            return ANY


def interval(low: int, high: int) -> Interval:
    """The values low .. high modulo 2**32, written so that a usual reading does not wrap around, if there is one."""
    if high - low >= WORD - 1:
        return ANY
    start = low % WORD
    if start + high - low >= WORD and start >= HALF:
        start -= WORD
    return Interval(start, start + high - low)


def within(of: Interval, low: int, high: int) -> bool:
    """Whether every value lies in low .. high, read as signed if low is negative and as unsigned otherwise."""
    least, greatest = of.signed if low < 0 else of.unsigned
    return low <= least and greatest <= high


def bounds(term: Term, ranges: Ranges = static_range) -> Interval:
    """An interval that contains the term's value."""
    low = high = signed(term.constant)
    for part, coefficient in term.parts:
        factor = signed(coefficient)
        of = _atom_bounds(part, ranges)
        ends = (factor * of.low, factor * of.high)
        low, high = low + min(ends), high + max(ends)
    return interval(low, high)


def _atom_bounds(of: Atom, ranges: Ranges) -> Interval:
    known = ranges(of)
    if not isinstance(of, Apply):
        return known
    arguments = [bounds(arg, ranges) for arg in of.args]
    return meet(known, apply_bounds(of.op, arguments[0], arguments[1] if len(arguments) > 1 else Interval(0, 0)))


def meet(a: Interval, b: Interval) -> Interval:
    """An interval that contains the values in both, the smaller of the two where their common part is not one interval.

    An empty common part means that no execution comes here; the answer is then one of the two.
    """
    best = a if a.high - a.low <= b.high - b.low else b
    for (al, ah), (bl, bh) in ((a.unsigned, b.unsigned), (a.signed, b.signed)):
        low, high = max(al, bl), min(ah, bh)
        if low <= high and high - low < best.high - best.low:
            best = interval(low, high)
    return best


def apply_bounds(op: Op, a: Interval, b: Interval) -> Interval:
    """The values of an operation on values of two intervals."""
    (al, ah), (bl, bh) = a.unsigned, b.unsigned
    match op:
        case Op.AND if bl == bh and clears_low_bits(ah, bl):
            return Interval(al & bl, ah & bl)
        case Op.AND:
            return Interval(0, min(ah, bh))
        case Op.OR:
            return Interval(max(al, bl), max(ah, bh, (1 << (ah | bh).bit_length()) - 1))
        case Op.XOR:
            return Interval(0, (1 << (ah | bh).bit_length()) - 1)
        case Op.LSR if bh <= 255:
            return Interval(al >> bh, ah >> bl)
        case Op.ASR if bh <= 255:
            low, high = a.signed
            return interval(min(low >> bl, low >> bh), max(high >> bl, high >> bh))
        case Op.SHL if bh < 32 and ah << bh < WORD:
            return Interval(al << bl, ah << bh)
        case Op.MUL if ah * bh < WORD:
            return Interval(al * bl, ah * bh)
        case Op.UMULH:
            return Interval(al * bl >> 32, ah * bh >> 32)
        case Op.UDIV:
            return Interval(al // bh if bl else 0, ah // max(bl, 1))
        case Op.SMULH:
            ends = [x * y >> 32 for x in a.signed for y in b.signed]
            return interval(min(ends), max(ends))
        case Op.SDIV if bl == bh and signed(bl) > 0:
            return interval(_truncated(a.signed[0], bl), _truncated(a.signed[1], bl))
        case Op.CLZ:
            return Interval(32 - ah.bit_length(), 32 - al.bit_length())
        case Op.UXTB | Op.UXTH:
            top = 0xFF if op is Op.UXTB else 0xFFFF
            return Interval(al, ah) if ah <= top else Interval(0, top)
        case Op.SXTB | Op.SXTH:
            top = 0x7F if op is Op.SXTB else 0x7FFF
            return a if within(a, -top - 1, top) else Interval(-top - 1, top)
        case _:
            return ANY


# ---------------------------------------------------------------------------------------------------- substitution
def substitute(term: Term, value: Callable[[Atom], Term | None]) -> Term | None:
    """The term with atoms replaced; `value` gives None to leave an atom as it is. None: the result grows too large."""
    result = number(term.constant)
    for part, coefficient in term.parts:
        replacement = value(part)
        if replacement is None:
            replacement = _substitute_inside(part, value)
        if replacement is None:
            return None
        result = add(result, replacement, coefficient)
    return _limited(result)


def _substitute_inside(part: Atom, value: Callable[[Atom], Term | None]) -> Term | None:
    match part:
        case Apply(op, args):
            new = [substitute(arg, value) for arg in args]
            if any(arg is None for arg in new):
                return None
            if tuple(new) == args:
                return atom(part)
            if len(new) == 2 or op in _UNARY:
                first, second = new[0], new[1] if len(new) == 2 else ZERO
                assert first is not None and second is not None
                return compute(op, first, second)
            return None
        case Truth(relation):
            a, b = substitute(relation.a, value), substitute(relation.b, value)
            return None if a is None or b is None else atom(Truth(Relation(relation.kind, a, b)))
        case _:
            return atom(part)


_LIMITS = {Op.UXTB: (0, 0xFF), Op.UXTH: (0, 0xFFFF), Op.SXTB: (-0x80, 0x7F), Op.SXTH: (-0x8000, 0x7FFF)}
_WITHIN = {Op.UXTB: (Op.SXTB, Op.UXTH, Op.SXTH), Op.SXTB: (Op.UXTB, Op.UXTH, Op.SXTH), Op.UXTH: (Op.SXTH,),
           Op.SXTH: (Op.UXTH,)}  # fmt: skip
"""The extensions that another one makes superfluous inside it: they keep the bits that it keeps."""


def simplify(term: Term, ranges: Ranges) -> Term:
    """The term with extensions removed that change nothing for values in the given ranges, or moved before a constant
    is added, and signs shifted in that are zeros."""

    def value(of: Atom) -> Term | None:
        if isinstance(of, Apply) and of.op is Op.ASR and bounds(of.args[0], ranges).signed[0] >= 0:
            return compute(Op.LSR, *(simplify(arg, ranges) for arg in of.args))
        if not isinstance(of, Apply) or of.op not in _LIMITS:
            return None
        inner = simplify(of.args[0], ranges)
        if within(bounds(inner, ranges), *_LIMITS[of.op]):
            return inner
        return _before_adding(of.op, inner, ranges)

    return substitute(term, value) or term


def _before_adding(op: Op, inner: Term, ranges: Ranges) -> Term | None:
    """x extended, plus c, for the extension of x + c (x extended within itself or not), where that does not wrap."""
    constant = 0
    while len(inner.parts) == 1:
        ((of, factor),) = inner.parts
        if factor != 1 or not isinstance(of, Apply) or of.op not in (op, *_WITHIN[op]):
            break
        constant, inner = constant + inner.constant, of.args[0]
    constant = signed((constant + inner.constant) % WORD)
    extended = compute(op, subtract(inner, number(inner.constant)), ZERO)
    if extended is None or not constant:
        return extended
    low, high = bounds(extended, ranges).signed
    least, most = _LIMITS[op]
    return add(extended, number(constant)) if least <= low + constant and high + constant <= most else None


def atoms(term: Term) -> set[Atom]:
    """All atoms of the term, also inside applications."""
    found: set[Atom] = set()
    for part, _ in term.parts:
        found.add(part)
        match part:
            case Apply(_, args):
                for arg in args:
                    found |= atoms(arg)
            case Truth(relation):
                found |= atoms(relation.a) | atoms(relation.b)
    return found


def show(term: Term) -> str:
    """The term as text, for messages and tests."""
    words = []
    for part, coefficient in term.parts:
        match part:
            case Var(location):
                name = f"r{location}" if isinstance(location, int) else str(location)
            case FrameBase():
                name = "sp0"
            case Fresh(identity):
                name = f"?{identity}"
            case Apply(op, args):
                name = f"{op.value}({', '.join(show(arg) for arg in args)})"
            case Truth(relation):
                name = f"({relation})"
        factor = signed(coefficient)
        words.append(name if factor == 1 else f"{factor}*{name}")
    words.sort()
    if term.constant or not words:
        words.append(str(signed(term.constant)))
    return " + ".join(words)
