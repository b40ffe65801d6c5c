/* entry: run; inputs: reading any, batches 1..12 */
#include <stdint.h>

#define WINDOW 8

uint16_t reading[96] = {512, 520, 508, 530, 499, 512, 512, 600, 610, 30, 512, 511};
uint16_t batches = 4;
static uint16_t ring[WINDOW];
static uint32_t sum;
static uint8_t next, filled;

static uint16_t push(uint16_t value)
{
    if (filled < WINDOW)
        filled++;
    else
        sum -= ring[next];
    ring[next] = value;
    sum += value;
    if (++next >= WINDOW)
        next = 0;
    return (uint16_t)(sum / filled);
}

int run(void)
{
    uint16_t average = 0;
    for (uint16_t b = 0; b < batches; ++b) {
        const uint16_t *at = &reading[b * 8];
        uint8_t left = 8;
        do {
            average = push(*at++);
        } while (--left);
    }
    return average;
}

int main(void)
{
    return run();
}
