/* entry: run; inputs: sizes each 1B 0..70, requests 0..16 */
#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define BLOCKS 32
#define BLOCK 16

uint8_t sizes[16] = {10, 40, 16, 17, 64, 1, 0, 30};
uint8_t requests = 8;
static uint8_t pool[BLOCKS][BLOCK];
static uint8_t owner[BLOCKS];

static void *take(size_t size, uint8_t id)
{
    unsigned needed = (unsigned)(size + BLOCK - 1) / BLOCK, run = 0;
    if (needed == 0)
        return NULL;
    for (unsigned i = 0; i < BLOCKS; i++) {
        run = owner[i] ? 0 : run + 1;
        if (run == needed) {
            unsigned first = i + 1 - needed;
            for (unsigned k = first; k <= i; k++)
                owner[k] = id;
            return pool[first];
        }
    }
    return NULL;
}

static unsigned give(uint8_t id)
{
    unsigned freed = 0;
    for (unsigned i = 0; i < BLOCKS; i++)
        if (owner[i] == id) {
            owner[i] = 0;
            freed++;
        }
    return freed;
}

int run(void)
{
    unsigned failed = 0;
    for (uint8_t i = 0; i < requests; i++) {
        void *p = take(sizes[i], i + 1);
        if (p)
            memset(p, i, sizes[i]);
        else
            failed++;
        if (i % 3 == 2)
            failed += give(i) << 8;
    }
    return (int)failed;
}

int main(void)
{
    return run();
}
