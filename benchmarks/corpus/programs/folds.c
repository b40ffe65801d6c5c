/* entry: run; inputs: data any, n 0..25, which 0..1 */
#include <stdint.h>
int16_t data[25] = {5, -3, 8, 0, 12, -7};
uint8_t n = 6, which = 0;
static int add(int a, int b) { return a + b; }
static int larger(int a, int b) { return a > b ? a : b; }
static int keep_odd(int x) { return x & 1; }
static int keep_small(int x) { int k = 0; while (k < 8 && x > (1 << k)) k++; return k < 5; }
__attribute__((noinline)) static int fold(int (*f)(int, int), int (*keep)(int), int start)
{
    for (unsigned i = 0; i < n; i++) if (keep(data[i])) start = f(start, data[i]);
    return start;
}
__attribute__((noinline)) static int both(int (*f)(int, int), int start)
{
    return fold(f, which ? keep_odd : keep_small, start) + fold(f, keep_odd, start);
}
int run(void) { return both(add, 0) ^ both(larger, -100); }
int main(void) { return run(); }
