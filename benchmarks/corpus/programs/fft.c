/* entry: run; inputs: re any, im any */
#include <stdint.h>

#define N 32
#define LOG 5

int16_t re[N] = {0, 1000, 2000, 3000, 4000, 3000, 2000, 1000, 0, -1000, -2000};
int16_t im[N];
static const int16_t sine[N] = {0,     6393,  12539, 18204, 23170, 27245, 30273,  32137,  32767,  32137, 30273,
                                27245, 23170, 18204, 12539, 6393,  0,     -6393,  -12539, -18204, -23170, -27245,
                                -30273, -32137, -32767, -32137, -30273, -27245, -23170, -18204, -12539, -6393};

static void reorder(void)
{
    for (unsigned i = 0; i < N; i++) {
        unsigned j = 0;
        for (unsigned bit = 0; bit < LOG; bit++)
            if (i & 1u << bit)
                j |= 1u << (LOG - 1 - bit);
        if (j > i) {
            int16_t t = re[i];
            re[i] = re[j];
            re[j] = t;
            t = im[i];
            im[i] = im[j];
            im[j] = t;
        }
    }
}

int run(void)
{
    reorder();
    for (int half = 1, stride = N / 2; half < N; half *= 2, stride /= 2) {
        for (int group = 0; group < half; group++) {
            int32_t wr = sine[(group * stride + N / 4) % N], wi = -sine[group * stride];
            for (int i = group; i < N; i += 2 * half) {
                int j = i + half;
                int32_t tr = (wr * re[j] - wi * im[j]) >> 15, ti = (wr * im[j] + wi * re[j]) >> 15;
                re[j] = (int16_t)((re[i] - tr) >> 1);
                im[j] = (int16_t)((im[i] - ti) >> 1);
                re[i] = (int16_t)((re[i] + tr) >> 1);
                im[i] = (int16_t)((im[i] + ti) >> 1);
            }
        }
    }
    return re[1];
}

int main(void)
{
    return run();
}
