/* entry: run; inputs: frame any, length 0..128 */
#include <stddef.h>
#include <stdint.h>

uint8_t frame[128] = "A frame of the serial line, with its check at the end";
uint16_t length = 53;
static uint16_t table[256];
static uint8_t ready;

static uint16_t bitwise(const uint8_t *data, size_t size)
{
    uint16_t crc = 0xFFFF;
    while (size--) {
        crc ^= (uint16_t)(*data++ << 8);
        for (int bit = 0; bit < 8; bit++)
            crc = crc & 0x8000 ? (uint16_t)(crc << 1 ^ 0x1021) : (uint16_t)(crc << 1);
    }
    return crc;
}

static void fill(void)
{
    for (uint16_t i = 0; i < 256; i++) {
        uint16_t crc = (uint16_t)(i << 8);
        for (uint8_t bit = 8; bit; --bit) {
            uint16_t out = crc & 0x8000;
            crc <<= 1;
            if (out)
                crc ^= 0x1021;
        }
        table[i] = crc;
    }
    ready = 1;
}

static uint16_t by_table(const uint8_t *data, const uint8_t *end)
{
    uint16_t crc = 0xFFFF;
    if (!ready)
        fill();
    for (; data != end; ++data)
        crc = (uint16_t)(crc << 8 ^ table[(crc >> 8 ^ *data) & 0xFF]);
    return crc;
}

int run(void)
{
    uint16_t a = bitwise(frame, length);
    uint16_t b = by_table(frame, frame + length);
    return a == b ? a : -1;
}

int main(void)
{
    return run();
}
