"""Values as linear expressions: a constant plus multiples of symbols, modulo 2**32.

A value is an int, or a tuple (constant, symbol, factor, symbol, factor, ...) with ascending symbols and non-zero
factors, so that equal values are equal objects and sums, differences and multiples are exact. A symbol names an
unknown number of one state; the symbols of the registers at the function's entry keep their meaning everywhere in
the function.
"""

from __future__ import annotations

from mauve.wcet.flow.domain import MASK, SIGN

Value = int | tuple[int, ...]

FRAME = 14
"""The symbol of sp at the entry of the function."""
FPU = 24
"""No value's symbol: the region of memory that stands for the FPU's registers, s0 at offset 0."""
FIRST_FRESH = 32
MOST_TERMS = 4
"""Sums of more symbols are replaced by a fresh one."""


def entry_symbol(register: int) -> int:
    """The symbol of a register's value at the function's entry."""
    return register + 1


def is_entry_symbol(symbol: int) -> bool:
    """Whether the symbol means the same in every state of the function."""
    return symbol < FIRST_FRESH


def of_symbol(symbol: int) -> Value:
    """The symbol itself."""
    return (0, symbol, 1)


def add(a: Value, b: Value) -> Value:
    """The sum."""
    if type(b) is int:
        if type(a) is int:
            return (a + b) & MASK
        assert type(a) is tuple
        return ((a[0] + b) & MASK, *a[1:]) if b else a
    assert type(b) is tuple
    if type(a) is int:
        return ((a + b[0]) & MASK, *b[1:]) if a else b
    assert type(a) is tuple
    return _merge(a, b, 1)


def sub(a: Value, b: Value) -> Value:
    """The difference."""
    if type(b) is int:
        return add(a, -b & MASK)
    assert type(b) is tuple
    if a == b:
        return 0
    if type(a) is int:
        return _merge((a,), b, -1)
    assert type(a) is tuple
    return _merge(a, b, -1)


def _merge(a: tuple[int, ...], b: tuple[int, ...], factor: int) -> Value:
    """a + factor * b."""
    result = [(a[0] + factor * b[0]) & MASK]
    i, j, end, other_end = 1, 1, len(a), len(b)
    while j < other_end:
        symbol, times = b[j], factor * b[j + 1]
        while i < end and a[i] < symbol:
            result += a[i : i + 2]
            i += 2
        if i < end and a[i] == symbol:
            times += a[i + 1]
            i += 2
        times &= MASK
        if times:
            result += (symbol, times - MASK - 1 if times & SIGN else times)
        j += 2
    result += a[i:]
    return result[0] if len(result) == 1 else tuple(result)


def scale(a: Value, factor: int) -> Value:
    """A multiple by an integer."""
    if type(a) is int:
        return a * factor & MASK
    assert type(a) is tuple
    if factor == 1:
        return a
    return _merge((0,), a, factor)


def divide(a: Value, divisor: int) -> Value | None:
    """The expression q with divisor * q == a term by term, or None (divisor > 0; the constant is read as signed)."""
    if type(a) is int:
        number = a - MASK - 1 if a & SIGN else a
        return None if number % divisor else (number // divisor) & MASK
    assert type(a) is tuple
    number = a[0] - MASK - 1 if a[0] & SIGN else a[0]
    if number % divisor or any(factor % divisor for factor in a[2::2]):
        return None
    result = [(number // divisor) & MASK]
    for symbol, factor in zip(a[1::2], a[2::2], strict=True):
        result += (symbol, factor // divisor)
    return tuple(result)


def factor_of(a: Value, symbol: int) -> int:
    """How often the symbol stands in the expression."""
    if type(a) is int:
        return 0
    assert type(a) is tuple
    if len(a) == 3:
        return a[2] if a[1] == symbol else 0
    for i in range(1, len(a), 2):
        if a[i] == symbol:
            return a[i + 1]
    return 0


def symbols(a: Value) -> tuple[int, ...]:
    """The symbols of the expression."""
    return () if type(a) is int else a[1::2]  # type: ignore[index]


def substitute(a: Value, symbol: int, replacement: Value) -> Value:
    """The expression with a symbol replaced."""
    factor = factor_of(a, symbol)
    if not factor:
        return a
    return add(add(a, scale(of_symbol(symbol), -factor)), scale(replacement, factor))
