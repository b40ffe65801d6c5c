/* entry: run; inputs: numbers each 1B 0..191, used 0..30 */
#include <stdint.h>

uint8_t numbers[30] = {1, 5, 100, 191, 64, 63, 32};
uint8_t used = 7;
static uint32_t words[6];

static int count(uint32_t v)
{
    int n = 0;
    for (; v; v &= v - 1)
        n++;
    return n;
}

static int lowest(uint32_t v)
{
    int at = 0;
    if (!v)
        return -1;
    while (!(v & 1)) {
        v >>= 1;
        at++;
    }
    return at;
}

static int log2_of(uint32_t v)
{
    int n = -1;
    while (v) {
        v /= 2;
        n++;
    }
    return n;
}

int run(void)
{
    int total = 0;
    for (uint8_t i = 0; i < used; i++)
        words[numbers[i] / 32] |= 1u << numbers[i] % 32;
    for (const uint32_t *w = words; w < words + 6; w++)
        total += count(*w) + lowest(*w) + log2_of(*w);
    return total;
}

int main(void)
{
    return run();
}
