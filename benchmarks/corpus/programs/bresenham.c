/* entry: run; inputs: from_x 0..63, from_y 0..31, to_x 0..63, to_y 0..31 */
#include <stdint.h>
#include <stdlib.h>

int8_t from_x = 3, from_y = 2, to_x = 50, to_y = 28;
static uint8_t screen[32][8];

static void plot(int x, int y)
{
    screen[y][x >> 3] |= (uint8_t)(0x80 >> (x & 7));
}

int run(void)
{
    int x = from_x, y = from_y;
    int dx = abs(to_x - x), dy = -abs(to_y - y);
    int sx = x < to_x ? 1 : -1, sy = y < to_y ? 1 : -1;
    int error = dx + dy, dots = 0;

    for (;;) {
        plot(x, y);
        dots++;
        if (x == to_x && y == to_y)
            break;
        int twice = 2 * error;
        if (twice >= dy) {
            error += dy;
            x += sx;
        }
        if (twice <= dx) {
            error += dx;
            y += sy;
        }
    }
    return dots;
}

int main(void)
{
    return run();
}
