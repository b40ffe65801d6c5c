/* entry: run; inputs: seed 1..30 */
#include <stdint.h>

/* Threaded code: a program is an array of pointers to primitives and of cells; calls inside it use a return stack. */
typedef union cell {
    void (*primitive)(void);
    const union cell *address;
    int32_t number;
} cell_t;

int32_t seed = 9;
static int32_t stack[16], *sp;
static const cell_t *ip, *returns[8], **rp;
static uint8_t running;

static void literal(void) { *sp++ = ip++->number; }
static void dup(void) { sp[0] = sp[-1], sp++; }
static void drop(void) { sp--; }
static void swap(void)
{
    int32_t t = sp[-1];
    sp[-1] = sp[-2];
    sp[-2] = t;
}
static void over(void) { sp[0] = sp[-2], sp++; }
static void add(void) { sp--, sp[-1] += sp[0]; }
static void subtract(void) { sp--, sp[-1] -= sp[0]; }
static void multiply(void) { sp--, sp[-1] = (int32_t)((uint32_t)sp[-1] * (uint32_t)sp[0]); }
static void branch_if_not(void) { ip = *--sp ? ip + 1 : ip + ip->number; }
static void branch(void) { ip += ip->number; }
static void call(void) { *rp++ = ip + 1, ip = ip->address; }
static void leave(void) { ip = *--rp; }
static void halt(void) { running = 0; }

static const cell_t square[] = {{dup}, {multiply}, {leave}};
/* ( n -- sum of squares below n, mixed ) */
static const cell_t program[] = {
    {literal}, {.number = 0}, {swap}, {dup}, {branch_if_not}, {.number = 11}, {literal}, {.number = 1}, {subtract},
    {dup}, {call}, {.address = square}, {over}, {drop}, {branch}, {.number = 4}, {halt}, {halt},
    {drop}, {swap}, {add}, {literal}, {.number = 0}, {swap}, {drop}, {halt}};

int run(void)
{
    uint16_t steps = 0;

    sp = stack;
    rp = returns;
    *sp++ = seed;
    ip = program;
    running = 1;
    while (running && steps < 500 && sp < stack + 15 && sp >= stack) {
        ip++->primitive();
        steps++;
    }
    return steps;
}

int main(void)
{
    return run();
}
