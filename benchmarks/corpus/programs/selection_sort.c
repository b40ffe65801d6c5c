/* entry: run; inputs: keys any, n 0..30 */
#include <stdint.h>

uint32_t keys[30] = {170, 45, 75, 90, 802, 24, 2, 66};
uint8_t n = 8;

static uint8_t smallest(uint8_t from, uint8_t to)
{
    uint8_t best = from;
    while (++from < to)
        if (keys[from] < keys[best])
            best = from;
    return best;
}

int run(void)
{
    for (uint8_t i = 0; i + 1 < n; i++) {
        uint8_t s = smallest(i, n);
        if (s != i) {
            uint32_t t = keys[i];
            keys[i] = keys[s];
            keys[s] = t;
        }
    }
    return (int)keys[0];
}

int main(void)
{
    return run();
}
