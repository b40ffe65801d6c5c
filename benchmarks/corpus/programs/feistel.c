/* entry: run; inputs: secret any, pair any, encrypt 0..1 */
#include <stdint.h>

uint16_t secret[8] = {1, 22, 333, 4444, 5555, 666, 77, 8};
uint16_t pair[2] = {0xBEEF, 0x1234};
uint8_t encrypt = 1;

static uint16_t turn(uint16_t half, uint16_t subkey)
{
    static const uint8_t boxes[16] = {6, 4, 12, 5, 0, 7, 2, 14, 1, 15, 3, 13, 8, 10, 9, 11};
    uint16_t in = half ^ subkey, out = 0;

    for (uint8_t shift = 0; shift < 16; shift += 4)
        out |= (uint16_t)(boxes[in >> shift & 15] << shift);
    return (uint16_t)(out << 3 | out >> 13);
}

int run(void)
{
    uint16_t left = pair[0], right = pair[1];

    if (encrypt) {
        for (int round = 0; round < 16; round++) {
            uint16_t t = left ^ turn(right, secret[round % 8]);
            left = right;
            right = t;
        }
    } else {
        for (int round = 15; round >= 0; round--) {
            uint16_t t = right ^ turn(left, secret[round % 8]);
            right = left;
            left = t;
        }
    }
    return left << 16 | right;
}

int main(void)
{
    return run();
}
