/* entry: run; inputs: phase any, length 1..100 */
#include <stdint.h>

/* A tone from a quarter-wave table with interpolation. */
static const int16_t quarter[17] = {0,     3212,  6393,  9512,  12539, 15446, 18204, 20787, 23170,
                                    25329, 27245, 28898, 30273, 31356, 32137, 32609, 32767};
uint16_t phase = 100;
uint8_t length = 60;
int16_t tone[100];

static int16_t sine(uint16_t angle)
{
    uint16_t part = angle & 0x3FFF;
    if (angle & 0x4000)
        part = 0x3FFF - part;
    uint16_t index = part >> 10;
    int32_t low = quarter[index], high = quarter[index + 1];
    int32_t value = low + (((high - low) * (part & 0x3FF)) >> 10);
    return (int16_t)(angle & 0x8000 ? -value : value);
}

int run(void)
{
    uint16_t angle = phase, increment = 1500;
    int32_t peak = 0;
    uint8_t i = 0;

    while (i != length) {
        int16_t v = sine(angle);
        tone[i++] = v;
        angle += increment;
        if (v > peak)
            peak = v;
    }
    return peak;
}

int main(void)
{
    return run();
}
