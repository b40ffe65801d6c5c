"""A C program with one entry for each library function: it calls the function with what the globals hold.

Nothing is known of the globals, so nothing of the arguments, except where the entry's name says so: `_known` passes a
constant size or a constant string.
"""

from __future__ import annotations

ONE = ("sin", "cos", "tan", "sqrt", "exp", "log", "floor")
TWO = ("atan2", "pow", "fmod")
HEAD = """/* entry: call_sin; inputs: da any, db any, fa any, fb any, ia any, ib any, la any, lb any,
   text any, other any, table any, size 0..48 */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define BASE __attribute__((pcs("aapcs")))
double da = 1.25, db = -3.5, dr;
float fa = 0.75f, fb = 12.5f, fr;
int32_t ia = 1000, ib = 7, ir, count = 9;
int64_t la = 123456789012345, lb = -77, lr;
char text[64] = "abcdefgh", other[64] = "abcdefgi";
int32_t table[16] = {9, 8, 7, 6, 5, 4};
size_t size = 20;
static const char constant[] = "a constant string of the program";

static int compare(const void *a, const void *b)
{
    int32_t x = *(const int32_t *)a, y = *(const int32_t *)b;
    return (x > y) - (x < y);
}
"""
BUFFERS = {
    "memcpy": "memcpy(text, other, {n});",
    "memset": "memset(text, ia, {n});",
    "memmove": "memmove(text + 4, text, {n});",
    "memcmp": "ir = memcmp(text, other, {n});",
}
OTHERS = {
    "strlen": "text[63] = 0; ir = (int32_t)strlen(text);",
    "strlen_known": "ir = (int32_t)strlen(constant);",
    "strcmp": "text[63] = 0; ir = strcmp(text, other);",
    "strcmp_known": "ir = strcmp(constant, other);",
    "qsort": "qsort(table, size / 4, sizeof table[0], compare);",
    "qsort_known": "qsort(table, 10, sizeof table[0], compare);",
    "bsearch": "ir = bsearch(&ia, table, size / 4, sizeof table[0], compare) != 0;",
    "strcpy": "text[63] = 0; strcpy(other, text);",
    "strncpy": "strncpy(other, text, size);",
    "strncpy_known": "strncpy(other, text, 20);",
    "strchr": "text[63] = 0; ir = strchr(text, ia) != 0;",
    "memchr": "ir = memchr(text, ia, size) != 0;",
    "memchr_known": "ir = memchr(text, ia, 40) != 0;",
    "strtol": "text[63] = 0; ir = (int32_t)strtol(text, 0, 10);",
    "atoi": "text[63] = 0; ir = atoi(text);",
    "sprintf": "ir = sprintf(other, \"%d\", (int)ia);",
    "malloc": "ir = malloc(size) != 0;",
    "bsearch_known": "ir = bsearch(&ia, table, 16, sizeof table[0], compare) != 0;",
}
TYPES = {"d": "double", "f": "float", "i": "int32_t", "l": "int64_t"}
HELPERS = {
    "ii:i": "idiv uidiv",
    "ii:l": "idivmod uidivmod",
    "ll:l": "ldivmod uldivmod lmul",
    "li:l": "llsl llsr lasr",
    "ll:i": "lcmp ulcmp",
    "dd:d": "dadd dsub drsub dmul ddiv",
    "dd:i": "dcmpeq dcmplt dcmple dcmpge dcmpgt dcmpun",
    "ff:f": "fadd fsub frsub fmul fdiv",
    "ff:i": "fcmpeq fcmplt fcmple fcmpge fcmpgt fcmpun",
    "d:i": "d2iz d2uiz",
    "d:l": "d2lz d2ulz",
    "d:f": "d2f",
    "f:i": "f2iz f2uiz",
    "f:l": "f2lz f2ulz",
    "f:d": "f2d",
    "i:d": "i2d ui2d",
    "i:f": "i2f ui2f",
    "l:d": "l2d ul2d",
    "l:f": "l2f ul2f",
}
NEEDS_FACT = {
    *("memcpy", "memset", "memmove", "memcmp", "memchr", "strlen", "strcmp", "strcpy", "strncpy", "strchr", "strtol"),
    *("atoi", "sprintf", "malloc", "qsort", "bsearch"),
}
"""Entries that no analysis can bound by itself: a size, a string or the state of the heap is unknown."""
SYSTEM = """
int _write(int f, char *p, int n) { (void)f; (void)p; return n; }
int _read(int f, char *p, int n) { (void)f; (void)p; (void)n; return 0; }
int _close(int f) { (void)f; return -1; }
int _fstat(int f, void *p) { (void)f; (void)p; return -1; }
int _isatty(int f) { (void)f; return 1; }
int _lseek(int f, int o, int w) { (void)f; (void)o; (void)w; return 0; }
int _kill(int p, int s) { (void)p; (void)s; return -1; }
int _getpid(void) { return 1; }
void _exit(int s) { (void)s; for (;;) { } }
static char heap[4096];
void *_sbrk(int n) { static int used; char *at = heap + used; used += n; return used <= 4096 ? at : (void *)-1; }
"""
"""What newlib asks of the system, for the functions that print or allocate."""


def bodies() -> dict[str, str]:
    """The statement of every entry, by the name of the function it calls."""
    found = {name: f"dr = {name}(da);" for name in ONE} | {name: f"dr = {name}(da, db);" for name in TWO}
    found |= {f"{name}f": f"fr = {name}f(fa);" for name in ONE} | {f"{name}f": f"fr = {name}f(fa, fb);" for name in TWO}
    found |= {name: text.format(n="size") for name, text in BUFFERS.items()}
    found |= {f"{name}_known": text.format(n="37") for name, text in BUFFERS.items()}
    found |= OTHERS
    for key, names in HELPERS.items():
        takes, _, gives = key.partition(":")
        arguments = ", ".join(f"{kind}{'ab'[place]}" for place, kind in enumerate(takes))
        found |= {f"__aeabi_{name}": f"{gives}r = __aeabi_{name}({arguments});" for name in names.split()}
    return found


def source(without: set[str]) -> str:
    """The program, without the functions that a toolchain lacks."""
    lines = [HEAD, SYSTEM]
    for key, names in HELPERS.items():
        takes, _, gives = key.partition(":")
        arguments = ", ".join(TYPES[kind] for kind in takes)
        lines += [f"BASE {TYPES[gives]} __aeabi_{name}({arguments});" for name in names.split()]
    entries = {name: body for name, body in bodies().items() if name not in without}
    lines += [f"void call_{name}(void)\n{{\n    {body}\n}}" for name, body in entries.items()]
    calls = "\n".join(f"    call_{name}();" for name in entries)
    lines += [f"int main(void)\n{{\n{calls}\n    return (int)(count + lr + ir);\n}}"]
    return "\n".join(lines) + "\n"
