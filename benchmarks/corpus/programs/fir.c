/* entry: run; inputs: samples any, count 0..64 */
#include <stdint.h>

#define TAPS 16

int16_t samples[64] = {100, -200, 300, 400, -500, 600, 700, -800, 900, 1000, 12, 13, 14};
uint8_t count = 48;
static const int16_t taps[TAPS] = {-12, -33, -40, 25, 210, 540, 900, 1150,
                                   1150, 900, 540, 210, 25, -40, -33, -12};
static int16_t history[TAPS];
static uint8_t head;
int16_t filtered[64];

static int16_t saturate(int32_t value)
{
    if (value > 32767)
        return 32767;
    if (value < -32768)
        return -32768;
    return (int16_t)value;
}

static int16_t fir_step(int16_t sample)
{
    int32_t sum = 1 << 11;
    uint8_t at;

    history[head] = sample;
    at = head;
    for (uint8_t i = 0; i < TAPS; i++) {
        sum += (int32_t)taps[i] * history[at];
        at = at == 0 ? TAPS - 1 : at - 1;
    }
    head = (head + 1) % TAPS;
    return saturate(sum >> 12);
}

int run(void)
{
    int32_t peak = 0;
    for (uint8_t i = 0; i < count; i++) {
        filtered[i] = fir_step(samples[i]);
        if (filtered[i] > peak)
            peak = filtered[i];
    }
    return peak;
}

int main(void)
{
    return run();
}
