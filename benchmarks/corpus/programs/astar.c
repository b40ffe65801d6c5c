/* entry: run; inputs: walls any, from 0..63, to 0..63 */
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

/* The way through an 8 x 8 room, the open cells in a list without order; walls are bits. */
#define SIDE 8
#define CELLS (SIDE * SIDE)
#define NOWHERE 0xFF

uint8_t walls[SIDE] = {0x00, 0x7C, 0x04, 0x74, 0x10, 0x57, 0x40, 0x00};
uint8_t from = 0, to = 27;
static uint8_t cost[CELLS], parent[CELLS], open[CELLS], opened;
static uint8_t way[CELLS];

static uint8_t guess(uint8_t a)
{
    return (uint8_t)(abs(a % SIDE - to % SIDE) + abs(a / SIDE - to / SIDE));
}

static uint8_t take_best(void)
{
    uint8_t best = 0;
    for (uint8_t i = 1; i < opened; i++)
        if (cost[open[i]] + guess(open[i]) < cost[open[best]] + guess(open[best]))
            best = i;
    uint8_t cell = open[best];
    open[best] = open[--opened];
    return cell;
}

static int search(void)
{
    static const int8_t dx[4] = {1, -1, 0, 0}, dy[4] = {0, 0, 1, -1};

    memset(cost, NOWHERE, sizeof cost);
    memset(parent, NOWHERE, sizeof parent);
    cost[from] = 0;
    open[0] = from;
    opened = 1;
    while (opened) {
        uint8_t cell = take_best();
        if (cell == to)
            return 1;
        for (unsigned d = 0; d < 4; d++) {
            int x = cell % SIDE + dx[d], y = cell / SIDE + dy[d];
            if (x < 0 || y < 0 || x >= SIDE || y >= SIDE || walls[y] >> x & 1)
                continue;
            uint8_t next = (uint8_t)(y * SIDE + x);
            if (cost[next] != NOWHERE)
                continue;
            cost[next] = cost[cell] + 1;
            parent[next] = cell;
            open[opened++] = next;
        }
    }
    return 0;
}

int run(void)
{
    uint8_t length = 0;
    if (!search())
        return -1;
    for (uint8_t cell = to; cell != NOWHERE && length < CELLS; cell = parent[cell])
        way[length++] = cell;
    for (uint8_t i = 0, k = length; i + 1 < k--; i++) {
        uint8_t t = way[i];
        way[i] = way[k];
        way[k] = t;
    }
    return length;
}

int main(void)
{
    return run();
}
