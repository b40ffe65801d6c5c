/* entry: run; inputs: m any, order 1..6 */
#include <stdint.h>

int32_t m[6][6] = {{900, 100, 50, 0, 0, 0}, {100, 800, 90, 10, 0, 0}, {50, 90, 700, 20, 0, 0},
                   {0, 10, 20, 600, 5, 0}, {0, 0, 0, 5, 500, 9}, {0, 0, 0, 0, 9, 400}};
uint32_t order = 6;
static int32_t l[6][6];

static uint32_t root(uint32_t value)
{
    uint32_t result = 0, bit = 1u << 30;

    while (bit > value)
        bit >>= 2;
    while (bit != 0) {
        if (value >= result + bit) {
            value -= result + bit;
            result = (result >> 1) + bit;
        } else {
            result >>= 1;
        }
        bit >>= 2;
    }
    return result;
}

int run(void)
{
    for (uint32_t i = 0; i < order; i++) {
        for (uint32_t j = 0; j <= i; j++) {
            int32_t sum = m[i][j] * 16;
            for (uint32_t k = 0; k < j; k++)
                sum -= l[i][k] * l[j][k];
            if (i == j) {
                if (sum <= 0)
                    return -1;
                l[i][i] = (int32_t)root((uint32_t)sum);
            } else {
                l[i][j] = l[j][j] ? sum / l[j][j] : 0;
            }
        }
    }
    return l[order - 1][order - 1];
}

int main(void)
{
    return run();
}
