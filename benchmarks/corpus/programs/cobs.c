/* entry: run; inputs: payload any, size 0..90 */
#include <stdint.h>

uint8_t payload[90] = {1, 2, 0, 4, 0, 0, 7, 8};
uint8_t size = 40;
static uint8_t stuffed[92], restored[92];

static uint8_t stuff(const uint8_t *in, uint8_t n, uint8_t *out)
{
    uint8_t *code_at = out, *start = out++;
    uint8_t code = 1;
    for (const uint8_t *end = in + n; in < end; in++) {
        if (*in) {
            *out++ = *in;
            code++;
        }
        if (!*in || code == 0xFF) {
            *code_at = code;
            code = 1;
            code_at = out++;
        }
    }
    *code_at = code;
    return (uint8_t)(out - start);
}

static int unstuff(const uint8_t *in, uint8_t n, uint8_t *out)
{
    int made = 0, at = 0;
    while (at < n) {
        uint8_t code = in[at++];
        if (code == 0)
            return -1;
        for (uint8_t i = 1; i < code; i++) {
            if (at >= n)
                return -2;
            out[made++] = in[at++];
        }
        if (code != 0xFF && at < n)
            out[made++] = 0;
    }
    return made;
}

int run(void)
{
    uint8_t length = stuff(payload, size, stuffed);
    return unstuff(stuffed, length, restored) == size ? length : -1;
}

int main(void)
{
    return run();
}
