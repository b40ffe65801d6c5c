/* entry: run; inputs: image any, threshold any */
#include <stdint.h>
#include <stdlib.h>

#define WIDTH 16
#define HEIGHT 12

uint8_t image[HEIGHT][WIDTH] = {{9, 9, 9, 200, 210, 220}, {8, 9, 10, 190, 220, 230}, {9, 9, 9, 210, 215, 200}};
uint16_t threshold = 255;
static uint8_t edges[HEIGHT][WIDTH];
static const int8_t across[3][3] = {{-1, 0, 1}, {-2, 0, 2}, {-1, 0, 1}};

int run(void)
{
    int marked = 0, top = HEIGHT;

    for (int y = 1; y < HEIGHT - 1; y++) {
        uint8_t *out = &edges[y][1];
        for (const uint8_t *p = &image[y][1]; p != &image[y][WIDTH - 1]; p++, out++) {
            int gx = 0, gy = 0;
            for (int dy = -1; dy <= 1; dy++)
                for (int dx = -1; dx <= 1; dx++) {
                    gx += across[dy + 1][dx + 1] * p[dy * WIDTH + dx];
                    gy += across[dx + 1][dy + 1] * p[dy * WIDTH + dx];
                }
            int sum = abs(gx) + abs(gy);
            *out = sum > 255 ? 255 : (uint8_t)sum;
            if (sum > threshold) {
                marked++;
                if (y < top)
                    top = y;
            }
        }
    }
    while (top < HEIGHT - 1 && marked > 0) {
        int x = WIDTH - 2;
        while (x > 0 && edges[top][x] < 128)
            x--;
        if (x == 0)
            break;
        top++;
    }
    return marked << 8 | top;
}

int main(void)
{
    return run();
}
