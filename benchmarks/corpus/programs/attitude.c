/* entry: run; inputs: gyro each 2B -2000..2000, accel each 2B -4096..4096, steps 0..6 */
#include <math.h>
#include <stdint.h>

/* Quaternion from rates with a correction towards gravity, then angles; single precision, library functions. */
int16_t gyro[6][3] = {{10, -20, 5}, {12, -18, 4}, {9, -21, 6}, {0, 0, 300}};
int16_t accel[6][3] = {{10, 20, 4090}, {-100, 60, 4000}, {0, 0, 4096}, {300, 300, 3900}};
uint8_t steps = 4;
static float q[4] = {1, 0, 0, 0};

static int normalise(float *v, int n)
{
    float sum = 0;
    for (int i = 0; i < n; i++)
        sum += v[i] * v[i];
    if (sum < 1e-12f)
        return 0;
    float scale = 1.0f / sqrtf(sum);
    while (n--)
        *v++ *= scale;
    return 1;
}

static void step(const int16_t rate[3], const int16_t gravity[3], float dt)
{
    float w[3], g[3];
    for (int i = 0; i < 3; i++) {
        w[i] = (float)rate[i] * 0.00106f;
        g[i] = gravity[i];
    }
    if (normalise(g, 3)) {
        float down[3] = {2 * (q[1] * q[3] - q[0] * q[2]), 2 * (q[0] * q[1] + q[2] * q[3]),
                         q[0] * q[0] - q[1] * q[1] - q[2] * q[2] + q[3] * q[3]};
        for (int i = 0, j = 1, k = 2; i < 3; i++, j = (j + 1) % 3, k = (k + 1) % 3)
            w[i] += 0.5f * (g[j] * down[k] - g[k] * down[j]);
    }
    float a = q[0], b = q[1], c = q[2], d = q[3], half = 0.5f * dt;
    q[0] -= half * (b * w[0] + c * w[1] + d * w[2]);
    q[1] += half * (a * w[0] + c * w[2] - d * w[1]);
    q[2] += half * (a * w[1] - b * w[2] + d * w[0]);
    q[3] += half * (a * w[2] + b * w[1] - c * w[0]);
    normalise(q, 4);
}

int run(void)
{
    for (uint8_t i = 0; i < steps; i++)
        step(gyro[i], accel[i], 0.01f);
    float roll = atan2f(2 * (q[0] * q[1] + q[2] * q[3]), 1 - 2 * (q[1] * q[1] + q[2] * q[2]));
    float s = 2 * (q[0] * q[2] - q[3] * q[1]);
    float pitch = s > 1 ? 1.5708f : s < -1 ? -1.5708f : asinf(s);
    return (int)(roll * 1000) + (int)(pitch * 1000);
}

int main(void)
{
    return run();
}
