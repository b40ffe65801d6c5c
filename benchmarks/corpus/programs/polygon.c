/* entry: run; inputs: corners each 2B -1000..1000, n 3..12, px -1000..1000, py -1000..1000 */
#include <stdbool.h>
#include <stdint.h>

int16_t corners[12][2] = {{0, 0}, {100, 0}, {120, 60}, {60, 120}, {-20, 80}};
uint8_t n = 5;
int16_t px = 40, py = 40;

static bool inside(int x, int y)
{
    bool in = false;
    for (int i = 0, j = n - 1; i < n; j = i++) {
        int xi = corners[i][0], yi = corners[i][1], xj = corners[j][0], yj = corners[j][1];
        if ((yi > y) != (yj > y) && x < (xj - xi) * (y - yi) / (yj - yi) + xi)
            in = !in;
    }
    return in;
}

static int32_t doubled_area(void)
{
    int32_t sum = 0;
    for (uint8_t i = 0; i < n; i++) {
        uint8_t k = (i + 1) % n;
        sum += (int32_t)corners[i][0] * corners[k][1] - (int32_t)corners[k][0] * corners[i][1];
    }
    return sum;
}

int run(void)
{
    return inside(px, py) ? (int)doubled_area() : 0;
}

int main(void)
{
    return run();
}
