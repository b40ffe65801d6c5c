/* entry: run; inputs: number any, radicand 0..2000000000 */
#include <stdint.h>

/* Roots by Newton (integers, single precision with a tolerance), by bits, by bisection; a logarithm in Q16. */
uint32_t number = 1234567, radicand = 2000000;

static uint32_t newton(uint32_t n)
{
    if (n < 2)
        return n;
    uint32_t x = n / 2, y = (x + n / x) / 2;
    while (y < x) {
        x = y;
        y = (x + n / x) / 2;
    }
    return x;
}

static float newton_float(float n)
{
    float x = n > 1.0f ? n : 1.0f, change;
    int tries = 40;
    do {
        float next = 0.5f * (x + n / x);
        change = x - next;
        x = next;
    } while (change > 0.001f && --tries);
    return x;
}

static uint32_t cube_root(uint32_t n)
{
    uint32_t y = 0;
    for (int s = 30; s >= 0; s -= 3) {
        y *= 2;
        uint32_t b = 3 * y * (y + 1) + 1;
        if (n >> s >= b) {
            n -= b << s;
            y++;
        }
    }
    return y;
}

static uint32_t bisect(uint32_t n)
{
    uint32_t low = 0, high = 65536;
    while (high - low > 1) {
        uint32_t middle = (low + high) >> 1;
        if ((uint64_t)middle * middle <= n)
            low = middle;
        else
            high = middle;
    }
    return low;
}

static uint32_t logarithm(uint32_t n)
{
    uint32_t result = 0, x = n ? n : 1;
    while (x >= 0x10000)
        x >>= 1, result += 0x10000;
    while (x < 0x8000)
        x <<= 1, result -= 0x10000;
    for (uint32_t bit = 0x8000; bit; bit >>= 1) {
        x = (uint32_t)((uint64_t)x * x >> 15);
        if (x >= 0x10000) {
            x >>= 1;
            result += bit;
        }
    }
    return result;
}

int run(void)
{
    uint32_t sum = newton(number) + cube_root(number) + bisect(number) + logarithm(number);
    return (int)(sum + (uint32_t)newton_float((float)radicand));
}

int main(void)
{
    return run();
}
