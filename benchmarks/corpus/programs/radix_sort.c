/* entry: run; inputs: words any */
#include <stdint.h>

#define N 24
uint32_t words[N] = {170, 45, 75, 90, 802, 24, 2, 66, 0xFFFF, 0x12345678};
static uint32_t other[N];

int run(void)
{
    uint32_t *from = words, *to = other;

    for (unsigned shift = 0; shift < 32; shift += 8) {
        uint16_t offsets[257] = {0};
        for (int i = 0; i < N; i++)
            offsets[(from[i] >> shift & 0xFF) + 1]++;
        for (int i = 0; i < 256; i++)
            offsets[i + 1] += offsets[i];
        for (int i = 0; i < N; i++)
            to[offsets[from[i] >> shift & 0xFF]++] = from[i];
        uint32_t *t = from;
        from = to;
        to = t;
    }
    return (int)from[0];
}

int main(void)
{
    return run();
}
