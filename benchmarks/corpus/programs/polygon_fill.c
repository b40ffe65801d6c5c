/* entry: run; inputs: corners each 1B 0..31, used 3..8 */
#include <stdint.h>

/* A polygon filled line by line: crossings sorted, pixels between pairs set in a bit map; then a circle. */
#define SIZE 32

struct point {
    uint8_t x, y;
};

struct point corners[8] = {{2, 2}, {28, 6}, {30, 20}, {14, 30}, {16, 16}, {4, 24}};
uint8_t used = 6;
static uint32_t screen[SIZE];

static void span(int y, int from, int to)
{
    while (from < to)
        screen[y] |= 1u << from++;
}

static void fill(const struct point *c, int n)
{
    for (int y = 0; y < SIZE; y++) {
        int crossings[8], found = 0;
        for (int i = 0, k = n - 1; i < n; k = i++) {
            int y0 = c[i].y, y1 = c[k].y;
            if ((y0 <= y && y1 > y) || (y1 <= y && y0 > y))
                crossings[found++] = c[i].x + (y - y0) * (c[k].x - c[i].x) / (y1 - y0);
        }
        int i = 0;
        while (i + 1 < found) {
            if (crossings[i] > crossings[i + 1]) {
                int t = crossings[i];
                crossings[i] = crossings[i + 1];
                crossings[i + 1] = t;
                if (i)
                    i--;
            } else {
                i++;
            }
        }
        for (i = 0; i + 1 < found; i += 2)
            span(y, crossings[i], crossings[i + 1]);
    }
}

static void circle(int cx, int cy, int r)
{
    int x = r, y = 0, error = 1 - r;
    while (x >= y) {
        if (cy + y < SIZE && cx + x < SIZE)
            screen[cy + y] |= 1u << (cx + x);
        if (cy >= x && cx >= y)
            screen[cy - x] ^= 1u << (cx - y);
        y++;
        if (error < 0) {
            error += 2 * y + 1;
        } else {
            x--;
            error += 2 * (y - x) + 1;
        }
    }
}

int run(void)
{
    int set = 0;
    fill(corners, used);
    circle(16, 16, corners[0].x / 2);
    for (uint32_t *row = screen; row < screen + SIZE; row++)
        for (uint32_t bits = *row; bits; bits >>= 1)
            set += bits & 1;
    return set;
}

int main(void)
{
    return run();
}
