/* entry: run; inputs: edges any */
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Order of ten modules by what they need: counts of arrows and a queue; then a search for a cycle with an own stack. */
#define N 10

uint16_t edges[N] = {0x006, 0x008, 0x018, 0x020, 0x020, 0x040, 0x000, 0x040, 0x100, 0x180};
static uint8_t order[N];

static int sort(void)
{
    uint8_t incoming[N] = {0}, queue[N], *head = queue, *tail = queue;
    int done = 0;

    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++)
            if (edges[i] >> k & 1)
                incoming[k]++;
    for (uint8_t i = 0; i < N; i++)
        if (!incoming[i])
            *tail++ = i;
    while (head != tail) {
        uint8_t node = *head++;
        order[done++] = node;
        for (uint16_t left = edges[node] & ((1 << N) - 1); left; left &= left - 1) {
            uint8_t k = 0;
            while (!(left >> k & 1))
                k++;
            if (--incoming[k] == 0)
                *tail++ = k;
        }
    }
    return done;
}

static bool cyclic(void)
{
    uint8_t colour[N], stack[N], next[N];
    memset(colour, 0, sizeof colour);
    for (uint8_t root = 0; root < N; root++) {
        int top = 0;
        if (colour[root])
            continue;
        stack[0] = root;
        next[0] = 0;
        colour[root] = 1;
        while (top >= 0) {
            uint8_t node = stack[top];
            if (next[top] == N) {
                colour[node] = 2;
                top--;
                continue;
            }
            uint8_t k = next[top]++;
            if (!(edges[node] >> k & 1))
                continue;
            if (colour[k] == 1)
                return true;
            if (colour[k] == 0) {
                colour[k] = 1;
                top++;
                stack[top] = k;
                next[top] = 0;
            }
        }
    }
    return false;
}

int run(void)
{
    return sort() << 1 | cyclic();
}

int main(void)
{
    return run();
}
