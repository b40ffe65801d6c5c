/* entry: run; inputs: binary any, size 0..60 */
#include <stdint.h>
#include <string.h>

uint8_t binary[60] = "any carnal pleasure of telemetry, in four letters each";
uint8_t size = 47;
static char encoded[84];
static uint8_t decoded[64];
static const char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

static int encode(const uint8_t *in, int n, char *out)
{
    char *p = out;
    for (int i = 0; i < n; i += 3) {
        uint32_t group = (uint32_t)in[i] << 16;
        if (i + 1 < n)
            group |= (uint32_t)in[i + 1] << 8;
        if (i + 2 < n)
            group |= in[i + 2];
        for (int shift = 18; shift >= 0; shift -= 6)
            *p++ = alphabet[group >> shift & 63];
    }
    int left = n % 3;
    if (left) {
        p[-1] = '=';
        if (left == 1)
            p[-2] = '=';
    }
    return (int)(p - out);
}

static int decode(const char *in, int n, uint8_t *out)
{
    uint32_t group = 0;
    int bits = 0, made = 0;
    for (int i = 0; i < n && in[i] != '='; i++) {
        const char *at = strchr(alphabet, in[i]);
        if (at == NULL)
            return -1;
        group = group << 6 | (uint32_t)(at - alphabet);
        bits += 6;
        if (bits >= 8) {
            bits -= 8;
            out[made++] = (uint8_t)(group >> bits);
        }
    }
    return made;
}

int run(void)
{
    int n = encode(binary, size, encoded);
    return decode(encoded, n, decoded) == size && memcmp(binary, decoded, size) == 0 ? n : -1;
}

int main(void)
{
    return run();
}
