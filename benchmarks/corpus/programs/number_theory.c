/* entry: run; inputs: a any, b any, n any */
#include <stdint.h>

uint32_t a = 1071, b = 462, n = 1000000;

static uint32_t gcd(uint32_t x, uint32_t y)
{
    while (y) {
        uint32_t r = x % y;
        x = y;
        y = r;
    }
    return x;
}

static uint32_t binary_gcd(uint32_t x, uint32_t y)
{
    unsigned shift = 0;
    if (!x || !y)
        return x | y;
    while (!((x | y) & 1)) {
        x >>= 1;
        y >>= 1;
        shift++;
    }
    while (!(x & 1))
        x >>= 1;
    do {
        while (!(y & 1))
            y >>= 1;
        if (x > y) {
            uint32_t t = x;
            x = y;
            y = t;
        }
        y -= x;
    } while (y);
    return x << shift;
}

static uint32_t isqrt(uint32_t v)
{
    uint32_t low = 0, high = 65535;
    while (low < high) {
        uint32_t middle = (low + high + 1) / 2;
        if (middle * middle <= v)
            low = middle;
        else
            high = middle - 1;
    }
    return low;
}

static uint32_t power_mod(uint32_t base, uint32_t exponent, uint32_t modulus)
{
    uint64_t result = 1, square = base % modulus;
    for (; exponent; exponent >>= 1) {
        if (exponent & 1)
            result = result * square % modulus;
        square = square * square % modulus;
    }
    return (uint32_t)result;
}

int run(void)
{
    return (int)(gcd(a, b) - binary_gcd(a, b) + isqrt(n) + power_mod(a, b & 0xFFFF, 65521));
}

int main(void)
{
    return run();
}
