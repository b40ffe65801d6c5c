/* entry: run; inputs: data any */
#include <stdint.h>

/* A balanced sum over a tree in an array, and a bounded descent: recursion with a depth that the code limits. */
int16_t data[31] = {1, 2, 3, 4, 5, 6, 7, 8, 9};

static int32_t tree_sum(unsigned node)
{
    if (node >= 31)
        return 0;
    return data[node] + tree_sum(2 * node + 1) + tree_sum(2 * node + 2);
}

static unsigned descend(unsigned level, int32_t value)
{
    if (level == 8 || value == 0)
        return level;
    return descend(level + 1, value / 3);
}

int run(void)
{
    return (int)(tree_sum(0) + (int32_t)descend(0, data[0]));
}

int main(void)
{
    return run();
}
