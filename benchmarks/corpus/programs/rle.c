/* entry: run; inputs: raw any, used 0..80 */
#include <stdint.h>

uint8_t raw[80] = {1, 1, 1, 1, 2, 3, 3, 3, 0, 0, 0, 0, 0, 0, 7};
uint8_t used = 40;
static uint8_t packed[160], back[80];

static unsigned pack(const uint8_t *in, unsigned n, uint8_t *out)
{
    unsigned at = 0, made = 0;
    while (at < n) {
        uint8_t value = in[at], count = 1;
        while (at + count < n && count < 255 && in[at + count] == value)
            count++;
        out[made++] = count;
        out[made++] = value;
        at += count;
    }
    return made;
}

static unsigned unpack(const uint8_t *in, unsigned n, uint8_t *out, unsigned room)
{
    uint8_t *start = out, *stop = out + room;
    const uint8_t *end = in + n;
    while (in + 1 < end) {
        uint8_t count = *in++, value = *in++;
        while (count-- && out < stop)
            *out++ = value;
    }
    return (unsigned)(out - start);
}

int run(void)
{
    unsigned size = pack(raw, used, packed);
    unsigned restored = unpack(packed, size, back, sizeof back);
    if (restored != used)
        return -1;
    for (unsigned i = 0; i < restored; i++)
        if (back[i] != raw[i])
            return -2;
    return (int)size;
}

int main(void)
{
    return run();
}
