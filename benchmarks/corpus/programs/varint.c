/* entry: run; inputs: numbers any */
#include <stdint.h>

#define N 12
uint32_t numbers[N] = {0, 1, 127, 128, 300, 70000, 0xFFFFFFFF, 5, 1u << 21};
static uint8_t wire[N * 5];

static uint8_t *put(uint8_t *p, uint32_t value)
{
    while (value >= 0x80) {
        *p++ = (uint8_t)(value | 0x80);
        value >>= 7;
    }
    *p++ = (uint8_t)value;
    return p;
}

static const uint8_t *get(const uint8_t *p, const uint8_t *end, uint32_t *value)
{
    uint32_t v = 0;
    uint8_t shift = 0;
    while (p < end) {
        uint8_t byte = *p++;
        v |= (uint32_t)(byte & 0x7F) << shift;
        if (!(byte & 0x80)) {
            *value = v;
            return p;
        }
        shift += 7;
        if (shift > 28)
            break;
    }
    return 0;
}

int run(void)
{
    uint8_t *end = wire;
    for (int i = 0; i < N; i++)
        end = put(end, numbers[i]);
    const uint8_t *p = wire;
    for (int i = 0; p && i < N; i++) {
        uint32_t back = 0;
        p = get(p, end, &back);
        if (back != numbers[i])
            return -1 - i;
    }
    return (int)(end - wire);
}

int main(void)
{
    return run();
}
