/* entry: run; inputs: data any, size 0..300 */
#include <stdint.h>

uint8_t data[300] = {0x45, 0, 0, 0x73, 0, 0, 0x40, 0, 0x40, 0x11, 0, 0, 0xc0, 0xa8, 0, 1, 0xc0, 0xa8, 0, 0xc7};
uint16_t size = 20;

static uint16_t internet(const uint8_t *p, uint16_t n)
{
    uint32_t sum = 0;
    for (; n > 1; n -= 2, p += 2)
        sum += (uint32_t)p[0] << 8 | p[1];
    if (n)
        sum += (uint32_t)*p << 8;
    while (sum >> 16)
        sum = (sum & 0xFFFF) + (sum >> 16);
    return (uint16_t)~sum;
}

static uint32_t adler(const uint8_t *p, uint32_t n)
{
    uint32_t a = 1, b = 0;
    while (n > 0) {
        uint32_t part = n > 64 ? 64 : n;
        n -= part;
        do {
            a += *p++;
            b += a;
        } while (--part);
        a %= 65521;
        b %= 65521;
    }
    return b << 16 | a;
}

static uint16_t fletcher(const uint8_t *p, uint16_t n)
{
    uint16_t c0 = 0, c1 = 0;
    while (n--) {
        c0 = (c0 + *p++) % 255;
        c1 = (c1 + c0) % 255;
    }
    return (uint16_t)(c1 << 8 | c0);
}

int run(void)
{
    return (int)(internet(data, size) ^ adler(data, size) ^ fletcher(data, size));
}

int main(void)
{
    return run();
}
