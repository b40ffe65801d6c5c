/* entry: run; inputs: seed any */
#include <stdint.h>

struct instruction {
    uint8_t op, a, b, c;
};
enum { SET, ADDR, SUBR, MULR, XORR, SHRI, BNE, MOV, END };

/* r1 counts down from 20; r2 mixes the seed. */
static const struct instruction program[] = {{SET, 1, 20, 0}, {SET, 3, 1, 0}, {MULR, 2, 2, 4},  {ADDR, 2, 2, 5},
                                             {SHRI, 6, 2, 7}, {XORR, 2, 2, 6}, {SUBR, 1, 1, 3}, {BNE, 1, 0, 2},
                                             {MOV, 0, 2, 0},  {END, 0, 0, 0}};
uint32_t seed = 99;
static uint32_t r[8];

static void op_set(const struct instruction *i) { r[i->a] = i->b; }
static void op_add(const struct instruction *i) { r[i->a] = r[i->b] + r[i->c]; }
static void op_sub(const struct instruction *i) { r[i->a] = r[i->b] - r[i->c]; }
static void op_mul(const struct instruction *i) { r[i->a] = r[i->b] * r[i->c]; }
static void op_xor(const struct instruction *i) { r[i->a] = r[i->b] ^ r[i->c]; }
static void op_shr(const struct instruction *i) { r[i->a] = r[i->b] >> i->c; }
static void op_mov(const struct instruction *i) { r[i->a] = r[i->b]; }

static void (*const handlers[])(const struct instruction *) = {op_set, op_add, op_sub, op_mul, op_xor, op_shr, 0,
                                                               op_mov};

int run(void)
{
    const struct instruction *pc = program;
    uint16_t fuel = 200;

    r[2] = seed;
    r[4] = 1103515245u;
    r[5] = 12345u;
    while (pc->op != END && fuel--) {
        if (pc->op == BNE) {
            pc = r[pc->a] != pc->b ? program + pc->c : pc + 1;
            continue;
        }
        handlers[pc->op](pc);
        pc++;
    }
    return (int)r[0];
}

int main(void)
{
    return run();
}
