"""Random C functions whose branches test the same few variables again and again, with everything in between that may
change them: assignments, stores through pointers, calls, loops."""

from __future__ import annotations

from random import Random

HEAD = """
typedef struct { int mode; int other; unsigned char small; } Part;
volatile int out; int g0, g1; unsigned char g2; signed char g3; int array[8]; Part part;
__attribute__((noipa)) void nothing(int x) { out = x; }
__attribute__((noipa)) void change(int x) { g0 = x & 3; }
__attribute__((noipa)) void through(int *p, int x) { *p = x & 3; }
__attribute__((noipa)) int reads(void) { return g0 + g1; }
"""
VARIABLES = ("a", "b", "c", "x", "y", "small", "flag", "g0", "g1", "g2", "g3", "p->mode", "p->other", "p->small")
WRITTEN = (*VARIABLES, "part.mode", "array[a & 7]", "array[2]", "*q", "kept[b & 1]")
READ = (*VARIABLES, "part.mode", "array[2]", "*q", "kept[0]")


class Modes:
    """One function at a time, from a seed."""

    def __init__(self, seed: int) -> None:
        self.random = Random(seed)
        self.marks = 0
        self.loops = 0

    def function(self, name: str) -> str:
        """A function of three integers and a pointer to a `Part`."""
        body = self.block(3, False)
        target = self.random.choice(("&y", "&g1", "&array[1]"))
        return (
            f"int {name}(int a, int b, int c, Part *p) {{ int x = a, y = 0, i, j, k, l; unsigned char small = b;\n"
            f" signed char flag = 0; int kept[2] = {{b, c}}; int *q = {target};\n"
            f" (void)small; (void)q; (void)kept;\n{body} return x + y + flag; }}\n"
        )

    def block(self, depth: int, loop: bool) -> str:
        return "".join(self.statement(depth, loop) for _ in range(self.random.randint(2, 5)))

    def statement(self, depth: int, loop: bool) -> str:
        kinds = ["if"] * 8 + ["set", "set", "flag", "work", "work", "call", "switch", "switch", "loop"]
        kinds += ["leave"] * loop
        kind = self.random.choice(kinds if depth else ["set", "work", "work", "flag"])
        match kind:
            case "if":
                rest = f" else {{ {self.block(depth - 1, loop)} }}" if self.random.random() < 0.4 else ""
                return f"if ({self.condition()}) {{ {self.work()} {self.block(depth - 1, loop)} }}{rest}\n"
            case "switch":
                cases = "".join(
                    f"case {value}: {self.work()} {self.statement(0, False)} break; "
                    for value in range(self.random.randint(2, 7))
                )
                return f"switch ({self.random.choice(READ)}) {{ {cases} default: {self.work()} }}\n"
            case "loop":
                counter = "ijkl"[depth]
                times = self.random.randint(1, 4)
                return f"for ({counter} = 0; {counter} < {times}; {counter}++) {{ {self.block(depth - 1, True)} }}\n"
            case "set":
                value = self.random.choice((str(self.random.randrange(5)), self.random.choice(READ), "a & 3", "b + 1"))
                return f"{self.random.choice(WRITTEN)} = {value};\n"
            case "flag":
                return f"flag = {self.condition()};\n"
            case "call":
                return self.random.choice(("nothing(a);", "change(b);", "through(&y, c);", "x += reads();")) + "\n"
            case "leave":
                jump = self.random.choice(("break", "continue", "return x"))
                return f"if ({self.condition()}) {jump};\n"
            case _:
                return self.work() + "\n"

    def work(self) -> str:
        """Code that a compiler neither removes nor copies."""
        self.marks += 1
        return " ".join(f"out = {self.marks + n};" for n in range(self.random.randint(1, 9)))

    def condition(self) -> str:
        one, other = self.random.choice(READ), self.random.choice(READ)
        number = self.random.randrange(5)
        sign = self.random.choice(("==", "==", "!=", "<", ">", "<=", ">="))
        match self.random.randrange(8):
            case 0:
                return f"{one} {sign} {other}"
            case 1:
                return f"{one} & {1 << self.random.randrange(3)}"
            case 2:
                return f"{one} {sign} {number} {self.random.choice(('&&', '||'))} {other} != {number}"
            case 3:
                return f"(unsigned){one} {sign} {number}u"
            case 4:
                return one
            case _:
                return f"{one} {sign} {number}"


def source(seed: int, functions: int) -> str:
    """A program with the functions f0, f1, ..."""
    made = Modes(seed)
    return HEAD + "".join(made.function(f"f{number}") for number in range(functions)) + "void _start(void) {}\n"
