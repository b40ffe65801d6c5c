/* entry: run; inputs: measured any, steps 0..40 */
#include <math.h>
#include <stdint.h>

struct pid {
    float kp, ki, kd;
    float integral, last, limit;
};

float measured[40] = {0.0f, 0.1f, 0.25f, 0.5f, 0.7f, 0.9f, 1.05f, 1.1f, 1.02f, 0.98f};
uint8_t steps = 10;
static struct pid loop = {1.2f, 0.4f, 0.05f, 0.0f, 0.0f, 3.0f};
float outputs[40];

static float clamp(float x, float limit)
{
    return x > limit ? limit : x < -limit ? -limit : x;
}

static float update(struct pid *c, float wanted, float seen, float dt)
{
    float error = wanted - seen;
    float slope = (error - c->last) / dt;

    c->integral = clamp(c->integral + error * dt, c->limit);
    c->last = error;
    return clamp(c->kp * error + c->ki * c->integral + c->kd * slope, c->limit);
}

int run(void)
{
    double energy = 0.0;
    for (int i = 0; i < steps; i++) {
        outputs[i] = update(&loop, 1.0f, measured[i], 0.01f);
        energy += (double)outputs[i] * outputs[i];
    }
    return (int)sqrt(energy);
}

int main(void)
{
    return run();
}
