/* entry: run; inputs: text any */
#include <stdint.h>
#include <string.h>

/* A digest of a C string in 64-byte blocks: strlen, padding in a copy, four rounds chosen by a switch. */
char text[100] = "The quick brown fox jumps over the lazy dog";
static uint32_t h[4];
static const uint8_t shifts[4][4] = {{7, 12, 17, 22}, {5, 9, 14, 20}, {4, 11, 16, 23}, {6, 10, 15, 21}};

static void block(const uint8_t *p)
{
    uint32_t a = h[0], b = h[1], c = h[2], d = h[3], m[16];

    for (int i = 0; i < 16; i++) {
        m[i] = 0;
        for (int k = 3; k >= 0; k--)
            m[i] = m[i] << 8 | p[4 * i + k];
    }
    for (unsigned i = 0; i < 64; i++) {
        uint32_t f;
        unsigned g;
        switch (i / 16) {
        case 0:
            f = (b & c) | (~b & d);
            g = i;
            break;
        case 1:
            f = (d & b) | (~d & c);
            g = (5 * i + 1) % 16;
            break;
        case 2:
            f = b ^ c ^ d;
            g = (3 * i + 5) % 16;
            break;
        default:
            f = c ^ (b | ~d);
            g = 7 * i % 16;
            break;
        }
        uint32_t sum = a + f + m[g] + 0x9E3779B9u * (i + 1);
        uint8_t n = shifts[i / 16][i % 4];
        a = d;
        d = c;
        c = b;
        b += sum << n | sum >> (32 - n);
    }
    h[0] += a;
    h[1] += b;
    h[2] += c;
    h[3] += d;
}

int run(void)
{
    uint8_t padded[128];
    text[sizeof text - 1] = '\0';
    uint32_t length = strlen(text), whole = (length + 8) / 64 * 64 + 64;

    h[0] = 0x67452301;
    h[1] = 0xEFCDAB89;
    h[2] = 0x98BADCFE;
    h[3] = 0x10325476;
    memset(padded, 0, sizeof padded);
    memcpy(padded, text, length);
    padded[length] = 0x80;
    length *= 8;
    memcpy(padded + whole - 8, &length, sizeof length);
    for (const uint8_t *p = padded; p < padded + whole; p += 64)
        block(p);
    return (int)(h[0] ^ h[3]);
}

int main(void)
{
    return run();
}
