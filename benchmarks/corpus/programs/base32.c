/* entry: run; inputs: bytes any, size 0..60 */
#include <stdint.h>
#include <string.h>

/* Base 32 there and back, and base 85 of the same bytes. */
uint8_t bytes[60] = "key material 0123";
uint8_t size = 17;
static char text[100], wide[80];
static uint8_t restored[64];
static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ234567";

static int encode(const uint8_t *in, int n, char *out)
{
    uint32_t held = 0;
    int bits = 0;
    char *p = out;

    while (n > 0 || bits > 0) {
        if (bits < 5) {
            if (n > 0) {
                held = held << 8 | *in++;
                bits += 8;
                n--;
            } else {
                held <<= 5 - bits;
                bits = 5;
            }
        }
        bits -= 5;
        *p++ = letters[held >> bits & 31];
    }
    while ((p - out) % 8)
        *p++ = '=';
    *p = '\0';
    return (int)(p - out);
}

static int decode(const char *s, uint8_t *out)
{
    uint32_t held = 0;
    int bits = 0, n = 0;

    for (; *s && *s != '='; s++) {
        const char *found = strchr(letters, *s);
        if (!found)
            return -1;
        held = held << 5 | (uint32_t)(found - letters);
        if ((bits += 5) >= 8)
            out[n++] = (uint8_t)(held >> (bits -= 8));
    }
    return n;
}

static int base85(const uint8_t *in, int n)
{
    char *p = wide;
    for (; n >= 4; n -= 4, in += 4) {
        uint32_t v = 0;
        for (int i = 0; i < 4; i++)
            v = v << 8 | in[i];
        if (v == 0) {
            *p++ = 'z';
            continue;
        }
        for (int i = 4; i >= 0; i--) {
            p[i] = (char)('!' + v % 85);
            v /= 85;
        }
        p += 5;
    }
    return (int)(p - wide);
}

int run(void)
{
    int n = encode(bytes, size, text);
    return decode(text, restored) == size && !memcmp(bytes, restored, size) ? n << 8 | base85(bytes, size) : -1;
}

int main(void)
{
    return run();
}
