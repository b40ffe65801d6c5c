/* entry: run; inputs: kinds each 1B 0..5, count 0..24 */
#include <stdint.h>
uint8_t kinds[24] = {0, 1, 2, 3, 4, 5, 3, 1};
uint8_t count = 8;
static int state = 5;
static int on_a(int x) { return x + state; }
static int on_b(int x) { for (int i = 0; i < 5; i++) x ^= x << i; return x; }
static int on_c(int x) { state++; return x - 3; }
static int on_d(int x) { while (x & 0xff) x >>= 1; return x; }
static int (*const handlers[4])(int) = {on_a, on_b, on_c, on_d};
__attribute__((noinline)) static int handle(unsigned kind, int x)
{
    if (kind >= 4) return -x;
    return handlers[kind](x + 1);
}
int run(void)
{
    int x = 1;
    for (unsigned i = 0; i < count; i++) x = handle(kinds[i], x);
    return x;
}
int main(void) { return run(); }
