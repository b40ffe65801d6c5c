/* entry: run; inputs: stream any, bytes 0..48 */
#include <stdint.h>

/* Exponential Golomb and Rice codes from a stream of bits that ends anywhere. */
struct reader {
    const uint8_t *next, *end;
    uint32_t cache;
    int8_t held;
    uint8_t over;
};

uint8_t stream[48] = {0xA6, 0x42, 0x98, 0xE2, 0x04, 0x8A, 0x17, 0x00, 0x00, 0x35, 0xFF, 0x81};
uint8_t bytes = 12;
static int32_t values[64];

static unsigned take(struct reader *r, int8_t n)
{
    while (r->held < n) {
        if (r->next == r->end) {
            r->over = 1;
            r->cache <<= 8;
        } else {
            r->cache = r->cache << 8 | *r->next++;
        }
        r->held += 8;
    }
    r->held -= n;
    return r->cache >> r->held & ((1u << n) - 1);
}

static uint32_t golomb(struct reader *r)
{
    int8_t zeros = 0;
    while (!r->over && take(r, 1) == 0)
        if (++zeros == 20)
            return 0xFFFFFFFF;
    return (1u << zeros) - 1 + take(r, zeros);
}

static uint32_t rice(struct reader *r, unsigned k)
{
    uint32_t high = 0;
    while (take(r, 1) && !r->over)
        high++;
    return high << k | take(r, (int8_t)k);
}

int run(void)
{
    struct reader r = {stream, stream + bytes, 0, 0, 0};
    int n = 0, sum = 0;

    do {
        uint32_t u = n & 1 ? rice(&r, 3) : golomb(&r);
        values[n] = u & 1 ? (int32_t)(u >> 1) + 1 : -(int32_t)(u >> 1);
        sum += values[n++];
    } while (!r.over && n < 64);
    return sum;
}

int main(void)
{
    return run();
}
