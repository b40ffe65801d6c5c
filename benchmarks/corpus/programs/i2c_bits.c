/* entry: run; inputs: response any, payload any, count 0..8 */
#include <stdint.h>

/* A two-wire bus by software: the lines are volatile words (here: memory), waits are bounded by retries. */
#define RETRY 20

volatile uint8_t response[64] = {0, 0, 0, 0, 1, 0, 0, 1};
uint8_t payload[8] = {0xA0, 0x10, 0x55, 0xAA};
uint8_t count = 4;
static volatile uint8_t scl, sda;
static volatile uint8_t position;
static uint16_t stretched;

static uint8_t sample(void)
{
    uint8_t at = position;
    position = (at + 1) & 63;
    return response[at] & 1;
}

static int clock_high(void)
{
    uint8_t tries = RETRY;
    scl = 1;
    while (sample() != 0) {
        stretched++;
        if (--tries == 0)
            return -1;
    }
    return 0;
}

static int write_byte(uint8_t byte)
{
    for (uint8_t mask = 0x80; mask != 0; mask >>= 1) {
        sda = (byte & mask) != 0;
        if (clock_high() < 0)
            return -1;
        scl = 0;
    }
    sda = 1;
    if (clock_high() < 0)
        return -1;
    uint8_t nack = sample();
    scl = 0;
    return nack;
}

static int read_byte(uint8_t last)
{
    int value = 0;
    for (int i = 7; i >= 0; i--) {
        if (clock_high())
            return -1;
        value |= sample() << i;
        scl = 0;
    }
    sda = last;
    return clock_high() ? -1 : value;
}

int run(void)
{
    int status = 0, sum = 0;
    sda = 0;
    for (uint8_t i = 0; i < count; i++) {
        uint8_t again = 3;
        do
            status = write_byte(payload[i]);
        while (status > 0 && --again);
        if (status)
            goto stop;
    }
    for (int left = 4; left > 0; left--) {
        status = read_byte(left == 1);
        if (status < 0)
            break;
        sum += status;
    }
stop:
    sda = 0;
    scl = 1;
    sda = 1;
    return status < 0 ? -(int)stretched : sum;
}

int main(void)
{
    return run();
}
