/* entry: run; inputs: speech each 2B -1000..1000, order 1..8 */
#include <stdint.h>

/* Autocorrelation and the recursion of Levinson and Durbin in single precision. */
#define FRAME 60

int16_t speech[FRAME] = {0, 100, 190, 250, 280, 260, 200, 110, 0, -100, -180, -240, -270, -250, -190, -90};
uint8_t order = 6;
static float lags[9], predictor[9], reflection[9];

static void correlate(int n)
{
    float *r = lags;
    int lag = 0;
    do {
        float sum = 0.0f;
        for (int i = lag; i < FRAME; i++)
            sum += (float)speech[i] * (float)speech[i - lag];
        *r++ = sum;
    } while (++lag <= n);
}

static float recursion(int n)
{
    float error = lags[0] + 1.0f;

    predictor[0] = 1.0f;
    for (int i = 1; i <= n; i++) {
        float sum = lags[i];
        for (int k = 1; k < i; k++)
            sum += predictor[k] * lags[i - k];
        float k_i = -sum / error;
        reflection[i] = k_i;
        predictor[i] = k_i;
        for (int lo = 1, hi = i - 1; lo <= hi; lo++, hi--) {
            float a = predictor[lo], b = predictor[hi];
            predictor[lo] = a + k_i * b;
            if (lo != hi)
                predictor[hi] = b + k_i * a;
        }
        error *= 1.0f - k_i * k_i;
        if (error <= 0.0f)
            break;
    }
    return error;
}

int run(void)
{
    correlate(order);
    return recursion(order) < lags[0] ? 1 : 0;
}

int main(void)
{
    return run();
}
