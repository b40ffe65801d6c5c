/* entry: run; inputs: signals any, frame any */
#include <stdint.h>

struct field {
    uint8_t start, bits;
    int16_t scale;
};

static const struct field fields[] = {{0, 12, 4}, {12, 10, 1}, {22, 1, 1}, {24, 16, -2}, {40, 7, 1}, {47, 17, 3}};
#define FIELDS (sizeof fields / sizeof fields[0])

int32_t signals[FIELDS] = {800, 511, 1, -300, 99, 1000};
uint8_t frame[8] = {0x12, 0x34, 0x56, 0x78, 0x9A, 0xBC, 0xDE, 0xF0};
static uint8_t sent[8];

static void pack(uint8_t *to, uint8_t start, uint8_t bits, uint32_t value)
{
    for (uint8_t i = 0; i < bits; i++) {
        uint8_t at = start + i;
        uint8_t mask = (uint8_t)(1 << (at & 7));
        if (value >> i & 1)
            to[at >> 3] |= mask;
        else
            to[at >> 3] &= (uint8_t)~mask;
    }
}

static uint32_t unpack(const uint8_t *from, uint8_t start, uint8_t bits)
{
    uint32_t value = 0;
    while (bits--)
        value = value << 1 | (from[(start + bits) >> 3] >> ((start + bits) & 7) & 1);
    return value;
}

int run(void)
{
    uint32_t check = 0;
    for (const struct field *f = fields; f != fields + FIELDS; f++) {
        int32_t raw = signals[f - fields] / f->scale;
        pack(sent, f->start, f->bits, (uint32_t)raw);
        check = check * 33 + unpack(frame, f->start, f->bits);
    }
    return (int)(check ^ sent[3]);
}

int main(void)
{
    return run();
}
