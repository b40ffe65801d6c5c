"""The condition flags as relations between terms."""

from __future__ import annotations

from dataclasses import dataclass

from mauve.wcet.binary.microop import Condition, FlagKind, Op, Shift
from mauve.wcet.flow.locations import HALF
from mauve.wcet.flow.rank.terms import ZERO, Kind, Relation, Term, Truth, add, atom, compute, number, subtract


@dataclass(frozen=True, slots=True)
class Flags:
    """Z, N and C as relations that hold exactly when the flag is set (None: unknown).

    `compared` holds a pair (a, b) when N, Z, C and V are those of a - b.
    """

    z: Relation | None = None
    n: Relation | None = None
    c: Relation | None = None
    compared: tuple[Term, Term] | None = None


UNKNOWN = Flags()
_NEVER = Relation(Kind.NE, ZERO, ZERO)


def set_flags(kind: FlagKind, a: Term, b: Term, before: Flags) -> Flags:
    """The flags after SetFlags(kind, a, b)."""
    match kind:
        case FlagKind.SUB:
            return _of_difference(a, b)
        case FlagKind.ADD:
            if b.is_constant and b.constant not in (0, HALF):
                # a + b with all four flags is a - (-b): carry and overflow agree because -b does not wrap to b.
                return _of_difference(a, number(-b.constant))
            total = add(a, b)
            return Flags(Relation(Kind.EQ, total, ZERO), Relation(Kind.SLT, total, ZERO), Relation(Kind.ULT, total, a))
        case FlagKind.LOGIC:
            return Flags(Relation(Kind.EQ, a, ZERO), Relation(Kind.SLT, a, ZERO), before.c)
        case FlagKind.ADC | FlagKind.SBC if (carry := carry_term(before)) is not None:
            total = add(add(a, b), carry) if kind is FlagKind.ADC else add(subtract(subtract(a, b), number(1)), carry)
            return Flags(Relation(Kind.EQ, total, ZERO), Relation(Kind.SLT, total, ZERO))
        case FlagKind.WIDE:
            return Flags(n=Relation(Kind.SLT, b, ZERO), c=before.c)
        case _:
            return UNKNOWN


def _of_difference(a: Term, b: Term) -> Flags:
    return Flags(
        Relation(Kind.EQ, a, b),
        Relation(Kind.SLT, subtract(a, b), ZERO),
        Relation(Kind.UGE, a, b),
        (a, b),
    )


def set_carry(shift: Shift, value: Term, amount: Term, before: Flags) -> Flags:
    """The flags after SetCarry: C is the last bit shifted out."""
    carry: Relation | None = None
    count = amount.constant & 0xFF
    if shift is Shift.RRX:
        carry = _bit(value, 0)
    elif amount.is_constant and count == 0:
        carry = before.c
    elif amount.is_constant:
        match shift:
            case Shift.LSL:
                carry = _bit(value, 32 - count) if count <= 32 else _NEVER
            case Shift.LSR:
                carry = _bit(value, count - 1) if count <= 32 else _NEVER
            case Shift.ASR:
                carry = _bit(value, min(count, 32) - 1)
            case _:
                carry = _bit(value, (count - 1) % 32)
    return Flags(before.z, before.n, carry)


def _bit(value: Term, index: int) -> Relation | None:
    """The relation that holds exactly when the bit is set."""
    if index == 31:
        return Relation(Kind.SLT, value, ZERO)
    masked = compute(Op.AND, value, number(1 << index))
    return None if masked is None else Relation(Kind.NE, masked, ZERO)


def carry_term(flags: Flags) -> Term | None:
    """The carry flag as 0 or 1."""
    return None if flags.c is None else atom(Truth(flags.c))


def facts(flags: Flags, condition: Condition) -> tuple[Relation, ...]:
    """Relations that hold when `condition` does. They may say less than the condition, never more."""
    found: list[Relation | None] = []
    pair = flags.compared
    match condition:
        case Condition.EQ:
            found = [flags.z]
        case Condition.NE:
            found = [_not(flags.z)]
        case Condition.CS:
            found = [flags.c]
        case Condition.CC:
            found = [_not(flags.c)]
        case Condition.MI:
            found = [flags.n]
        case Condition.PL:
            found = [_not(flags.n)]
        case Condition.HI:
            found = [Relation(Kind.ULT, pair[1], pair[0])] if pair else [flags.c, _not(flags.z)]
        case Condition.LS if pair:
            found = [Relation(Kind.UGE, pair[1], pair[0])]
        case Condition.GE if pair:
            found = [Relation(Kind.SGE, pair[0], pair[1])]
        case Condition.LT if pair:
            found = [Relation(Kind.SLT, pair[0], pair[1])]
        case Condition.GT:
            found = [Relation(Kind.SLT, pair[1], pair[0])] if pair else [_not(flags.z)]
        case Condition.LE if pair:
            found = [Relation(Kind.SGE, pair[1], pair[0])]
    return tuple(relation for relation in found if relation is not None)


def tells_all(flags: Flags, condition: Condition) -> bool:
    """Whether `facts` say exactly what the condition and its negation say."""
    match condition:
        case Condition.AL:
            return True
        case Condition.EQ | Condition.NE:
            return flags.z is not None
        case Condition.CS | Condition.CC:
            return flags.c is not None
        case Condition.MI | Condition.PL:
            return flags.n is not None
        case Condition.VS | Condition.VC:
            return False
        case _:
            return flags.compared is not None


def _not(relation: Relation | None) -> Relation | None:
    return None if relation is None else relation.negated
