/* entry: run; inputs: samples each 2B -2000..2000, target -1000..1000, periods 0..50 */
#include <stdbool.h>
#include <stdint.h>

/* Position over speed, Q8 gains, anti-windup by back-calculation; the inner controller runs four times per period. */
typedef int32_t q8_t;

typedef struct {
    q8_t kp, ki, kd, kaw;
    int32_t integral, previous, low, high;
    bool saturated;
} controller_t;

int16_t samples[50] = {0, 10, 40, 90, 150, 220, 300, 370, 430, 480, 510, 520};
int16_t target = 500;
uint8_t periods = 12;

static controller_t position = {.kp = 384, .ki = 12, .kd = 64, .kaw = 128, .low = -300, .high = 300};
static controller_t speed = {.kp = 512, .ki = 96, .kd = 0, .kaw = 64, .low = -1023, .high = 1023};
static volatile int32_t pwm;
static uint16_t saturations;

static int32_t step(controller_t *c, int32_t error)
{
    int32_t raw = (c->kp * error + c->integral + c->kd * (error - c->previous)) >> 8;
    int32_t out = raw;

    if (out > c->high)
        out = c->high;
    else if (out < c->low)
        out = c->low;
    c->saturated = out != raw;
    c->integral += c->ki * error + c->kaw * (out - raw);
    c->previous = error;
    return out;
}

static void reset(controller_t *c)
{
    c->integral = 0;
    c->previous = 0;
    c->saturated = false;
}

int run(void)
{
    int32_t last = samples[0], ramped = last;
    const int16_t *p = samples;

    reset(&position);
    reset(&speed);
    for (uint8_t left = periods; left; left--) {
        int32_t now = *p++, wanted, substep = 4;

        if (ramped < target)
            ramped += target - ramped > 25 ? 25 : target - ramped;
        else if (ramped > target)
            ramped -= ramped - target > 25 ? 25 : ramped - target;
        wanted = step(&position, ramped - now);
        do {
            int32_t moved = (now - last) * (5 - substep) / 4;
            pwm = step(&speed, wanted - moved);
            if (speed.saturated)
                saturations++;
        } while (--substep);
        last = now;
    }
    return pwm + (int)(saturations << 16);
}

int main(void)
{
    return run();
}
