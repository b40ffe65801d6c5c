/* entry: run; inputs: payload any, size 0..24, noise any */
#include <stdbool.h>
#include <stdint.h>

/* Bit stuffing after five ones, flags around, the check sequence bit by bit; the receiver finds it in the stream. */
uint8_t payload[24] = {0xFF, 0x7E, 0x00, 0x7D, 0xFF, 0xFF};
uint8_t size = 6, noise = 0;
static uint8_t wire[64], frame[40];
static uint16_t wire_bits;

static uint16_t step(uint16_t crc, unsigned bit)
{
    bool flip = (crc ^ bit) & 1;
    crc >>= 1;
    return flip ? crc ^ 0x8408 : crc;
}

static void emit(unsigned bit)
{
    if (bit)
        wire[wire_bits / 8] |= (uint8_t)(1 << wire_bits % 8);
    wire_bits++;
}

static void stuff(uint8_t byte, uint8_t *ones)
{
    for (uint8_t mask = 1; mask; mask = (uint8_t)(mask << 1)) {
        bool one = byte & mask;
        emit(one);
        *ones = one ? *ones + 1 : 0;
        if (*ones == 5) {
            emit(0);
            *ones = 0;
        }
    }
}

static void flag(void)
{
    for (int i = 0; i < 8; i++)
        emit(0x7E >> i & 1);
}

static int receive(void)
{
    uint8_t shift = 0, ones = 0;
    int bits = -1;
    uint16_t crc = 0xFFFF;

    for (uint16_t i = 0; i < wire_bits; i++) {
        unsigned bit = wire[i >> 3] >> (i & 7) & 1;
        shift = (uint8_t)(shift >> 1 | bit << 7);
        if (shift == 0x7E) {
            if (bits >= 23)
                return crc == 0xF0B8 || bits % 8 == 7 ? bits / 8 - 2 : -2;
            bits = 0;
            crc = 0xFFFF;
            ones = 0;
            continue;
        }
        if (bits < 0)
            continue;
        if (ones == 5 && !bit) {
            ones = 0;
            continue;
        }
        ones = bit ? ones + 1 : 0;
        if (ones >= 7 || bits >= 8 * (int)sizeof frame)
            return -1;
        if (bit)
            frame[bits >> 3] |= (uint8_t)(1 << (bits & 7));
        crc = step(crc, bit);
        bits++;
    }
    return -3;
}

int run(void)
{
    uint16_t crc = 0xFFFF;
    uint8_t ones = 0;

    wire_bits = 0;
    flag();
    for (uint8_t i = 0; i < size; i++) {
        for (int k = 0; k < 8; k++)
            crc = step(crc, payload[i] >> k & 1);
        stuff(payload[i], &ones);
    }
    crc = (uint16_t)~crc;
    stuff((uint8_t)crc, &ones);
    stuff((uint8_t)(crc >> 8), &ones);
    flag();
    wire[7] ^= noise;
    return receive();
}

int main(void)
{
    return run();
}
