/* entry: run; inputs: image any, wanted any */
#include <stdint.h>
#include <string.h>

/* A tiny file system in memory: a directory of names, a table of chains; a broken chain is found by counting. */
#define CLUSTERS 32
#define LAST 0xFF

struct entry {
    uint8_t name[8];
    uint8_t first, attributes;
    uint16_t size;
};
struct volume {
    uint8_t table[CLUSTERS];
    struct entry root[6];
    uint8_t data[CLUSTERS][16];
};

struct volume image = {{LAST, LAST, 3, 4, 9, LAST, 0, 0, 0, LAST},
                       {{{'B', 'O', 'O', 'T', ' ', ' ', ' ', ' '}, 5, 0, 14},
                        {{'C', 'O', 'N', 'F', 'I', 'G', ' ', ' '}, 2, 0, 60},
                        {{0xE5, 'L', 'D', ' ', ' ', ' ', ' ', ' '}, 7, 0, 4}},
                       {{0}}};
uint8_t wanted[8] = {'C', 'O', 'N', 'F', 'I', 'G', ' ', ' '};
static uint8_t content[CLUSTERS * 16];

static const struct entry *find(const uint8_t *name)
{
    for (const struct entry *e = image.root; e != &image.root[6] && e->name[0]; e++) {
        if (e->name[0] == 0xE5 || e->attributes & 0x18)
            continue;
        if (memcmp(e->name, name, sizeof e->name) == 0)
            return e;
    }
    return 0;
}

static int load(const struct entry *e)
{
    uint8_t cluster = e->first;
    uint16_t left = e->size, done = 0;
    int steps = 0;

    while (left > 0 && cluster != LAST) {
        if (cluster < 2 || cluster >= CLUSTERS || ++steps > CLUSTERS)
            return -1;
        uint16_t part = left < 16 ? left : 16;
        memcpy(content + done, image.data[cluster], part);
        done += part;
        left -= part;
        cluster = image.table[cluster];
    }
    return left ? -2 : done;
}

static int unused(void)
{
    int n = 0;
    for (const uint8_t *p = image.table + 2; p < image.table + CLUSTERS; p++)
        n += *p == 0;
    return n;
}

int run(void)
{
    const struct entry *e = find(wanted);
    return e ? load(e) << 8 | unused() : -3;
}

int main(void)
{
    return run();
}
