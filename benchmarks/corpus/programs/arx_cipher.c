/* entry: run; inputs: key any, message any, blocks 0..8 */
#include <stdint.h>
#include <string.h>

#define ROUNDS 12
#define ROTL(x, n) ((x) << (n) | (x) >> (32 - (n)))

uint32_t key[4] = {0x01234567, 0x89ABCDEF, 0xFEDCBA98, 0x76543210};
uint8_t message[128] = "attack the line at the third marker";
uint8_t blocks = 3;
static uint32_t schedule[ROUNDS + 2];

static void expand(const uint32_t *k)
{
    uint32_t a = 0x9E3779B9;
    for (int i = 0; i < ROUNDS + 2; i++) {
        a = ROTL(a + k[i & 3], 7) ^ (uint32_t)i;
        schedule[i] = a;
    }
}

static void mix(uint32_t v[4])
{
    for (int r = 0; r < ROUNDS; r += 2) {
        v[0] += v[1] ^ schedule[r];
        v[3] = ROTL(v[3] ^ v[0], 16);
        v[2] += v[3];
        v[1] = ROTL(v[1] ^ v[2], 12) + schedule[r + 1];
    }
    v[0] ^= schedule[ROUNDS];
    v[2] ^= schedule[ROUNDS + 1];
}

int run(void)
{
    uint32_t chain[4] = {0, 0, 0, 0}, block[4];

    expand(key);
    for (uint8_t b = 0; b < blocks; b++) {
        memcpy(block, message + 16 * b, sizeof block);
        for (int i = 0; i < 4; i++)
            block[i] ^= chain[i];
        mix(block);
        memcpy(chain, block, sizeof chain);
        memcpy(message + 16 * b, block, sizeof block);
    }
    return (int)chain[0];
}

int main(void)
{
    return run();
}
