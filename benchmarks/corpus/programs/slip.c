/* entry: run; inputs: wire any, received 0..120 */
#include <stdint.h>

enum { END = 0xC0, ESC = 0xDB, ESC_END = 0xDC, ESC_ESC = 0xDD };

struct decoder {
    uint8_t buffer[48];
    uint8_t used;
    uint8_t escaped : 1, broken : 1;
    void (*deliver)(struct decoder *, const uint8_t *, uint8_t);
    uint16_t frames, errors;
};

uint8_t wire[120] = {0xC0, 1, 2, 0xDB, 0xDC, 3, 0x10, 0xC0, 0xC0, 9, 0xDB, 0xDD, 7, 0xC0, 0xDB, 4, 0xC0};
uint8_t received = 17;

static void deliver(struct decoder *d, const uint8_t *frame, uint8_t n)
{
    uint8_t sum = 0;
    while (n--)
        sum += *frame++;
    if (sum)
        d->errors++;
    else
        d->frames++;
}

static struct decoder link = {.deliver = deliver};

static void octet(struct decoder *d, uint8_t c)
{
    switch (c) {
    case END:
        if (!d->broken && !d->escaped && d->used)
            d->deliver(d, d->buffer, d->used);
        else if (d->broken)
            d->errors++;
        d->used = d->escaped = d->broken = 0;
        return;
    case ESC:
        d->escaped = 1;
        return;
    case ESC_END:
    case ESC_ESC:
        if (d->escaped)
            c = c == ESC_END ? END : ESC;
        break;
    default:
        if (d->escaped)
            d->broken = 1;
    }
    d->escaped = 0;
    if (d->used < sizeof d->buffer)
        d->buffer[d->used++] = c;
    else
        d->broken = 1;
}

int run(void)
{
    const uint8_t *p = wire;
    uint8_t n = received;

    while (n-- > 0)
        octet(&link, *p++);
    octet(&link, END);
    return link.frames << 8 | link.errors;
}

int main(void)
{
    return run();
}
