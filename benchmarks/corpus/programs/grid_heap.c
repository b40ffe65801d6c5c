/* entry: run; inputs: terrain each 1B 1..9 */
#include <stdint.h>
#include <string.h>

/* Cheapest way from corner to corner of a grid: Dijkstra with a binary heap that tracks positions (decrease key). */
#define W 7
#define H 6
#define NODES (W * H)
#define UNSEEN 0xFFFF

uint8_t terrain[H][W] = {{1, 1, 9, 1, 1, 1, 1}, {9, 1, 9, 1, 9, 9, 1}, {9, 1, 1, 1, 9, 1, 1},
                         {9, 9, 9, 9, 9, 1, 9}, {1, 1, 1, 1, 1, 1, 9}, {1, 9, 9, 9, 9, 9, 1}};
static uint16_t distance[NODES];
static uint8_t heap[NODES], place[NODES], used;

static void put(uint8_t at, uint8_t node)
{
    heap[at] = node;
    place[node] = at;
}

static void up(uint8_t at)
{
    uint8_t node = heap[at];
    while (at) {
        uint8_t above = (at - 1) >> 1;
        if (distance[heap[above]] <= distance[node])
            break;
        put(at, heap[above]);
        at = above;
    }
    put(at, node);
}

static uint8_t pop(void)
{
    uint8_t first = heap[0], node = heap[--used];
    unsigned at = 0, child;

    while ((child = 2 * at + 1) < used) {
        if (child + 1 < used && distance[heap[child + 1]] < distance[heap[child]])
            child++;
        if (distance[heap[child]] >= distance[node])
            break;
        put((uint8_t)at, heap[child]);
        at = child;
    }
    if (used)
        put((uint8_t)at, node);
    return first;
}

static void relax(uint8_t node, uint16_t through)
{
    uint16_t d = through + ((const uint8_t *)terrain)[node];
    if (d >= distance[node])
        return;
    if (distance[node] == UNSEEN)
        put(used++, node);
    distance[node] = d;
    up(place[node]);
}

int run(void)
{
    memset(distance, 0xFF, sizeof distance);
    used = 0;
    relax(0, 0);
    while (used) {
        uint8_t node = pop();
        uint8_t x = node % W, y = node / W;
        if (node == NODES - 1)
            break;
        if (x > 0)
            relax(node - 1, distance[node]);
        if (x + 1 < W)
            relax(node + 1, distance[node]);
        if (y > 0)
            relax(node - W, distance[node]);
        if (y + 1 < H)
            relax(node + W, distance[node]);
    }
    return distance[NODES - 1];
}

int main(void)
{
    return run();
}
