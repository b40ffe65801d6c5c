/* entry: run; inputs: grades each 1B 0..15 */
#include <stdint.h>

#define N 60
uint8_t grades[N] = {3, 7, 15, 0, 2, 2, 9, 11, 4, 4, 4, 8, 1, 0, 6};
static uint8_t sorted[N];

int run(void)
{
    uint8_t counts[16] = {0};
    uint8_t at = 0;

    for (int i = 0; i < N; i++)
        counts[grades[i]]++;
    for (uint8_t value = 0; value < 16; value++)
        while (counts[value]-- > 0 && at < N)
            sorted[at++] = value;
    return sorted[N / 2];
}

int main(void)
{
    return run();
}
