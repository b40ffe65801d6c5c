/* entry: run; inputs: records any, count 0..24 */
#include <stdint.h>
#include <string.h>

/* Merge sort of records by recursion, short pieces by insertion; stable. */
typedef struct {
    uint16_t key;
    uint8_t tag, flags;
} record_t;

record_t records[24] = {{9, 1, 0}, {4, 2, 0}, {7, 3, 0}, {4, 4, 0}, {1, 5, 0}, {9, 6, 0}, {0, 7, 0}, {2, 8, 1}};
uint8_t count = 8;
static record_t spare[24];

static void insertion(record_t *first, record_t *last)
{
    for (record_t *i = first + 1; i < last; ++i) {
        record_t held = *i, *k = i;
        while (k > first && k[-1].key > held.key) {
            *k = k[-1];
            --k;
        }
        *k = held;
    }
}

static void sort(record_t *a, record_t *room, unsigned n)
{
    if (n <= 4) {
        insertion(a, a + n);
        return;
    }
    unsigned half = n / 2;
    record_t *l = a, *r = a + half, *out = room;

    sort(a, room, half);
    sort(a + half, room + half, n - half);
    while (l != a + half && r != a + n)
        *out++ = r->key < l->key ? *r++ : *l++;
    while (l != a + half)
        *out++ = *l++;
    while (r != a + n)
        *out++ = *r++;
    memcpy(a, room, n * sizeof *a);
}

int run(void)
{
    sort(records, spare, count);
    return records[0].tag;
}

int main(void)
{
    return run();
}
