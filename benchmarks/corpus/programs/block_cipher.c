/* entry: run; inputs: state any, master any */
#include <stdint.h>

/* Substitution, row shifts and column mixing over a 4 x 4 byte state; the box is computed, not tabulated. */
uint8_t state[16] = "fifteen bytes..";
uint8_t master[16] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16};
static uint8_t box[256];

static uint8_t multiply(uint8_t a, uint8_t b)
{
    uint8_t product = 0;
    while (b) {
        if (b & 1)
            product ^= a;
        a = (uint8_t)(a << 1 ^ (a & 0x80 ? 0x1D : 0));
        b >>= 1;
    }
    return product;
}

static void make_box(void)
{
    uint8_t x = 1, y = 1;
    for (int i = 0; i < 256; i++)
        box[i] = 0x63;
    do {
        x = multiply(x, 3);
        y = multiply(y, 7);
        box[x] = (uint8_t)(y ^ y << 1 ^ y >> 3 ^ 0x63);
    } while (x != 1);
}

static void shift_rows(uint8_t *s)
{
    for (int row = 1; row < 4; row++)
        for (int times = 0; times < row; times++) {
            uint8_t first = s[row];
            for (int c = 0; c < 3; c++)
                s[row + 4 * c] = s[row + 4 * (c + 1)];
            s[row + 12] = first;
        }
}

static void mix_columns(uint8_t *s)
{
    for (uint8_t *c = s; c < s + 16; c += 4) {
        uint8_t all = c[0] ^ c[1] ^ c[2] ^ c[3], first = c[0];
        for (int i = 0; i < 3; i++)
            c[i] ^= all ^ multiply(c[i] ^ c[i + 1], 2);
        c[3] ^= all ^ multiply(c[3] ^ first, 2);
    }
}

int run(void)
{
    make_box();
    for (int round = 0; round < 10; round++) {
        for (int i = 0; i < 16; i++)
            state[i] = box[state[i] ^ master[(i + round) & 15]];
        shift_rows(state);
        if (round != 9)
            mix_columns(state);
    }
    return state[0] << 8 | state[15];
}

int main(void)
{
    return run();
}
