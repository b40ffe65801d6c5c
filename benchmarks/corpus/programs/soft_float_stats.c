/* entry: run; inputs: samples each 2B -2000..2000, n 1..24 */
#include <math.h>
#include <stdint.h>

int16_t samples[24] = {100, 102, 98, 97, 110, 250, 99, 101, -40, 100};
uint8_t n = 10;

int run(void)
{
    float mean = 0, deviation = 0;
    for (int i = 0; i < n; i++)
        mean += samples[i];
    mean /= n;
    for (int i = 0; i < n; i++) {
        float d = (float)samples[i] - mean;
        deviation += d * d;
    }
    deviation = sqrtf(deviation / n);
    int outliers = 0;
    for (int i = 0; i < n; i++)
        if (fabsf((float)samples[i] - mean) > 2 * deviation)
            outliers++;
    return outliers + (int)floorf(mean);
}

int main(void)
{
    return run();
}
