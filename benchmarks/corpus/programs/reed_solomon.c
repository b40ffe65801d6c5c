/* entry: run; inputs: data any, size 1..40, damaged 0..47, flip any */
#include <stdint.h>
#include <string.h>

/* Eight check symbols over GF(256), tables of powers made at start; syndromes of a damaged word; one error repaired. */
#define CHECKS 8

uint8_t data[40] = "robot telemetry 17 volts";
uint8_t size = 24, damaged = 5, flip = 0x41;
static uint8_t power[512], logarithm[256], generator[CHECKS + 1], word[48], syndrome[CHECKS];

static uint8_t times(uint8_t a, uint8_t b)
{
    return a && b ? power[logarithm[a] + logarithm[b]] : 0;
}

static void make_tables(void)
{
    unsigned x = 1;
    for (int i = 0; i < 255; i++) {
        power[i] = power[i + 255] = (uint8_t)x;
        logarithm[x] = (uint8_t)i;
        x <<= 1;
        if (x & 0x100)
            x ^= 0x11D;
    }
    memset(generator, 0, sizeof generator);
    generator[0] = 1;
    for (int i = 0; i < CHECKS; i++) {
        generator[i + 1] = 1;
        for (int k = i; k > 0; k--)
            generator[k] = generator[k - 1] ^ times(generator[k], power[i]);
        generator[0] = times(generator[0], power[i]);
    }
}

static void encode(int n)
{
    uint8_t *check = word + n;
    memcpy(word, data, (size_t)n);
    memset(check, 0, CHECKS);
    for (int i = 0; i < n; i++) {
        uint8_t feedback = word[i] ^ check[0];
        memmove(check, check + 1, CHECKS - 1);
        check[CHECKS - 1] = 0;
        if (feedback != 0)
            for (int k = 0; k < CHECKS; k++)
                check[k] ^= times(feedback, generator[CHECKS - 1 - k]);
    }
}

static int repair(int n)
{
    int wrong = 0;
    for (int i = 0; i < CHECKS; i++) {
        uint8_t s = 0;
        for (const uint8_t *p = word; p < word + n; p++)
            s = times(s, power[i]) ^ *p;
        syndrome[i] = s;
        wrong |= s;
    }
    if (!wrong)
        return 0;
    if (!syndrome[0] || !syndrome[1])
        return -1;
    int place = (logarithm[syndrome[1]] + 255 - logarithm[syndrome[0]]) % 255;
    if (place >= n)
        return -2;
    word[n - 1 - place] ^= syndrome[0];
    return place + 1;
}

int run(void)
{
    make_tables();
    encode(size);
    if (damaged < size + CHECKS)
        word[damaged] ^= flip;
    int place = repair(size + CHECKS);
    return place << 8 | (memcmp(word, data, size) == 0);
}

int main(void)
{
    return run();
}
