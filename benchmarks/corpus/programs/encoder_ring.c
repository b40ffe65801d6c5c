/* entry: run; inputs: ports any */
#include <stdint.h>

/* Quadrature edges from a port that a timer samples into a buffer by turns; speed from a window, glitches counted. */
#define SAMPLES 96
#define WINDOW 12

uint8_t ports[SAMPLES] = {0, 1, 3, 2, 0, 1, 3, 2, 0, 2, 3, 1, 0, 3, 0};
static const int8_t change[16] = {0, 1, -1, 2, -1, 0, 2, 1, 1, 2, 0, -1, 2, -1, 1, 0};
static int8_t history[WINDOW];
static int16_t position, fastest;
static uint16_t glitches;

int run(void)
{
    uint8_t before = ports[0] & 3, slot = 0;
    int16_t speed = 0;
    const uint8_t *p = ports;
    uint8_t quiet = 0;

    while (++p < &ports[SAMPLES]) {
        uint8_t now = *p & 3;
        int8_t step = change[before << 2 | now];
        if (step == 2) {
            glitches++;
            step = 0;
        }
        speed += step - history[slot];
        history[slot] = step;
        slot = (uint8_t)((slot + 1) % WINDOW);
        position += step;
        int16_t size = speed < 0 ? -speed : speed;
        if (size > fastest)
            fastest = size;
        quiet = step ? 0 : quiet + 1;
        if (quiet > 40) {
            do
                history[--quiet % WINDOW] = 0;
            while (quiet > 40 - WINDOW);
            speed = 0;
            quiet = 0;
        }
        before = now;
    }
    return position * 1000 + fastest + (int)glitches;
}

int main(void)
{
    return run();
}
