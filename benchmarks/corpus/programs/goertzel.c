/* entry: run; inputs: samples any */
#include <stdint.h>

/* Which key of a telephone was pressed: power at eight frequencies, 8 kHz, Q14 coefficients. */
#define BLOCK 102

int16_t samples[BLOCK] = {0, 4000, 7000, 8000, 6500, 3000, -1000, -5000, -7600, -7900, -6000, -2200, 2100};
static const int16_t coefficient[8] = {27980, 26956, 25701, 24219, 19073, 16325, 13085, 9315};
static const char keys[4][5] = {"123A", "456B", "789C", "*0#D"};

static uint32_t power(const int16_t *from, const int16_t *end, int32_t k)
{
    int32_t q1 = 0, q2 = 0;

    while (from != end) {
        int32_t q0 = ((k >> 2) * (q1 >> 4) >> 8) - q2 + (*from++ >> 5);
        q2 = q1;
        q1 = q0;
    }
    q1 >>= 6;
    q2 >>= 6;
    int32_t result = q1 * q1 + q2 * q2 - ((k >> 4) * q1 >> 10) * q2;
    return result < 0 ? 0 : (uint32_t)result;
}

static int strongest(const uint32_t *group, uint32_t floor)
{
    int best = -1;
    for (int i = 0; i < 4; i++) {
        if (group[i] <= floor)
            continue;
        if (best < 0 || group[i] > group[best])
            best = i;
    }
    return best;
}

int run(void)
{
    uint32_t powers[8], total = 0;
    unsigned i = 0;

    do {
        powers[i] = power(samples, samples + BLOCK, coefficient[i]);
        total += powers[i] >> 3;
    } while (++i < 8);
    int row = strongest(powers, total / 4), column = strongest(powers + 4, total / 4);
    if (row < 0 || column < 0)
        return -1;
    for (i = 0; i < 8; i++)
        if ((int)i != row && (int)i != column + 4 && powers[i] > total / 2)
            return -2;
    return keys[row][column];
}

int main(void)
{
    return run();
}
