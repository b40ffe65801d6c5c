/* entry: run; inputs: a any */
#include <stdint.h>

#define COUNT 50
int32_t a[COUNT] = {62, 83, 18, 53, 7, 17, 95, 86, 47, 69, 25, 28};

int run(void)
{
    static const uint8_t gaps[] = {23, 10, 4, 1};

    for (unsigned g = 0; g < sizeof gaps; g++) {
        int gap = gaps[g];
        for (int i = gap; i < COUNT; i++) {
            int32_t v = a[i];
            int j;
            for (j = i; j >= gap && a[j - gap] > v; j -= gap)
                a[j] = a[j - gap];
            a[j] = v;
        }
    }
    return a[COUNT - 1];
}

int main(void)
{
    return run();
}
