/* entry: run; inputs: picture any, width 2..20, height 2..14 */
#include <stdint.h>

/* Bilinear scaling of a small picture to a wanted size, Q8 steps; then dithering to one bit by error diffusion. */
#define SOURCE_W 10
#define SOURCE_H 8
#define MOST_W 20
#define MOST_H 14

uint8_t picture[SOURCE_H * SOURCE_W] = {0, 10, 20, 30, 40, 50, 60, 70, 80, 90, 5, 15, 25, 35, 45, 55, 65, 75, 85, 95};
uint8_t width = 17, height = 11;
static uint8_t scaled[MOST_H * MOST_W];
static uint8_t bits[MOST_H][(MOST_W + 7) / 8];

static void scale(void)
{
    uint32_t step_x = ((SOURCE_W - 1) << 8) / (width - 1u), step_y = ((SOURCE_H - 1) << 8) / (height - 1u);
    uint8_t *out = scaled;
    uint32_t y = 0;

    for (uint8_t row = 0; row < height; row++, y += step_y) {
        uint32_t x = 0, fy = y & 0xFF;
        const uint8_t *above = picture + (y >> 8) * SOURCE_W;
        const uint8_t *below = (y >> 8) < SOURCE_H - 1 ? above + SOURCE_W : above;
        uint8_t left = width;
        do {
            uint32_t at = x >> 8, fx = x & 0xFF, next = at < SOURCE_W - 1 ? at + 1 : at;
            uint32_t a = above[at] * (256 - fx) + above[next] * fx;
            uint32_t b = below[at] * (256 - fx) + below[next] * fx;
            *out++ = (uint8_t)((a * (256 - fy) + b * fy) >> 16);
            x += step_x;
        } while (--left);
    }
}

static int dither(void)
{
    int16_t error[MOST_W + 2] = {0};
    int set = 0;

    for (int row = 0; row < height; row++) {
        int16_t carried = 0;
        for (int x = 0; x < width; x++) {
            int16_t v = scaled[row * width + x] + error[x + 1] + carried;
            int16_t rest = v;
            if (v >= 128) {
                bits[row][x >> 3] |= (uint8_t)(0x80 >> (x & 7));
                rest -= 255;
                set++;
            }
            carried = rest / 2;
            error[x + 1] = rest - carried;
        }
    }
    return set;
}

int run(void)
{
    scale();
    return dither();
}

int main(void)
{
    return run();
}
