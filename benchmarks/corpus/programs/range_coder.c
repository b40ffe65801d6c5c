/* entry: run; inputs: letters each 1B 0..7, used 0..60 */
#include <stdint.h>

/* An adaptive binary range coder with carry: three bits per letter, models in a tree, and its decoder. */
#define TOP (1u << 24)

uint8_t letters[60] = {1, 2, 3, 1, 1, 1, 2, 7, 0, 0, 0, 0, 5, 1};
uint8_t used = 30;
static uint8_t stream[160], held;
static uint16_t model[8], at, waiting;
static uint64_t low;
static uint32_t range, code;

static void reset(void)
{
    for (uint16_t *m = model; m < model + 8; m++)
        *m = 1024;
    range = 0xFFFFFFFF;
    low = code = 0;
    at = held = 0;
    waiting = 1;
}

static void shift_low(void)
{
    if ((uint32_t)low < 0xFF000000u || low >> 32) {
        uint8_t carry = (uint8_t)(low >> 32), byte = held;
        do {
            if (at < sizeof stream)
                stream[at++] = byte + carry;
            byte = 0xFF;
        } while (--waiting);
        held = (uint8_t)(low >> 24);
    }
    waiting++;
    low = (uint32_t)low << 8;
}

static void encode(uint16_t *m, unsigned bit)
{
    uint32_t bound = (range >> 11) * *m;
    if (!bit) {
        range = bound;
        *m += (2048 - *m) >> 5;
    } else {
        low += bound;
        range -= bound;
        *m -= *m >> 5;
    }
    while (range < TOP) {
        range <<= 8;
        shift_low();
    }
}

static unsigned decode(uint16_t *m)
{
    uint32_t bound = (range >> 11) * *m;
    unsigned bit;
    if (code < bound) {
        range = bound;
        *m += (2048 - *m) >> 5;
        bit = 0;
    } else {
        code -= bound;
        range -= bound;
        *m -= *m >> 5;
        bit = 1;
    }
    while (range < TOP) {
        range <<= 8;
        code = code << 8 | (at < sizeof stream ? stream[at++] : 0);
    }
    return bit;
}

int run(void)
{
    unsigned wrong = 0, size;

    reset();
    for (uint8_t i = 0; i < used; i++)
        for (unsigned node = 1, bit = 4; bit; bit >>= 1) {
            unsigned one = (letters[i] & bit) != 0;
            encode(&model[node], one);
            node = 2 * node + one;
        }
    for (int i = 0; i < 5; i++)
        shift_low();
    size = at;
    reset();
    for (int i = 0; i < 5; i++)
        code = code << 8 | stream[at++];
    for (uint8_t i = 0; i < used; i++) {
        unsigned node = 1;
        while (node < 8)
            node = 2 * node + decode(&model[node]);
        wrong += (node & 7) != letters[i];
    }
    return (int)(size << 8 | wrong);
}

int main(void)
{
    return run();
}
