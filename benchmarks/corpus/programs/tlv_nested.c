/* entry: run; inputs: message any, size 0..96 */
#include <stdint.h>

/* Nested tag-length-value records: recursion that is bounded by a depth, and a walk with a stack of ends. */
uint8_t message[96] = {0x30, 14, 0x02, 1, 5, 0x31, 6, 0x02, 1, 9, 0x04, 1, 'x', 0x02, 1, 1, 0x04, 3, 'a', 'b', 'c'};
uint8_t size = 21;
static uint32_t sum;

static int parse(const uint8_t *p, const uint8_t *end, int depth)
{
    int items = 0;
    while (end - p >= 2) {
        uint8_t tag = *p++, n = *p++;
        if (n > end - p)
            return -1;
        if (tag & 0x20) {
            if (depth == 0)
                return -2;
            int inner = parse(p, p + n, depth - 1);
            if (inner < 0)
                return inner;
            items += inner;
        } else {
            uint32_t value = 0;
            for (uint8_t i = 0; i < n && i < 4; i++)
                value = value << 8 | p[i];
            sum += value;
            items++;
        }
        p += n;
    }
    return p == end ? items : -3;
}

static int deepest(const uint8_t *p, const uint8_t *limit)
{
    const uint8_t *ends[6] = {limit};
    int level = 0, most = 0;

    while (p < limit) {
        if (p == ends[level] && level > 0) {
            level--;
            continue;
        }
        if (ends[level] - p < 2 || p[1] > ends[level] - p - 2)
            return -1;
        if (p[0] & 0x20 && level < 5) {
            level++;
            ends[level] = p + 2 + p[1];
            if (level > most)
                most = level;
            p += 2;
        } else {
            p += 2 + p[1];
        }
    }
    return most;
}

int run(void)
{
    int items = parse(message, message + size, 3);
    return items < 0 ? items : items << 4 | deepest(message, message + size);
}

int main(void)
{
    return run();
}
