/* entry: run; inputs: text any */
#include <stdint.h>
#include <string.h>

/* Code lengths from the frequencies of sixteen symbols: the two smallest are joined until one is left. */
#define SYMBOLS 16

uint8_t text[80] = {1, 1, 2, 3, 5, 8, 13, 1, 1, 0, 0, 0, 0, 2, 2, 9, 9, 15, 15, 15};
static uint16_t weight[2 * SYMBOLS];
static uint8_t parent[2 * SYMBOLS], lengths[SYMBOLS];
static uint16_t codes[SYMBOLS];

static int smallest(int nodes, int except)
{
    int best = -1;
    for (int i = 0; i < nodes; i++)
        if (weight[i] && !parent[i] && i != except && (best < 0 || weight[i] < weight[best]))
            best = i;
    return best;
}

int run(void)
{
    int nodes = SYMBOLS, longest = 0;

    memset(weight, 0, sizeof weight);
    memset(parent, 0, sizeof parent);
    for (unsigned i = 0; i < sizeof text; i++)
        weight[text[i] & 15]++;
    for (;;) {
        int a = smallest(nodes, -1), b = smallest(nodes, a);
        if (b < 0)
            break;
        weight[nodes] = weight[a] + weight[b];
        parent[a] = parent[b] = (uint8_t)nodes++;
    }
    for (int i = 0; i < SYMBOLS; i++) {
        uint8_t length = 0;
        for (uint8_t up = parent[i]; up; up = parent[up])
            length++;
        lengths[i] = length;
        if (length > longest)
            longest = length;
    }
    uint16_t code = 0;
    for (int length = 1; length <= longest; length++) {
        for (int i = 0; i < SYMBOLS; i++)
            if (lengths[i] == length)
                codes[i] = code++;
        code <<= 1;
    }
    uint32_t bits = 0;
    for (const uint8_t *p = text; p != text + sizeof text; p++)
        bits += lengths[*p & 15];
    return (int)bits + codes[1];
}

int main(void)
{
    return run();
}
