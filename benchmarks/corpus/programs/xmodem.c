/* entry: run; inputs: line any, bytes 0..160 */
#include <stdbool.h>
#include <stdint.h>
#include <string.h>

/* Receives short blocks with retries from a line that may fall silent; the way out of every fault is one label. */
#define BLOCK 16
#define RETRIES 5

enum { SOH = 1, EOT = 4, ACK = 6, NAK = 21, CAN = 24 };

uint8_t line[160] = {1, 1, 254, 'h', 'e', 'l', 'l', 'o'};
uint8_t bytes = 100;
static uint8_t at, image[128], answers[32], answered;

static int get(void)
{
    int wait = 3;
    while (at >= bytes)
        if (--wait == 0)
            return -1;
    return line[at++];
}

static void answer(uint8_t c)
{
    if (answered < sizeof answers)
        answers[answered++] = c;
}

static int block(uint8_t expected, uint8_t *to)
{
    uint8_t sum = 0;
    int number = get(), inverse = get();

    if (number < 0 || inverse < 0 || number != (uint8_t)~inverse)
        goto purge;
    for (int i = 0; i < BLOCK; i++) {
        int c = get();
        if (c < 0)
            goto purge;
        to[i] = (uint8_t)c;
        sum += (uint8_t)c;
    }
    if (get() != sum)
        goto purge;
    if (number == (uint8_t)(expected - 1))
        return 0;
    return number == expected ? 1 : -2;
purge:
    while (get() >= 0)
        if (at % 32 == 0)
            break;
    return -1;
}

int run(void)
{
    uint8_t expected = 1, retries = RETRIES, buffer[BLOCK];
    uint16_t stored = 0;
    bool done = false;

    answer(NAK);
    while (!done && retries > 0) {
        int c = get(), status;
        switch (c) {
        case SOH:
            status = block(expected, buffer);
            if (status > 0) {
                if (stored + BLOCK > (int)sizeof image)
                    return -3;
                memcpy(image + stored, buffer, BLOCK);
                stored += BLOCK;
                expected++;
                retries = RETRIES;
            } else if (status < -1) {
                answer(CAN);
                return -2;
            } else if (status < 0) {
                retries--;
            }
            answer(status >= 0 ? ACK : NAK);
            break;
        case EOT:
            answer(ACK);
            done = true;
            break;
        case CAN:
            return -1;
        default:
            retries--;
            answer(NAK);
        }
    }
    return done ? stored : -4;
}

int main(void)
{
    return run();
}
