/* entry: run; inputs: positions any, used 1..30 */
#include <stdint.h>

/* Position and speed from noisy positions; single precision. */
float positions[30] = {0.0f, 1.1f, 1.9f, 3.2f, 3.9f, 5.1f};
uint8_t used = 6;
static float state[2];
static float p[2][2] = {{1, 0}, {0, 1}};

static void multiply(float a[2][2], float b[2][2], float out[2][2])
{
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) {
            out[i][j] = 0;
            for (int k = 0; k < 2; k++)
                out[i][j] += a[i][k] * b[k][j];
        }
}

static void predict(float dt)
{
    float f[2][2] = {{1, dt}, {0, 1}}, ft[2][2] = {{1, 0}, {dt, 1}}, t[2][2];

    state[0] += dt * state[1];
    multiply(f, p, t);
    multiply(t, ft, p);
    p[0][0] += 0.001f;
    p[1][1] += 0.001f;
}

static void correct(float z)
{
    float s = p[0][0] + 0.1f;
    float k0 = p[0][0] / s, k1 = p[1][0] / s, error = z - state[0];

    state[0] += k0 * error;
    state[1] += k1 * error;
    p[1][0] -= k1 * p[0][0];
    p[1][1] -= k1 * p[0][1];
    p[0][0] *= 1 - k0;
    p[0][1] *= 1 - k0;
}

int run(void)
{
    for (uint8_t i = 0; i < used; i++) {
        predict(0.02f);
        correct(positions[i]);
    }
    return state[0] > 0 ? 1 : 0;
}

int main(void)
{
    return run();
}
