/* entry: run; inputs: words each 1B 0..127 */
#include <stdint.h>

/* Seven-bit words of four data bits each; one wrong bit is corrected. */
uint8_t words[30] = {0x00, 0x7F, 0x55, 0x2A, 0x13, 0x33};
static uint8_t nibbles[30];

static uint8_t parity(uint8_t v)
{
    uint8_t p = 0;
    while (v) {
        p ^= 1;
        v &= v - 1;
    }
    return p;
}

int run(void)
{
    static const uint8_t masks[3] = {0x55, 0x66, 0x78};
    int corrected = 0;

    for (unsigned i = 0; i < sizeof words; i++) {
        uint8_t syndrome = 0, w = words[i];
        for (int m = 0; m < 3; m++)
            syndrome |= (uint8_t)(parity(w & masks[m]) << m);
        if (syndrome) {
            w ^= (uint8_t)(1 << (syndrome - 1));
            corrected++;
        }
        nibbles[i] = (uint8_t)((w >> 2 & 1) | (w >> 3 & 0xE));
    }
    return corrected;
}

int main(void)
{
    return run();
}
