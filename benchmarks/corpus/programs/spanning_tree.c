/* entry: run; inputs: edges each 1B 0..11, used 0..20 */
#include <stdint.h>

/* A least spanning tree: edges sorted, sets joined by rank with paths halved. */
#define NODES 12

struct edge {
    uint8_t a, b, weight;
};

struct edge edges[20] = {{0, 1, 4}, {1, 2, 8}, {2, 3, 7}, {3, 4, 9}, {4, 5, 10}, {5, 6, 2}, {6, 7, 1}, {7, 8, 7}};
uint8_t used = 8;
static uint8_t parent[NODES], rank[NODES];

static uint8_t find(uint8_t x)
{
    while (parent[x] != x) {
        parent[x] = parent[parent[x]];
        x = parent[x];
    }
    return x;
}

static int join(uint8_t a, uint8_t b)
{
    a = find(a);
    b = find(b);
    if (a == b)
        return 0;
    if (rank[a] < rank[b]) {
        parent[a] = b;
    } else {
        parent[b] = a;
        if (rank[a] == rank[b])
            rank[a]++;
    }
    return 1;
}

int run(void)
{
    int total = 0, sets = NODES;

    for (uint8_t i = 0; i < NODES; i++) {
        parent[i] = i;
        rank[i] = 0;
    }
    for (int gap = 7; gap > 0; gap = gap > 1 ? gap / 2 : 0)
        for (int i = gap; i < used; i++) {
            struct edge e = edges[i];
            int k = i;
            for (; k >= gap && edges[k - gap].weight > e.weight; k -= gap)
                edges[k] = edges[k - gap];
            edges[k] = e;
        }
    for (const struct edge *e = edges, *end = edges + used; e < end && sets > 1; e++)
        if (join(e->a, e->b)) {
            total += e->weight;
            sets--;
        }
    return total << 8 | sets;
}

int main(void)
{
    return run();
}
