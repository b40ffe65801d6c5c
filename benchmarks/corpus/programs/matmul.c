/* entry: run; inputs: a any, b any */
#include <stdint.h>

#define N 9

int32_t a[N][N] = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
int32_t b[N][N] = {{9, 8, 7}, {6, 5, 4}, {3, 2, 1}};
int32_t c[N][N];

static void multiply(int32_t out[N][N], int32_t left[N][N], int32_t right[N][N])
{
    for (int i = 0; i < N; i++)
        for (int j = 0; j < N; j++) {
            int32_t sum = 0;
            for (int k = 0; k < N; k++)
                sum += left[i][k] * right[k][j];
            out[i][j] = sum;
        }
}

static void transpose(int32_t m[N][N])
{
    for (int i = 0; i < N; i++)
        for (int j = i + 1; j < N; j++) {
            int32_t t = m[i][j];
            m[i][j] = m[j][i];
            m[j][i] = t;
        }
}

static int32_t trace(int32_t m[N][N])
{
    int32_t sum = 0;
    for (int32_t *p = &m[0][0]; p <= &m[N - 1][N - 1]; p += N + 1)
        sum += *p;
    return sum;
}

int run(void)
{
    multiply(c, a, b);
    transpose(c);
    return trace(c);
}

int main(void)
{
    return run();
}
