/* entry: run; inputs: pcm any */
#include <stdint.h>

#define N 64
int16_t pcm[N] = {0, 1000, 2000, 2800, 3000, 2500, 1200, -300, -2000, -3200, -3500};
static uint8_t nibbles[N / 2];
static int16_t decoded[N];
static int16_t steps[49];

static void make_steps(void)
{
    int32_t value = 16;
    for (int i = 0; i < 49; i++) {
        steps[i] = (int16_t)value;
        value += value / 10;
    }
}

static const int8_t adapt[8] = {-1, -1, -1, -1, 2, 4, 6, 8};

static int clip(int v, int low, int high)
{
    return v < low ? low : v > high ? high : v;
}

static uint8_t quantise(int difference, int step)
{
    uint8_t code = 0;
    if (difference < 0) {
        code = 8;
        difference = -difference;
    }
    for (uint8_t mask = 4; mask; mask >>= 1, step >>= 1) {
        if (difference >= step) {
            code |= mask;
            difference -= step;
        }
    }
    return code;
}

static int restore(uint8_t code, int step)
{
    int value = step >> 3;
    for (int bit = 2; bit >= 0; bit--) {
        if (code >> bit & 1)
            value += step >> (2 - bit);
    }
    return code & 8 ? -value : value;
}

int run(void)
{
    int predicted = 0, index = 0;

    make_steps();
    for (int i = 0; i < N; i++) {
        uint8_t c = quantise(pcm[i] - predicted, steps[index]);
        predicted = clip(predicted + restore(c, steps[index]), -32768, 32767);
        index = clip(index + adapt[c & 7], 0, 48);
        decoded[i] = (int16_t)predicted;
        if (i % 2)
            nibbles[i / 2] |= (uint8_t)(c << 4);
        else
            nibbles[i / 2] = c;
    }
    return decoded[N - 1];
}

int main(void)
{
    return run();
}
