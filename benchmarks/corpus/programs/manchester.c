/* entry: run; inputs: line any */
#include <stdint.h>

/* Two half bits per bit; a pair of equal halves is an error, after which the decoder searches the next preamble. */
uint8_t line[24] = {0xAA, 0xAA, 0x96, 0x69, 0x55, 0xA5};
static uint8_t bytes[16];

static uint8_t half(uint16_t at)
{
    return line[at / 8] >> (7 - at % 8) & 1;
}

int run(void)
{
    uint16_t at = 0, end = sizeof line * 8;
    uint8_t made = 0, value = 0, bits = 0;

    while (at + 1 < end && made < sizeof bytes) {
        uint8_t first = half(at), second = half(at + 1);
        if (first == second) {
            bits = 0;
            at++;
            while (at + 1 < end && half(at) == half(at + 1))
                at++;
            continue;
        }
        value = (uint8_t)(value << 1 | first);
        if (++bits == 8) {
            bytes[made++] = value;
            bits = 0;
        }
        at += 2;
    }
    return made;
}

int main(void)
{
    return run();
}
