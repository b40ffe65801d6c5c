/* entry: run; inputs: input any */
#include <stdint.h>

/* Two second-order sections in Q14, direct form I. */
struct section {
    int16_t b0, b1, b2, a1, a2;
    int32_t x1, x2, y1, y2;
};

int16_t input[48] = {0, 8000, 8000, 8000, 8000, -4000, -4000, 0, 0, 0, 120, 90, -7};
int16_t output[48];
static struct section sections[2] = {
    {1106, 2212, 1106, -18727, 6763, 0, 0, 0, 0},
    {16384, -32767, 16384, -29000, 13000, 0, 0, 0, 0},
};

static int32_t step(struct section *s, int32_t x)
{
    int32_t y = s->b0 * x + s->b1 * s->x1 + s->b2 * s->x2 - s->a1 * s->y1 - s->a2 * s->y2;

    y >>= 14;
    s->x2 = s->x1;
    s->x1 = x;
    s->y2 = s->y1;
    s->y1 = y;
    return y;
}

int run(void)
{
    const int16_t *in = input;
    int16_t *out = output, *const end = output + sizeof output / sizeof output[0];

    while (out < end) {
        int32_t value = *in++;
        for (struct section *s = sections; s != sections + 2; s++)
            value = step(s, value);
        *out++ = (int16_t)value;
    }
    return output[47];
}

int main(void)
{
    return run();
}
