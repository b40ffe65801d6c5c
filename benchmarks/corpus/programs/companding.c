/* entry: run; inputs: samples any */
#include <stdint.h>

/* Logarithmic coding of speech in 8 bits: the segment by search, by shifting, and decoded; signal and error energy. */
int16_t samples[64] = {0, 1, -1, 100, -100, 1000, -1000, 32767, -32768, 12345};
static uint8_t coded[64];
static const int16_t ends[8] = {0x1F, 0x3F, 0x7F, 0xFF, 0x1FF, 0x3FF, 0x7FF, 0xFFF};

static uint8_t a_law(int16_t sample)
{
    uint8_t mask = 0xD5, segment = 0, code;

    sample >>= 3;
    if (sample < 0) {
        mask = 0x55;
        sample = (int16_t)(-sample - 1);
    }
    while (segment < 8 && sample > ends[segment])
        segment++;
    if (segment == 8)
        return 0x7F ^ mask;
    code = (uint8_t)(segment << 4);
    code |= segment < 2 ? sample >> 1 & 15 : sample >> segment & 15;
    return code ^ mask;
}

static uint8_t mu_law(int16_t sample)
{
    uint8_t sign = sample < 0 ? 0x80 : 0;
    int32_t magnitude = sample < 0 ? -(int32_t)sample : sample;
    int8_t exponent = 7;

    magnitude = (magnitude > 32635 ? 32635 : magnitude) + 132;
    for (int32_t mask = 0x4000; (magnitude & mask) == 0 && exponent > 0; mask >>= 1)
        exponent--;
    return (uint8_t)~(sign | exponent << 4 | (magnitude >> (exponent + 3) & 15));
}

static int16_t linear(uint8_t code)
{
    code = (uint8_t)~code;
    int16_t value = (int16_t)(((code & 15) << 3) + 132);
    uint8_t shift = code >> 4 & 7;
    while (shift--)
        value = (int16_t)(value * 2);
    value -= 132;
    return code & 0x80 ? (int16_t)-value : value;
}

int run(void)
{
    uint32_t error = 0, sum = 0;
    uint8_t *out = coded;

    for (const int16_t *p = samples; p < samples + 64; p++) {
        *out = mu_law(*p);
        int32_t d = *p - linear(*out++);
        error += (uint32_t)(d < 0 ? -d : d);
        sum += a_law(*p);
    }
    return (int)(error / 64 + sum);
}

int main(void)
{
    return run();
}
