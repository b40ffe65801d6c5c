/* entry: run; inputs: x any, wanted any */
#include <stdint.h>

#define N 60
#define TAPS 10

int16_t x[N] = {100, 0, -100, 0, 100, 0, -100, 0, 100};
int16_t wanted[N] = {0, 100, 0, -100, 0, 100, 0, -100, 0};
static int32_t weights[TAPS];

int run(void)
{
    int32_t error = 0;
    for (int n = TAPS - 1; n < N; n++) {
        int64_t y = 0;
        for (int k = 0; k < TAPS; k++)
            y += (int64_t)weights[k] * x[n - k];
        error = wanted[n] - (int32_t)(y >> 16);
        for (int k = TAPS - 1; k >= 0; k--)
            weights[k] += (error * x[n - k]) >> 8;
    }
    return error;
}

int main(void)
{
    return run();
}
