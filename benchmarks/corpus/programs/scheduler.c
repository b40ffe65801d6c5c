/* entry: run; inputs: ticks 0..60 */
#include <stdint.h>

struct task {
    void (*body)(void);
    uint16_t period, left;
};

uint8_t ticks = 50;
static uint16_t blinks, samples, reports;
static int32_t average;

static void blink(void) { blinks ^= 1; }
static void sample(void)
{
    int32_t sum = 0;
    for (int i = 0; i < 4; i++)
        sum += (int32_t)(samples * 7 + (uint16_t)i * 3) & 0xFF;
    average += (sum / 4 - average) / 8;
    samples++;
}
static void report(void)
{
    uint32_t value = (uint32_t)average;
    do {
        reports++;
        value /= 10;
    } while (value && reports < 1000);
}

static struct task tasks[] = {{blink, 10, 10}, {sample, 3, 1}, {report, 20, 5}};

int run(void)
{
    for (uint8_t t = 0; t < ticks; t++) {
        for (struct task *k = tasks; k < tasks + sizeof tasks / sizeof *tasks; k++) {
            if (--k->left == 0) {
                k->left = k->period;
                k->body();
            }
        }
    }
    return blinks + samples + reports;
}

int main(void)
{
    return run();
}
