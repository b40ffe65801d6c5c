/* entry: run; inputs: pixels any */
#include <stdint.h>

/* Threshold of a picture: the level that separates its histogram best. */
#define SIZE 144
uint8_t pixels[SIZE] = {12, 200, 14, 190, 16, 16, 210, 220, 90, 30, 7};
static uint16_t bins[32];

int run(void)
{
    uint32_t total = 0, below = 0, weight = 0;
    uint32_t best = 0;
    int level = 0;

    for (int i = 0; i < 32; i++)
        bins[i] = 0;
    for (const uint8_t *p = pixels; p != pixels + SIZE; ++p)
        bins[*p >> 3]++;
    for (int i = 0; i < 32; i++)
        total += (uint32_t)i * bins[i];
    for (int i = 0; i < 32; i++) {
        weight += bins[i];
        if (weight == 0)
            continue;
        uint32_t rest = SIZE - weight;
        if (rest == 0)
            break;
        below += (uint32_t)i * bins[i];
        int32_t gap = (int32_t)(below / weight) - (int32_t)((total - below) / rest);
        uint32_t between = weight * rest * (uint32_t)(gap * gap);
        if (between > best) {
            best = between;
            level = i;
        }
    }
    for (int i = 0; i < SIZE; i++)
        pixels[i] = pixels[i] >> 3 > level ? 255 : 0;
    return level;
}

int main(void)
{
    return run();
}
