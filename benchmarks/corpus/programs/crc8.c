/* entry: run; inputs: rom any */
#include <stdint.h>

/* Addresses on a one-wire bus: eight bytes each, the last one the check of the others. */
uint8_t rom[6][8] = {{0x28, 1, 2, 3, 4, 5, 6, 0x97}, {0x10, 9, 8, 7, 6, 5, 4, 3}};

static uint8_t crc8(const uint8_t *data, uint8_t size)
{
    uint8_t crc = 0;
    while (size--) {
        uint8_t in = *data++;
        for (uint8_t i = 8; i; i--) {
            uint8_t mix = (crc ^ in) & 1;
            crc >>= 1;
            if (mix)
                crc ^= 0x8C;
            in >>= 1;
        }
    }
    return crc;
}

int run(void)
{
    int good = 0;
    for (int device = 0; device < 6; device++) {
        if (rom[device][0] == 0)
            break;
        if (crc8(rom[device], 7) == rom[device][7])
            good |= 1 << device;
    }
    return good;
}

int main(void)
{
    return run();
}
