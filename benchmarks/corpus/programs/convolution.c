/* entry: run; inputs: image any */
#include <stdint.h>

#define W 12
#define H 10
uint8_t image[H][W] = {{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}, {50, 60, 70, 80, 90}};
static uint8_t edges[H][W];
static const int8_t kernel[3][3] = {{-1, -1, -1}, {-1, 8, -1}, {-1, -1, -1}};

int run(void)
{
    uint32_t sum = 0;
    for (uint8_t y = 1; y < H - 1; y++) {
        for (uint8_t x = 1; x < W - 1; x++) {
            int value = 0;
            for (int8_t dy = -1; dy <= 1; dy++)
                for (int8_t dx = -1; dx <= 1; dx++)
                    value += kernel[dy + 1][dx + 1] * image[y + dy][x + dx];
            if (value < 0)
                value = 0;
            edges[y][x] = value > 255 ? 255 : (uint8_t)value;
            sum += edges[y][x];
        }
    }
    return (int)(sum / ((W - 2) * (H - 2)));
}

int main(void)
{
    return run();
}
