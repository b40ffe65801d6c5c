# ruff: noqa: E501 - lines of C are not cut
"""Random C programs whose every loop ends: sources for tests that compare bounds with executions.

A program is a few functions of one seed. Loops are counted, clamped from arguments, shifting, bisecting, walking
pointers; and there are hostile ones, whose condition, counter and limit change in arbitrary ways (through memory,
through pointers, by wrapping around), ended by a guard of their own at the latest. Arithmetic wraps (`-fwrapv`),
divisors are never zero, indices are masked: every execution is defined.

    source = generate(7)      # source.text is C, source.functions says what each function takes
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from random import Random

WORDS = 32
"""Words behind a pointer argument."""
INTEGERS = ("int32_t", "uint32_t", "int16_t", "uint16_t", "int8_t", "uint8_t")
LARGEST = 1_500
"""About how many times the innermost body of a function runs at most."""

SMALL = 300

HEADER = """#include <stdint.h>
#include <string.h>
typedef struct { int32_t n; uint8_t small; int16_t half; int32_t data[6]; } record;
typedef struct { record head, tail; uint32_t count; } pair;
extern volatile uint32_t port;
volatile uint32_t port;
int32_t g_words[32];
uint8_t g_bytes[64];
int32_t g_limit = 9;
uint8_t g_small = 5;
record g_record;
pair g_pair;
static const int32_t c_words[16] = {3, 1, 4, 1, 5, 9, 2, 6, 5, 3, 5, 8, 9, 7, 9, 3};
static const uint8_t c_bytes[8] = {7, 2, 12, 1, 0, 9, 255, 4};
static int32_t leaf_add(int32_t a, int32_t b) { return a + b; }
static int32_t leaf_loop(int32_t a, int32_t b) { int32_t s = 0; for (int32_t i = 0; i < (b & 7); i++) s += a >> i; return s; }
static int32_t leaf_mix(int32_t a, int32_t b) { return a > b ? a ^ b : b - a; }
static int32_t (*const c_table[4])(int32_t, int32_t) = {leaf_add, leaf_loop, leaf_mix, leaf_add};
__attribute__((noinline)) void set_word(int32_t *at, int32_t value) { *at = value; }
__attribute__((noinline)) int32_t sum_to(const int32_t *at, int32_t n) { int32_t s = 0; while (n-- > 0) s += *at++; return s; }
__attribute__((noinline)) void fill(uint8_t *at, uint32_t n, uint8_t v) { for (uint32_t i = 0; i < n; i++) at[i] = v; }
void _start(void) {}
"""


@dataclass(frozen=True, slots=True)
class Function:
    """A generated function: its name and the C types of its parameters (`p` suffix: a pointer to 32 words)."""

    name: str
    parameters: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Source:
    """A program as text, and the functions to analyse."""

    text: str
    functions: tuple[Function, ...]


@dataclass(slots=True)
class _Scope:
    """What the code at one place may use. `values` can be read, `assignable` also written; `room` is how many
    iterations loops here may still take; `depth` counts statements around."""

    values: list[str]
    assignable: list[str]
    words: list[str]
    room: int
    depth: int = 0
    in_loop: bool = False

    def inner(self, times: int = 1, **more: list[str]) -> _Scope:
        return _Scope(
            self.values + more.get("values", []),
            list(self.assignable),
            self.words + more.get("words", []),
            self.room // max(times, 1),
            self.depth + 1,
            self.in_loop or times > 1,
        )


@dataclass(slots=True)
class _Writer:
    random: Random
    callees: list[tuple[Function, str]] = field(default_factory=list)
    names: int = 0
    floats: bool = False

    # ----------------------------------------------------------------------------------------------- expressions
    def fresh(self) -> str:
        self.names += 1
        return f"v{self.names}"

    def constant(self) -> str:
        r = self.random
        value = r.choice([r.randint(0, 9), r.randint(-20, 60), r.getrandbits(8), r.getrandbits(16), r.getrandbits(31)])
        return r.choice([f"{value}", f"{value}", f"{abs(value)}u"])

    def atom(self, s: _Scope) -> str:
        r = self.random
        kind = r.randrange(12)
        if kind < 6 and s.values:
            return r.choice(s.values)
        if kind == 6:
            return f"{r.choice(s.words)}[{self.index(s)}]"
        if kind == 7:
            return r.choice(
                [f"c_words[{self.index(s)} & 15]", f"c_bytes[({r.choice(s.values)}) & 7]", "g_limit", "g_small",
                 "g_record.half", "g_record.n", "g_pair.tail.n", f"g_bytes[{self.index(s)}]", "port"]
            )  # fmt: skip
        return self.constant()

    def index(self, s: _Scope) -> str:
        return f"(({self.random.choice(s.values)}) & 31)" if self.random.random() < 0.8 else str(self.random.randrange(32))

    def expression(self, s: _Scope, depth: int = 2) -> str:
        r = self.random
        if depth == 0 or r.random() < 0.25:
            return self.atom(s)
        a, b = self.expression(s, depth - 1), self.expression(s, depth - 1)
        kind = r.randrange(22)
        if kind < 9:
            return f"({a} {r.choice('+-+-*&|^')} {b})"
        match kind:
            case 9 | 10:
                return f"({a} {r.choice(['<<', '>>'])} ({b} & {r.choice([3, 7, 15, 31])}))"
            case 11:
                return f"((uint32_t)({a}) {r.choice('/%')} ((uint32_t)({b}) | 1u))"
            case 12:
                return f"((int32_t)({a}) {r.choice('/%')} {r.choice([3, 7, 10, 16, 100])})"
            case 13:
                return f"({self.condition(s)} ? {a} : {b})"
            case 14 | 15:
                return f"({r.choice(INTEGERS)})({a})"
            case 16:
                return f"(int32_t)(((int64_t)({a}) * ({b})) >> {r.choice([4, 16, 32])})"
            case 17:
                return f"({r.choice('-~')}({a}))"
            case 18 if self.floats:
                return f"(int32_t)({r.choice(['float', 'double'])})((int16_t)({a}) * 0.5f)"
            case 19 if s.room > 20 and s.depth < 3:
                return f"c_table[({a}) & 3]((int32_t)({b}), (int32_t)({a}))"
            case 20:
                return f"(uint32_t)(((uint64_t)({a}) + ((uint64_t)({b}) << 20)) >> {r.choice([8, 31])})"
        return f"({a} + {b})"

    def condition(self, s: _Scope) -> str:
        r = self.random
        a = self.expression(s, 1)
        if r.random() < 0.2:
            return f"(({a}) & {1 << r.randrange(8)})"
        if r.random() < 0.15:
            b = r.choice(["&&", "||"])
            return f"({a} {r.choice(['<', '>', '=='])} {self.atom(s)} {b} {self.atom(s)} {r.choice(['<', '!='])} {self.atom(s)})"
        return f"({a} {r.choice(['<', '<=', '>', '>=', '==', '!='])} {self.expression(s, 1)})"

    # ------------------------------------------------------------------------------------------------ statements
    def block(self, s: _Scope, statements: int) -> str:
        return " ".join(self.statement(s) for _ in range(statements))

    def statement(self, s: _Scope) -> str:
        r = self.random
        kind = r.randrange(20)
        if kind < 7 and s.depth < 5 and s.room >= 4:
            return r.choice(LOOPS)(self, s)
        if kind < 10 and s.depth < 5:
            text = f"if ({self.condition(s)}) {{ {self.block(s.inner(), r.randint(1, 2))} }}"
            return text + (f" else {{ {self.block(s.inner(), 1)} }}" if r.random() < 0.4 else "")
        if kind == 10 and s.depth < 4:
            return self.switch(s)
        if kind == 11 and self.callees:
            return self.call(s)
        if kind == 12:
            return self.bulk(s)
        if kind == 13 and s.in_loop and r.random() < 0.5:
            return f"if ({self.condition(s)}) {r.choice(['break', 'break', 'return acc'])};"
        if kind == 14:
            return f"{r.choice(['g_limit', 'g_small', 'g_record.n', 'g_record.half', 'port', 'g_pair.head.n'])} = {self.expression(s)};"
        if kind <= 16:
            target = r.choice([*s.words, "g_words", "g_bytes"])
            return f"{target}[{self.index(s)}] {r.choice(['=', '+=', '^='])} {self.expression(s)};"
        if s.assignable and r.random() < 0.5:
            return f"{r.choice(s.assignable)} {r.choice(['=', '+=', '^=', '-='])} {self.expression(s)};"
        return f"acc {r.choice(['+=', '^=', '-='])} {self.expression(s)};"

    def switch(self, s: _Scope) -> str:
        r = self.random
        count = r.choice([3, 5, 9, 14])
        step = r.choice([1, 1, 1, 7, 1000])
        cases = [
            f"case {i * step}: {self.statement(s.inner()) if r.random() < 0.3 else f'acc += {self.atom(s)};'}"
            f" {'break;' if r.random() < 0.8 else ''}"
            for i in range(count)
        ]
        return f"switch ({self.expression(s, 1)} & {r.choice([7, 15, 0xFFFF])}) {{ {' '.join(cases)} default: acc++; }}"

    def call(self, s: _Scope) -> str:
        function, cost = self.random.choice(self.callees)
        if int(cost) > s.room or s.room < 30:
            return "acc++;"
        arguments = [self.random.choice(s.words) if t.endswith("p") else self.expression(s, 1) for t in function.parameters]
        s.room -= int(cost)
        return f"acc += {function.name}({', '.join(arguments)});"

    def bulk(self, s: _Scope) -> str:
        r, n = self.random, self.random.randint(1, 16)
        a, b = r.choice(s.words), r.choice(s.words)
        return r.choice([
            f"memcpy(g_words, {a}, {4 * n});",
            f"memset({a}, {r.randrange(256)}, {n * 3});",
            f"memmove({a}, {b} + 3, ({self.index(s)}));",
            f"fill(g_bytes, {self.index(s)}, {self.atom(s)});",
            f"acc += sum_to({a}, {self.index(s)});",
            f"acc += sum_to({a}, {n});",
            "g_pair.head = g_record; g_record = g_pair.tail;",
            f"{{ record copy = g_record; copy.data[({self.index(s)}) % 6u] = {self.atom(s)}; g_pair.tail = copy; }}",
        ])  # fmt: skip

    def body(self, s: _Scope, times: int, *values: str, words: tuple[str, ...] = ()) -> str:
        inner = s.inner(times, values=list(values), words=list(words))
        return self.block(inner, self.random.choice([1, 1, 2, 3]))

    def times(self, s: _Scope, most: int = 40) -> int:
        return self.random.randint(1, max(2, min(most, s.room)))


def _up(w: _Writer, s: _Scope) -> str:
    i, n, step = w.fresh(), w.times(s), w.random.choice([1, 1, 1, 2, 3, 7])
    t, start = w.random.choice(INTEGERS), w.random.choice([0, 0, 1, 5])
    compare = w.random.choice(["<", "<=", "!="]) if step == 1 else "<"
    return f"for ({t} {i} = {start}; {i} {compare} {start + n}; {i} += {step}) {{ {w.body(s, n + 1, i)} }}"


def _down(w: _Writer, s: _Scope) -> str:
    i, n = w.fresh(), w.times(s)
    t, signed = w.random.choice(INTEGERS), w.random.choice(["int32_t", "int16_t", "int8_t", "int"])
    body = w.body(s, n + 1, i)
    return w.random.choice([
        f"for ({t} {i} = {n}; {i} > 0; {i}--) {{ {body} }}",
        f"for ({t} {i} = {n}; {i} != 0; {i}--) {{ {body} }}",
        f"for ({signed} {i} = {n}; {i} >= 0; {i}--) {{ {body} }}",
        f"{{ {t} {i} = {n}; while ({i}--) {{ {body} }} }}",
        f"{{ {t} {i} = {n}; do {{ {body} }} while (--{i}); }}",
        f"for ({signed} {i} = {3 * n}; {i} > 0; {i} -= 3) {{ {body} }}",
    ])  # fmt: skip


def limit(w: _Writer, s: _Scope, n: int) -> tuple[str, str]:
    """Statements and the name of a value that is at most `n`, computed from anything."""
    name, e, r = w.fresh(), w.expression(s), w.random
    t = r.choice(INTEGERS)
    low = r.randint(0, 3)
    mask = (1 << n.bit_length()) - 1 >> 1
    return r.choice([
        f"int32_t {name} = {e}; if ({name} > {n}) {name} = {n};",
        f"uint32_t {name} = {e}; if ({name} > {n}) {name} = {n};",
        f"{t} {name} = ({e}) & {mask};",
        f"{t} {name} = (uint32_t)({e}) % {n + 1}u;",
        f"int32_t {name} = {e}; if ({name} < {low}) {name} = {low}; else if ({name} > {max(n, low)}) {name} = {n};",
        f"int32_t {name} = {w.condition(s)} ? {n} : {low};",
        f"uint32_t {name} = (uint32_t)({e}) >> {32 - mask.bit_length()};" if mask else f"uint32_t {name} = {n};",
        f"int32_t {name} = c_words[({e}) & 15] * {n} / 10;",
        f"int32_t {name} = {e}; if ({name} < 0 || {name} > {n}) return acc;",
        f"int32_t {name}; switch (({e}) & 3) {{ case 0: {name} = 1; break; case 1: {name} = {n}; break; default: {name} = {low}; }}",
    ]), name  # fmt: skip


def _clamped(w: _Writer, s: _Scope) -> str:
    i, n = w.fresh(), w.times(s)
    before, name = limit(w, s, n)
    body = w.body(s, n + 1, i, name)
    loop = w.random.choice([
        f"for (int32_t {i} = 0; {i} < (int32_t){name}; {i}++) {{ {body} }}",
        f"for (int32_t {i} = (int32_t){name}; {i} > 0; {i}--) {{ {body} }}",
        f"for (int32_t {i} = (int32_t){name} - 1; {i} >= 0; {i} -= 2) {{ {body} }}",
        f"for (int32_t {i} = -3; {i} <= (int32_t){name}; {i} += 2) {{ {body} }}",
    ])  # fmt: skip
    return f"{{ {before} {loop} }}"


def _triangular(w: _Writer, s: _Scope) -> str:
    i, j, n = w.fresh(), w.fresh(), w.times(s, 12)
    t = w.random.choice(INTEGERS[:4])
    inner = w.random.choice([
        f"for ({t} {j} = 0; {j} < {i}; {j}++)",
        f"for ({t} {j} = {i}; {j} < {n}; {j}++)",
        f"for ({t} {j} = 0; {j} <= {i}; {j}++)",
        f"for ({t} {j} = {n} - {i}; {j} > 0; {j}--)",
        f"for ({t} {j} = {i} + 1; {j} <= {n}; {j} += 2)",
        f"for (int32_t {j} = {i} * 2; {j} >= (int32_t){i}; {j}--)",
    ])  # fmt: skip
    body = w.body(s, (n + 1) * (n + 2), i, j)
    return f"for ({t} {i} = 0; {i} < {n}; {i}++) {{ {inner} {{ {body} }} acc += {i}; }}"


def _bits(w: _Writer, s: _Scope) -> str:
    x, e, n = w.fresh(), w.expression(s), 33
    if s.room < n:
        return _up(w, s)
    t = w.random.choice(["uint32_t", "uint32_t", "uint16_t", "uint8_t", "uint64_t"])
    body = w.body(s, n if t != "uint64_t" else 65, x)
    return f"{{ {t} {x} = {e}; " + w.random.choice([
        f"while ({x}) {{ {body} {x} >>= {w.random.choice([1, 1, 2, 3])}; }} }}",
        f"while ({x}) {{ {body} {x} &= {x} - 1; }} }}",
        f"while ({x} > 9) {{ {body} {x} /= {w.random.choice([2, 3, 10])}; }} }}",
        f"do {{ {body} {x} <<= 1; }} while ({x}); }}",
        f"while ({x} != 0) {{ {body} {x} = {x} / 2; }} }}",
    ])  # fmt: skip


def _bisect(w: _Writer, s: _Scope) -> str:
    low, high, mid, n = w.fresh(), w.fresh(), w.fresh(), w.random.choice([16, 31, 32])
    a = w.random.choice(s.words)
    t = w.random.choice(["int32_t", "uint32_t"])
    return (
        f"{{ {t} {low} = 0, {high} = {n}; int32_t {mid}k = {w.expression(s, 1)}; while ({low} < {high}) {{ {t} {mid} ="
        f" ({low} + {high}) / 2; if ({a}[{mid}] < {mid}k) {low} = {mid} + 1; else {high} = {mid}; }} acc += {low}; }}"
    )


def _two(w: _Writer, s: _Scope) -> str:
    i, j, n = w.fresh(), w.fresh(), w.times(s, 30)
    body = w.body(s, n + 1, i, j)
    return (
        f"{{ int32_t {i} = 0, {j} = {n}; while ({i} < {j}) {{ {body} if ({w.condition(s)}) {i}++; else {j}--; }} }}"
    )


def _step(w: _Writer, s: _Scope) -> str:
    i, n = w.fresh(), w.times(s, 30)
    e, body = w.expression(s, 1), w.body(s, n + 1, i)
    return w.random.choice([
        f"for (int32_t {i} = 0; {i} < {n}; {i} += 1 + (({e}) & 3)) {{ {body} }}",
        f"for (uint32_t {i} = 1; {i} < {1 << min(n, 20)}; {i} *= 2) {{ {body} }}",
        f"for (uint32_t {i} = 1; {i} < {3 ** min(n, 12)}; {i} = {i} * 3 + 1) {{ {body} }}",
        f"for (uint8_t {i} = 250; {i} != {n % 200}; {i}++) acc += {i};",
        f"for (int32_t {i} = 2147483640; {i} > 0; {i}++) acc ^= {i};",
        f"for (uint32_t {i} = {n}; {i} < {n + 1}; {i}--) {{ {body} }}",
    ])  # fmt: skip


def _pointer(w: _Writer, s: _Scope) -> str:
    p, n = w.fresh(), w.times(s, 31)
    a = w.random.choice(s.words)
    body = w.body(s, n + 1, f"(*{p})")
    return w.random.choice([
        f"for (int32_t *{p} = {a}; {p} < {a} + {n}; {p}++) {{ {body} }}",
        f"for (int32_t *{p} = {a}; {p} != {a} + {n}; {p}++) {{ {body} }}",
        f"for (int32_t *{p} = {a} + {n}; {p} > {a}; {p}--) {{ acc += {p}[-1]; }}",
        f"for (uint8_t *{p} = (uint8_t *){a}; {p} < (uint8_t *)({a} + {n}); {p} += 4) {{ {body} }}",
        f"for (const int32_t *{p} = {a}, *{p}e = {a} + {n}; {p} != {p}e && *{p}; {p}++) {{ {body} }}",
        f"{{ int32_t *{p} = {a}, *{p}o = g_words; int {p}n = {n}; while ({p}n-- > 0) *{p}o++ = *{p}++ + {p}n; }}",
    ])  # fmt: skip


def _hostile(w: _Writer, s: _Scope) -> str:
    """A loop of which the guard is the only sure thing: limit and counter are memory that other stores may reach."""
    r, i, guard, n = w.random, w.fresh(), w.fresh(), w.times(s, 45)
    t = r.choice(INTEGERS)
    inner = s.inner(n + 1, values=[i])
    inner.assignable = [*inner.assignable, i]
    place = r.choice(["g_limit", "g_small", "g_record.n", "g_record.half", "g_pair.tail.n", f"{i}m", f"{i}r.n", f"{i}r.small"])
    compare = r.choice(["<", "<=", "!=", ">", ">="])
    bump = r.choice([f"{i}++", f"{i} += 3", f"{i}--", f"{i} = {i} * 2 + 1", f"{i} += ({w.expression(s, 1)})", f"{i} >>= 1"])
    change = r.choice([
        "", "", f"set_word(&{i}m, {w.expression(inner, 1)});", f"if ({w.condition(inner)}) {place} {r.choice(['+=', '-=', '='])} {w.atom(inner)};",
        f"{r.choice(s.words)}[{w.index(inner)}] = {w.atom(inner)};", f"{i}r = g_record;", f"memset(&{i}r, {r.randrange(9)}, sizeof {i}r);",
        f"*(({i}m & 1) ? &{i}m : &{i}r.n) = {w.atom(inner)};", f"{i}q = ({w.condition(inner)}) ? &{i}m : {r.choice(s.words)}; *{i}q = {w.atom(inner)};",
    ])  # fmt: skip
    start = r.choice([w.constant(), w.constant(), w.expression(s, 1)])
    until = r.choice([w.constant(), w.constant(), w.expression(s, 1)])
    setup = f"int32_t {i}m = {w.constant()}; record {i}r = g_record; {i}r.n = {w.constant()}; int32_t *{i}q = &{i}m; (void){i}q;"
    body = w.block(inner, r.choice([0, 1, 1, 2]))
    keep = f"uint32_t {guard} = 0;"
    guarded = f"{guard}++ < {n}"
    return f"{{ {setup} {place} = {until}; {t} {i} = {start}; {keep} " + r.choice([
        f"while ({i} {compare} {place} && {guarded}) {{ {body} {change} {bump}; }}",
        f"do {{ {body} {bump}; {change} }} while ({i} {compare} {place} && {guarded});",
        f"while ({guarded}) {{ if (!({i} {compare} {place})) break; {body} {change} {bump}; }}",
        f"while ({i} {compare} {place} && {guarded}) {{ {body} {change} if ({w.condition(inner)}) {bump}; }}",
        f"for (; {i} {compare} {place}; {bump}) {{ if (!({guarded})) break; {change} {body} }}",
    ]) + " }"  # fmt: skip


LOOPS: list[Callable[[_Writer, _Scope], str]] = [
    _up, _up, _down, _clamped, _clamped, _triangular, _bits, _bisect, _two, _step, _pointer, _hostile, _hostile, _hostile,
]  # fmt: skip


def _function(w: _Writer, name: str, small: bool) -> tuple[Function, str]:
    r = w.random
    parameters = tuple(r.choice([*INTEGERS[:2], *INTEGERS[:2], *INTEGERS, "int32_tp"]) for _ in range(r.randint(1, 5)))
    written = ", ".join(f"int32_t *a{k}" if t.endswith("p") else f"{t} a{k}" for k, t in enumerate(parameters))
    pointers = [f"a{k}" for k, t in enumerate(parameters) if t.endswith("p")]
    values = [f"a{k}" for k, t in enumerate(parameters) if not t.endswith("p")] + ["acc", "x", "y"]
    scope = _Scope(values, ["x", "y", "acc"], [*pointers, "g_words", "local"], SMALL if small else LARGEST)
    scope.depth = 3 if small else 0
    body = r.choice(LOOPS)(w, scope) if small else w.block(scope, r.randint(1, 4))
    types = [r.choice(INTEGERS) for _ in range(2)]
    local = "int32_t local[32]; for (int k = 0; k < 32; k++) local[k] = k;"
    if small:
        local = "int32_t local[32]; __asm__ volatile(\"\" : \"=m\"(local));"
    head = f"__attribute__((noinline)) int32_t {name}({written})"
    start = f"int32_t acc = 0; {types[0]} x = {w.constant()}; {types[1]} y = {r.choice(values[:-3] or ['3'])}; {local}"
    return Function(name, parameters), f"{head} {{\n  {start}\n  {body}\n  return acc + x - y + local[acc & 31];\n}}\n"


def generate(seed: int, functions: int = 4, small: bool = False) -> Source:
    """The program of a seed. `small`: each function is one loop, perhaps with another in it, and calls nothing."""
    writer = _Writer(Random(seed))
    writer.floats = writer.random.random() < 0.2
    texts, made = [HEADER], []
    for number in range(functions):
        function, text = _function(writer, f"f{number}", small)
        made.append(function)
        texts.append(text)
        if not small:
            writer.callees = [*writer.callees, (function, "1000")]
    return Source("\n".join(texts), tuple(made))


if __name__ == "__main__":
    import sys

    print(generate(int(sys.argv[1])).text)
