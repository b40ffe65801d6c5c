/* entry: run; inputs: key any */
#include <stdint.h>

#define N 48
uint32_t key = 700;
static uint32_t ladder[N];

static int search(uint32_t wanted)
{
    int low = 0, high = N - 1;

    while (low < high && wanted >= ladder[low] && wanted <= ladder[high]) {
        uint32_t span = ladder[high] - ladder[low];
        int middle;
        if (span == 0)
            break;
        middle = low + (int)((uint64_t)(wanted - ladder[low]) * (uint32_t)(high - low) / span);
        if (ladder[middle] == wanted)
            return middle;
        if (ladder[middle] < wanted)
            low = middle + 1;
        else
            high = middle - 1;
    }
    return ladder[low] == wanted ? low : -1;
}

int run(void)
{
    uint32_t value = 5;
    for (int i = 0; i < N; i++) {
        ladder[i] = value;
        value += 7 + (uint32_t)(i % 5) * 9;
    }
    return search(key);
}

int main(void)
{
    return run();
}
