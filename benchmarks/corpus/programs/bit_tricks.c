/* entry: run; inputs: value any, gray any */
#include <stdint.h>

uint32_t value = 0x12345678;
uint16_t gray = 0x1B3;

static uint32_t reverse(uint32_t v)
{
    uint32_t r = 0;
    for (int i = 0; i < 32; i++, v >>= 1)
        r = r << 1 | (v & 1);
    return r;
}

static uint32_t reverse_short(uint32_t v)
{
    uint32_t r = v;
    int s = 31;
    for (v >>= 1; v; v >>= 1) {
        r = r << 1 | (v & 1);
        s--;
    }
    return r << s;
}

static uint16_t from_gray(uint16_t g)
{
    uint16_t b = g;
    while (g >>= 1)
        b ^= g;
    return b;
}

static int leading_zeros(uint32_t v)
{
    int n = 0;
    while (n < 32 && !(v & 0x80000000u)) {
        v <<= 1;
        n++;
    }
    return n;
}

static int parity(uint64_t v)
{
    for (int s = 32; s; s /= 2)
        v ^= v >> s;
    return v & 1;
}

int run(void)
{
    return (reverse(value) == reverse_short(value)) + from_gray(gray) + leading_zeros(value) + parity(value);
}

int main(void)
{
    return run();
}
