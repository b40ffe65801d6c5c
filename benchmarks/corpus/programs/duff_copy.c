/* entry: run; inputs: from any, count 0..64, step 0..3 */
#include <stdint.h>
#pragma GCC diagnostic ignored "-Wimplicit-fallthrough"
uint8_t from[64] = "the quick brown fox jumps over the lazy dog and so on and on";
uint8_t count = 37, step = 1;
static uint8_t into[64];
static void copy(uint8_t *to, const uint8_t *p, unsigned n)
{
    unsigned k = (n + 7) / 8;
    if (!n) return;
    switch (n % 8) {
    case 0: do { *to++ = *p++;
    case 7: *to++ = *p++;
    case 6: *to++ = *p++;
    case 5: *to++ = *p++;
    case 4: *to++ = *p++;
    case 3: *to++ = *p++;
    case 2: *to++ = *p++;
    case 1: *to++ = *p++;
            } while (--k > 0);
    }
}
static unsigned sum(const uint8_t *p, unsigned n, unsigned s)
{
    unsigned total = 0, k = (n + 3) / 4;
    if (!n) return 0;
    switch (n & 3) {
    case 0: do { total += *p++ << s;
    case 3: total ^= *p++;
    case 2: for (unsigned i = 0; i < s; i++) total += i; p++;
    case 1: total -= *p++;
            } while (--k);
    }
    return total;
}
int run(void)
{
    copy(into, from, count);
    return (int)sum(into, count, step);
}
int main(void) { return run(); }
