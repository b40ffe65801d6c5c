/* entry: run; inputs: angles each 2B -16384..16384 */
#include <stdint.h>

#define STEPS 14
static const int16_t arctangents[STEPS] = {8192, 4836, 2555, 1297, 651, 326, 163, 81, 41, 20, 10, 5, 3, 1};
int16_t angles[16] = {0, 8192, -8192, 4000, -3000, 16000, -16000, 12};
static int16_t sines[16], cosines[16];

static void rotate(int16_t angle, int16_t *cosine, int16_t *sine)
{
    int32_t x = 19898, y = 0, z = angle;
    for (uint8_t i = 0; i < STEPS; i++) {
        int32_t dx = x >> i, dy = y >> i;
        if (z >= 0) {
            x -= dy;
            y += dx;
            z -= arctangents[i];
        } else {
            x += dy;
            y -= dx;
            z += arctangents[i];
        }
    }
    *cosine = (int16_t)x;
    *sine = (int16_t)y;
}

int run(void)
{
    for (int i = 0; i < 16; i++)
        rotate(angles[i], &cosines[i], &sines[i]);
    return sines[3];
}

int main(void)
{
    return run();
}
