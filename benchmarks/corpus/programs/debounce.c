/* entry: run; inputs: port any */
#include <stdint.h>

/* Eight switches sampled 40 times; a change counts after four equal samples, by vertical counters and one by one. */
uint8_t port[40] = {0xFF, 0xFF, 0xFE, 0xFF, 0xFE, 0xFE, 0xFE, 0xFE, 0xFE, 0x7E, 0x7E};
static uint8_t stable = 0xFF, low, high;
static uint8_t counters[8];
static uint16_t presses[8];

static uint8_t vertical(uint8_t sample)
{
    uint8_t delta = sample ^ stable;
    high = (high ^ low) & delta;
    low = (uint8_t)~low & delta;
    uint8_t toggled = delta & (uint8_t) ~(low | high);
    stable ^= toggled;
    return toggled;
}

int run(void)
{
    int total = 0;
    for (unsigned i = 0; i < sizeof port; i++) {
        uint8_t toggled = vertical(port[i]);
        for (uint8_t key = 0, mask = 1; key < 8; key++, mask <<= 1) {
            if (port[i] & mask) {
                counters[key] = 0;
            } else if (counters[key] < 4 && ++counters[key] == 4) {
                presses[key]++;
                total++;
            }
            if (toggled & mask)
                total += 100;
        }
    }
    return total;
}

int main(void)
{
    return run();
}
