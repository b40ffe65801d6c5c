/* entry: run; inputs: pixels any */
#include <stdint.h>
#include <string.h>

/* Histogram equalisation and a threshold by the greatest variance between the classes (Otsu). */
#define COUNT 200

uint8_t pixels[COUNT] = {10, 12, 14, 200, 210, 220, 11, 13, 205, 90};
static uint16_t histogram[256];
static uint8_t map[256];

static void count(void)
{
    const uint8_t *p = pixels;
    memset(histogram, 0, sizeof histogram);
    while (p < pixels + sizeof pixels)
        histogram[*p++]++;
}

static void equalise(void)
{
    unsigned first = 0, sum = 0;
    while (first < 255 && histogram[first] == 0)
        first++;
    unsigned least = histogram[first];
    if (least == COUNT)
        return;
    for (unsigned i = first; i < 256; i++) {
        sum += histogram[i];
        map[i] = (uint8_t)((sum - least) * 255 / (COUNT - least));
    }
    for (uint8_t *p = pixels, *end = pixels + COUNT; p != end; p++)
        *p = map[*p];
}

static uint8_t otsu(void)
{
    uint32_t total = 0, below = 0, weight = 0, best = 0;
    uint8_t threshold = 0, level = 0;

    do
        total += level * (uint32_t)histogram[level];
    while (++level != 0);
    do {
        weight += histogram[level];
        if (weight == 0)
            continue;
        if (weight == COUNT)
            break;
        below += level * (uint32_t)histogram[level];
        uint32_t low = below / weight, high = (total - below) / (COUNT - weight);
        uint32_t apart = high > low ? high - low : 0;
        uint32_t variance = weight * (COUNT - weight) / 64 * apart * apart;
        if (variance > best) {
            best = variance;
            threshold = level;
        }
    } while (++level != 0);
    return threshold;
}

int run(void)
{
    count();
    equalise();
    count();
    return otsu();
}

int main(void)
{
    return run();
}
