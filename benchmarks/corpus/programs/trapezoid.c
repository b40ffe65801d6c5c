/* entry: run; inputs: distance 0..2000, top_speed 1..200, acceleration 1..20 */
#include <stdint.h>

/* Steps of a motor: acceleration, cruise, deceleration, in ticks of a millisecond; Q8 speed. */
int32_t distance = 800, top_speed = 120, acceleration = 4;
static uint16_t ticks_up, ticks_flat, ticks_down;

static uint32_t root(uint32_t n)
{
    uint32_t result = 0, bit = 1u << 30;
    while (bit > n)
        bit >>= 2;
    while (bit) {
        if (n >= result + bit) {
            n -= result + bit;
            result = (result >> 1) + bit;
        } else {
            result >>= 1;
        }
        bit >>= 2;
    }
    return result;
}

int run(void)
{
    int32_t ramp = top_speed * top_speed / (2 * acceleration), peak = top_speed, gone = 0, speed = 0;

    if (2 * ramp > distance) {
        ramp = distance / 2;
        peak = (int32_t)root((uint32_t)(2 * acceleration * ramp));
    }
    while (speed < peak) {
        speed += acceleration;
        if (speed > peak)
            speed = peak;
        ticks_up++;
    }
    while (gone < distance - ramp && speed > 0) {
        gone += speed;
        ticks_flat++;
    }
    for (; speed > 0; speed -= acceleration)
        ticks_down++;
    return ticks_up + ticks_flat + ticks_down;
}

int main(void)
{
    return run();
}
