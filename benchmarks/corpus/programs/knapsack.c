/* entry: run; inputs: weights each 1B 1..20, values any, capacity 0..60 */
#include <stdint.h>

#define ITEMS 10
#define MOST 60

uint8_t weights[ITEMS] = {5, 9, 12, 3, 7, 20, 1, 16, 8, 2};
uint8_t values[ITEMS] = {10, 20, 25, 4, 13, 41, 1, 30, 15, 3};
uint8_t capacity = 40;
static uint16_t best[MOST + 1];
static uint32_t taken[MOST + 1];

int run(void)
{
    for (unsigned c = 0; c <= capacity; c++)
        best[c] = taken[c] = 0;
    for (unsigned i = 0; i < ITEMS; i++)
        for (int c = capacity; c >= weights[i]; c--) {
            uint16_t with = best[c - weights[i]] + values[i];
            if (with > best[c]) {
                best[c] = with;
                taken[c] = taken[c - weights[i]] | 1u << i;
            }
        }
    uint32_t set = taken[capacity];
    int chosen = 0;
    while (set) {
        set &= set - 1;
        chosen++;
    }
    return best[capacity] << 8 | chosen;
}

int main(void)
{
    return run();
}
