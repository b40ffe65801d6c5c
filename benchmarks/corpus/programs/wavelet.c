/* entry: run; inputs: signal any, levels 1..5 */
#include <stdint.h>
#include <string.h>

/* Lifting steps of a 5/3 wavelet over halving lengths, thresholded, undone. */
#define N 64

int16_t signal[N] = {5, 8, 13, 21, 34, 55, 89, 55, 34, 21, 13, 8, 5, 3, 2, 1, 0, 0, 0, 100, 100, 100};
uint8_t levels = 3;
static int16_t scratch[N];

static void forward(int16_t *x, int n)
{
    for (int i = 1; i < n; i += 2)
        x[i] -= (int16_t)((x[i - 1] + x[i + 1 < n ? i + 1 : i - 1]) >> 1);
    for (int i = 0; i < n; i += 2)
        x[i] += (int16_t)((x[i > 0 ? i - 1 : 1] + x[i + 1] + 2) >> 2);
    int16_t *low = scratch, *high = scratch + n / 2;
    for (int16_t *p = x; p < x + n; p += 2) {
        *low++ = p[0];
        *high++ = p[1];
    }
    memcpy(x, scratch, (size_t)n * sizeof *x);
}

static void backward(int16_t *x, int n)
{
    for (int i = 0; i < n / 2; i++) {
        scratch[2 * i] = x[i];
        scratch[2 * i + 1] = x[n / 2 + i];
    }
    memcpy(x, scratch, (size_t)n * sizeof *x);
    for (int i = 0; i < n; i += 2)
        x[i] -= (int16_t)((x[i > 0 ? i - 1 : 1] + x[i + 1] + 2) >> 2);
    for (int i = 1; i < n; i += 2)
        x[i] += (int16_t)((x[i - 1] + x[i + 1 < n ? i + 1 : i - 1]) >> 1);
}

int run(void)
{
    int n = N, zeros = 0;

    for (uint8_t level = levels; level; level--, n >>= 1)
        forward(signal, n);
    for (int16_t *p = signal + n; p < signal + N; p++)
        if (*p > -4 && *p < 4) {
            *p = 0;
            zeros++;
        }
    while (n < N) {
        n <<= 1;
        backward(signal, n);
    }
    return zeros;
}

int main(void)
{
    return run();
}
