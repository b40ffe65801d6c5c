/* entry: run; inputs: block any */
#include <stdint.h>

int16_t block[8][8] = {{16, 11, 10, 16, 24, 40, 51, 61}, {12, 12, 14, 19, 26, 58, 60, 55}};
static int32_t temp[8][8];
static const int16_t basis[8] = {4096, 5681, 5352, 4816, 4096, 3218, 2217, 1130};
static const uint8_t zigzag[64] = {
    0,  1,  8,  16, 9,  2,  3,  10, 17, 24, 32, 25, 18, 11, 4,  5,  12, 19, 26, 33, 40, 48,
    41, 34, 27, 20, 13, 6,  7,  14, 21, 28, 35, 42, 49, 56, 57, 50, 43, 36, 29, 22, 15, 23,
    30, 37, 44, 51, 58, 59, 52, 45, 38, 31, 39, 46, 53, 60, 61, 54, 47, 55, 62, 63};

static int32_t cosine(int k, int n)
{
    int angle = (2 * n + 1) * k % 32;
    int sign = 1;
    if (angle > 16)
        angle = 32 - angle;
    if (angle > 8) {
        angle = 16 - angle;
        sign = -1;
    }
    return angle == 8 ? 0 : sign * basis[angle];
}

int run(void)
{
    for (int row = 0; row < 8; row++)
        for (int k = 0; k < 8; k++) {
            int32_t sum = 0;
            for (int n = 0; n < 8; n++)
                sum += cosine(k, n) * block[row][n];
            temp[row][k] = sum >> 13;
        }
    for (int column = 0; column < 8; column++)
        for (int k = 0; k < 8; k++) {
            int32_t sum = 0;
            for (int n = 0; n < 8; n++)
                sum += cosine(k, n) * temp[n][column];
            block[k][column] = (int16_t)(sum >> 13);
        }
    int zeros = 0, last = 63;
    while (last > 0 && ((int16_t *)block)[zigzag[last]] / 16 == 0) {
        last--;
        zeros++;
    }
    return zeros;
}

int main(void)
{
    return run();
}
