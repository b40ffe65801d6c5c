/* entry: run; inputs: code each 1B 0..7, size 1..32 */
#include <stdint.h>
uint8_t code[32] = {1, 2, 3, 4, 5, 6, 1, 0};
uint8_t size = 8;
static int32_t stack[34];
int run(void)
{
    static const void *const labels[] = {&&halt, &&push, &&add, &&dup, &&neg, &&swap, &&drop, &&dec};
    const uint8_t *pc = code, *end = code + size;
    int32_t *sp = stack + 2;
#define NEXT do { if (pc == end || sp > stack + 32 || sp < stack + 2) goto halt; goto *labels[*pc++]; } while (0)
    NEXT;
push: *sp++ = pc[-1] * 3; NEXT;
add: sp[-2] += sp[-1]; sp--; NEXT;
dup: sp[0] = sp[-1]; sp++; NEXT;
neg: sp[-1] = -sp[-1]; NEXT;
swap: { int32_t t = sp[-1]; sp[-1] = sp[-2]; sp[-2] = t; } NEXT;
drop: sp--; NEXT;
dec: for (int i = 0; i < 3; i++) sp[-1] -= i; NEXT;
halt: return sp[-1];
}
int main(void) { return run(); }
