/* entry: run; inputs: plain any, length 0..100 */
#include <stdint.h>

/* Packs with a search for the longest match in a short window, unpacks bit by bit, compares. */
#define WINDOW 32
#define LEAST 3
#define MOST 10

uint8_t plain[100] = "abcabcabcabd the cat sat on the mat, the rat on the cat";
uint8_t length = 56;
static uint8_t packed[160], back[100];
static uint16_t bit_at;

static void put_bits(unsigned value, unsigned n)
{
    while (n--) {
        if (value >> n & 1)
            packed[bit_at >> 3] |= (uint8_t)(0x80 >> (bit_at & 7));
        bit_at++;
    }
}

static unsigned get_bits(unsigned n)
{
    unsigned value = 0;
    for (; n; n--, bit_at++)
        value = value << 1 | (packed[bit_at >> 3] >> (7 - bit_at % 8) & 1);
    return value;
}

static void pack(void)
{
    unsigned at = 0;
    while (at < length) {
        unsigned best = 0, where = 0, from = at > WINDOW ? at - WINDOW : 0;
        for (unsigned k = from; k < at; k++) {
            unsigned n = 0;
            while (n < MOST && at + n < length && plain[k + n] == plain[at + n])
                n++;
            if (n > best) {
                best = n;
                where = at - k;
                if (n == MOST)
                    break;
            }
        }
        if (best >= LEAST) {
            put_bits(1, 1);
            put_bits(where - 1, 5);
            put_bits(best - LEAST, 3);
            at += best;
        } else {
            put_bits(0, 1);
            put_bits(plain[at++], 8);
        }
    }
}

static unsigned unpack(unsigned end)
{
    uint8_t *out = back;
    bit_at = 0;
    while (bit_at < end && out < back + sizeof back) {
        if (get_bits(1)) {
            const uint8_t *from = out - get_bits(5) - 1;
            unsigned n = get_bits(3) + LEAST;
            if (from < back)
                break;
            while (n-- && out < back + sizeof back)
                *out++ = *from++;
        } else {
            *out++ = (uint8_t)get_bits(8);
        }
    }
    return (unsigned)(out - back);
}

int run(void)
{
    bit_at = 0;
    pack();
    unsigned end = bit_at;
    return (int)(unpack(end) << 16 | end);
}

int main(void)
{
    return run();
}
