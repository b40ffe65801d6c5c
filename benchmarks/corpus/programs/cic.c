/* entry: run; inputs: bits any */
#include <stdint.h>

#define ORDER 3
#define RATIO 16

uint8_t bits[32] = {0xAA, 0x55, 0xFF, 0x0F, 0xF0, 0x81, 0x18, 0x3C};
static uint32_t integrators[ORDER], combs[ORDER];
int32_t decimated[256 / RATIO];

static int32_t comb(uint32_t value)
{
    for (unsigned i = 0; i < ORDER; i++) {
        uint32_t before = combs[i];
        combs[i] = value;
        value -= before;
    }
    return (int32_t)value;
}

int run(void)
{
    unsigned produced = 0, phase = 0;

    for (unsigned byte = 0; byte < sizeof bits; byte++) {
        for (uint8_t mask = 0x80; mask != 0; mask >>= 1) {
            integrators[0] += bits[byte] & mask ? 1u : -1u;
            for (unsigned i = 1; i < ORDER; i++)
                integrators[i] += integrators[i - 1];
            if (++phase == RATIO) {
                phase = 0;
                decimated[produced++] = comb(integrators[ORDER - 1]);
            }
        }
    }
    return decimated[produced - 1];
}

int main(void)
{
    return run();
}
