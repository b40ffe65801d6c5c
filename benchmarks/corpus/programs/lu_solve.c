/* entry: run; inputs: coefficients any, right any */
#include <stdint.h>
#include <stdlib.h>

#define N 5
typedef int32_t q16;

q16 coefficients[N][N] = {{4 << 16, 1 << 16, 0, 0, 0}, {1 << 16, 5 << 16, 2 << 16, 0, 0},
                          {0, 2 << 16, 6 << 16, 1 << 16, 0}, {0, 0, 1 << 16, 3 << 16, 1 << 16},
                          {0, 0, 0, 1 << 16, 7 << 16}};
q16 right[N] = {1 << 16, 2 << 16, 3 << 16, 4 << 16, 5 << 16};
q16 solution[N];

static q16 mul(q16 a, q16 b)
{
    return (q16)(((int64_t)a * b) >> 16);
}

static q16 divide(q16 a, q16 b)
{
    return (q16)((((int64_t)a) << 16) / b);
}

static int factor(q16 m[N][N], uint8_t *rows)
{
    for (uint8_t i = 0; i < N; i++)
        rows[i] = i;
    for (int k = 0; k < N; k++) {
        int best = k;
        for (int i = k + 1; i < N; i++)
            if (abs(m[rows[i]][k]) > abs(m[rows[best]][k]))
                best = i;
        uint8_t t = rows[k];
        rows[k] = rows[best];
        rows[best] = t;
        if (m[rows[k]][k] == 0)
            return -1;
        for (int i = k + 1; i < N; i++) {
            q16 f = divide(m[rows[i]][k], m[rows[k]][k]);
            m[rows[i]][k] = f;
            for (int j = k + 1; j < N; j++)
                m[rows[i]][j] -= mul(f, m[rows[k]][j]);
        }
    }
    return 0;
}

int run(void)
{
    uint8_t rows[N];

    if (factor(coefficients, rows) != 0)
        return -1;
    for (int i = 0; i < N; i++) {
        q16 sum = right[rows[i]];
        for (int j = 0; j < i; j++)
            sum -= mul(coefficients[rows[i]][j], solution[j]);
        solution[i] = sum;
    }
    for (int i = N - 1; i >= 0; i--) {
        q16 sum = solution[i];
        for (int j = i + 1; j < N; j++)
            sum -= mul(coefficients[rows[i]][j], solution[j]);
        solution[i] = divide(sum, coefficients[rows[i]][i]);
    }
    return solution[0];
}

int main(void)
{
    return run();
}
