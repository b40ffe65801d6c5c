/* entry: run; inputs: measured each 2B -900..900, count 0..10 */
#include <stdint.h>
#include <string.h>

/* Position, speed and bias from two measurements; single precision; the innovation is inverted in closed form. */
#define N 3
#define M 2

typedef float matrix[N][N];

int16_t measured[10][M] = {{0, 10}, {11, 12}, {25, 11}, {33, 9}, {44, 12}, {53, 10}};
uint32_t count = 6;
static float x[N];
static matrix p = {{10, 0, 0}, {0, 10, 0}, {0, 0, 1}};
static const matrix f = {{1, 0.1f, 0}, {0, 1, 0}, {0, 0, 1}};
static const float h[M][N] = {{1, 0, 0}, {0, 1, 1}};
static const float r[M] = {4.0f, 0.5f};

static void times(float *out, const float *a, const float *b, int rows, int inner, int columns)
{
    while (rows--) {
        for (int c = 0; c < columns; c++) {
            float sum = 0;
            const float *column = b + c;
            for (int k = 0; k < inner; k++, column += columns)
                sum += a[k] * *column;
            *out++ = sum;
        }
        a += inner;
    }
}

static void transpose(float *out, const float *a, int rows, int columns)
{
    for (int i = 0; i < rows; i++)
        for (int k = 0; k < columns; k++)
            out[k * rows + i] = *a++;
}

static int update(const int16_t z[M])
{
    float ht[N][M], pht[N][M], s[M][M], gain[N][M], inverse[M][M], innovation[M], kh[N][N], lost[N][N];

    transpose(&ht[0][0], &h[0][0], M, N);
    times(&pht[0][0], &p[0][0], &ht[0][0], N, N, M);
    times(&s[0][0], &h[0][0], &pht[0][0], M, N, M);
    for (int i = 0; i < M; i++)
        s[i][i] += r[i];
    float determinant = s[0][0] * s[1][1] - s[0][1] * s[1][0];
    if (determinant < 1e-6f && determinant > -1e-6f)
        return -1;
    inverse[0][0] = s[1][1] / determinant;
    inverse[1][1] = s[0][0] / determinant;
    inverse[0][1] = -s[0][1] / determinant;
    inverse[1][0] = -s[1][0] / determinant;
    times(&gain[0][0], &pht[0][0], &inverse[0][0], N, M, M);
    times(innovation, &h[0][0], x, M, N, 1);
    for (int i = 0; i < M; i++)
        innovation[i] = (float)z[i] * 0.1f - innovation[i];
    for (int i = 0; i < N; i++)
        for (int k = 0; k < M; k++)
            x[i] += gain[i][k] * innovation[k];
    times(&kh[0][0], &gain[0][0], &h[0][0], N, M, N);
    times(&lost[0][0], &kh[0][0], &p[0][0], N, N, N);
    for (float *to = &p[0][0], *from = &lost[0][0]; to < &p[0][0] + N * N;)
        *to++ -= *from++;
    return 0;
}

int run(void)
{
    int rejected = 0;
    for (uint32_t i = 0; i < count; i++) {
        float next[N];
        matrix ft, fp;
        times(next, &f[0][0], x, N, N, 1);
        memcpy(x, next, sizeof x);
        transpose(&ft[0][0], &f[0][0], N, N);
        times(&fp[0][0], &f[0][0], &p[0][0], N, N, N);
        times(&p[0][0], &fp[0][0], &ft[0][0], N, N, N);
        for (int d = 0; d < N; d++)
            p[d][d] += 0.01f;
        if (update(measured[i]) < 0)
            rejected++;
    }
    return (int)x[0] + rejected;
}

int main(void)
{
    return run();
}
