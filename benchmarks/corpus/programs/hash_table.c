/* entry: run; inputs: ids any, how_many 0..24 */
#include <stdint.h>

#define SLOTS 32
#define EMPTY 0

struct slot {
    uint16_t id;
    uint16_t hits;
};

uint16_t ids[24] = {17, 300, 17, 4, 5, 17, 300, 81, 81, 1000};
uint8_t how_many = 10;
static struct slot slots[SLOTS];

static uint32_t fnv(const uint8_t *p, unsigned n)
{
    uint32_t h = 2166136261u;
    for (unsigned i = 0; i < n; i++) {
        h ^= p[i];
        h *= 16777619u;
    }
    return h;
}

static struct slot *find(uint16_t id)
{
    uint32_t at = fnv((const uint8_t *)&id, sizeof id) & (SLOTS - 1);
    for (unsigned probe = 0; probe < SLOTS; probe++) {
        struct slot *s = &slots[at];
        if (s->id == id || s->id == EMPTY)
            return s;
        at = (at + 1) % SLOTS;
    }
    return 0;
}

int run(void)
{
    int best = 0;
    for (uint8_t i = 0; i < how_many; i++) {
        if (ids[i] == EMPTY)
            continue;
        struct slot *s = find(ids[i]);
        if (!s)
            return -1;
        s->id = ids[i];
        if (++s->hits > best)
            best = s->hits;
    }
    return best;
}

int main(void)
{
    return run();
}
