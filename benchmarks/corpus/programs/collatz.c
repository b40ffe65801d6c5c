/* entry: run; inputs: seeds any */
#include <stdint.h>

uint16_t seeds[10] = {27, 97, 871, 1, 2, 3};
static uint16_t longest;

int run(void)
{
    for (int i = 0; i < 10; i++) {
        uint32_t v = seeds[i];
        uint16_t steps = 0;
        while (v > 1 && steps < 150) {
            v = v & 1 ? 3 * v + 1 : v / 2;
            steps++;
        }
        if (steps > longest)
            longest = steps;
    }
    return longest;
}

int main(void)
{
    return run();
}
