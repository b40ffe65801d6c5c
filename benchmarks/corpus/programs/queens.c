/* entry: run; inputs: size 1..5 */
#include <stdint.h>

uint8_t size = 5;

/* Solutions by depth-first search with bit masks; the stack is explicit. */
int run(void)
{
    uint8_t columns[8], left[8], right[8], open[8];
    uint8_t all = (uint8_t)((1 << size) - 1);
    int depth = 0, solutions = 0;

    columns[0] = left[0] = right[0] = 0;
    open[0] = all;
    while (depth >= 0) {
        if (open[depth] == 0) {
            depth--;
            continue;
        }
        uint8_t queen = open[depth] & -open[depth];
        open[depth] &= ~queen;
        if (depth + 1 == size) {
            solutions++;
            continue;
        }
        columns[depth + 1] = columns[depth] | queen;
        left[depth + 1] = (uint8_t)((left[depth] | queen) << 1);
        right[depth + 1] = (right[depth] | queen) >> 1;
        depth++;
        open[depth] = all & ~(columns[depth] | left[depth] | right[depth]);
    }
    return solutions;
}

int main(void)
{
    return run();
}
