/* entry: run; inputs: packed any */
#include <stdint.h>

/* A control byte announces eight items: a literal byte, or a pair (distance, length - 2). */
uint8_t packed[64] = {0x10, 'a', 'b', 'c', 'd', 4, 6, 'x', 'y', 'z', 0x00, 'e', 'n', 'd'};
static uint8_t window[256];

int run(void)
{
    const uint8_t *in = packed, *end = packed + sizeof packed;
    uint16_t out = 0;
    uint8_t control = 0, left = 0;

    while (in < end && out < sizeof window) {
        if (left == 0) {
            control = *in++;
            left = 8;
            continue;
        }
        left--;
        if (control & 1) {
            if (end - in < 2)
                break;
            uint16_t distance = *in++;
            uint16_t length = (uint16_t)(*in++ & 0x1F) + 2;
            if (distance == 0 || distance > out)
                return -1;
            while (length-- > 0 && out < sizeof window) {
                window[out] = window[out - distance];
                out++;
            }
        } else {
            window[out++] = *in++;
        }
        control >>= 1;
    }
    return out;
}

int main(void)
{
    return run();
}
